// Runs that start at the same time in one folder, and the remains of a run after a power loss.

#include <array>

#include "app/scene.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using Files = std::map<std::string, std::string>;

struct ConcurrentRuns : SceneTest {
  ConcurrentRuns() { add_row_of_cameras(3); }

  Words levels_of(const std::string& of) const {
    return {"levels", of, "-o", out, "--chunk", "64", "--levels", "2"};
  }
  Words pictures(const Words& more = {}) const {
    return joined({"render", model, "--view", "all", "--mono", "--size", "36x24", "--resume", "-o", out},
                  more);
  }
};

// Two runs at once into one folder: one succeeds and writes the same files as alone, whichever starts first.
// The other is refused, with the name of the folder's run.
TEST_F(ConcurrentRuns, RejectDifferentOptions) {
  const Words lines[] = {pictures(), pictures({"--background", "1,1,1"})};
  Files alone[2];
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(good(run_program(lines[k])));
    alone[k] = contents_of(out);
    fs::remove_all(out);
  }
  ASSERT_NE(alone[0], alone[1]) << "injected: files of both would go unnoticed";
  for (const int begins : {0, 1}) {
    Program first(lines[begins]), second(lines[1 - begins]);
    const Outcome outcomes[] = {first.wait(), second.wait()};
    const int won = outcomes[0].code == 0 ? 0 : 1;
    EXPECT_TRUE(good(outcomes[won]));
    EXPECT_TRUE(ended(outcomes[1 - won], 2, "has pictures of another run"));
    EXPECT_EQ(contents_of(out), alone[won == 0 ? begins : 1 - begins]);
    fs::remove_all(out);
  }
}

// Both runs do the same work, which does no harm.
TEST_F(ConcurrentRuns, EqualRunsShareFolder) {
  ASSERT_TRUE(good(run_program(pictures())));
  const Files alone = contents_of(out);
  fs::remove_all(out);
  Program first(pictures()), second(pictures());
  EXPECT_TRUE(good(first.wait()));
  EXPECT_TRUE(good(second.wait()));
  EXPECT_EQ(contents_of(out), alone);
}

TEST_F(ConcurrentRuns, LockFolderOfLevels) {
  Program first(levels_of(model));
  wait_until([&] { return !read_text(out + "/levels-run.json.lock").empty(); });
  first.send(SIGSTOP);
  EXPECT_TRUE(ended(run_program(levels_of(model)), 2, out + ": process "));
  first.send(SIGCONT);
  EXPECT_TRUE(good(first.wait()));
}

TEST_F(ConcurrentRuns, ReportOverwrittenPictures) {
  Program slow(pictures({"--frames", "300"}));
  wait_for_file(out + "/view0.png");
  slow.send(SIGSTOP);  // a fast GPU would end it before the other run begins
  ASSERT_TRUE(good(render({"--view", "view2", "--mono", "--size", "36x24", "-o", out})));
  slow.send(SIGCONT);
  EXPECT_TRUE(ended(slow.wait(), 2, "another run has drawn into the folder meanwhile"));
}

/// Each file of a run is truncated in turn, and the next run must restore it.
struct RunsAfterPowerLoss : ConcurrentRuns {
  void expect_restored(const Words& line, const std::string& run_file) const {
    ASSERT_TRUE(good(run_program(line)));
    const Files whole = contents_of(out);
    std::size_t made_again = 0;
    const std::size_t most = test::switched_on("BINOSPLAT_LONG") ? whole.size() : 6;  // one run for each
    for (const auto& [name, bytes] : whole) {
      if (made_again == most) break;
      if (name == run_file || bytes.size() < 10) continue;
      const std::size_t left =
          std::array{std::size_t{0}, bytes.size() / 2, bytes.size() - 3}[made_again++ % 3];
      write_text(fs::path(out) / name, bytes.substr(0, left));
      EXPECT_TRUE(good(run_program(line))) << name << " of " << left << " bytes";
      EXPECT_EQ(contents_of(out), whole) << name << " of " << left << " bytes";
    }
    EXPECT_GT(made_again, 5);
    write_text(fs::path(out) / run_file, "");
    EXPECT_TRUE(ended(run_program(line), 2, run_file));
  }
};

TEST_F(RunsAfterPowerLoss, PicturesAreDrawnAgain) {
  expect_restored(pictures({"--exr", "half"}), "render-run.json");
  EXPECT_TRUE(ended(run_program(pictures()), 2, "render-run.json"));
}

TEST_F(RunsAfterPowerLoss, LevelsAreWrittenAgain) {
  save_ply(model, test::random_model(1, 200, 1));
  expect_restored(levels_of(model), "levels-run.json");
}

}  // namespace
}  // namespace binosplat
