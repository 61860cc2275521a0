// Runs that begin at the same time in one folder, and what a loss of power leaves of one.

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "app/scene.h"
#include "support/broken.h"
#include "support/models.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::ended;
using test::good;
using test::Outcome;
using test::Program;
using test::read_text;
using test::run_program;
using test::Words;
using test::write_text;
using Files = std::map<std::string, std::string>;

Files contents_of_folder(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().lexically_relative(folder)] = read_text(entry.path());
  return files;
}

struct Runs : test::SceneTest {
  Runs() {
    add_row_of_cameras(3);
    test::PlyFile file = test::small_model();
    for (std::size_t i = 0; i < file.rows.size(); ++i) file.at(i, "f_dc_0") = 1.0;
    write_text(other, test::to_bytes(file));
  }

  /// Both at once, into one folder: one is done, and the other is told whose folder it is. Whether that was
  /// the first.
  static bool expect_one_is_told(const Words& a, const Words& b, const std::string& said) {
    Program first(a), second(b);
    const Outcome outcomes[] = {first.wait(), second.wait()};
    const bool first_won = outcomes[0].code == 0;
    EXPECT_TRUE(good(outcomes[first_won ? 0 : 1]));
    EXPECT_TRUE(ended(outcomes[first_won ? 1 : 0], 2, said));
    return first_won;
  }

  /// The one that is done leaves the files that it has alone, whichever begins.
  void expect_one_of(const Words& a, const Words& b, const std::string& said) const {
    Files alone[2];
    for (int k = 0; k < 2; ++k) {
      ASSERT_TRUE(good(run_program(k == 0 ? a : b)));
      alone[k] = contents_of_folder(out);
      fs::remove_all(out);
    }
    ASSERT_NE(alone[0], alone[1]) << "planted: files of both would go unnoticed";
    for (const bool swapped : {false, true}) {
      const bool first_won = expect_one_is_told(swapped ? b : a, swapped ? a : b, said);
      EXPECT_EQ(contents_of_folder(out), alone[first_won == swapped ? 1 : 0]);
      fs::remove_all(out);
    }
  }

  Words levels_of(const std::string& of) const {
    return {"levels", of, "-o", out, "--leaf", "64", "--levels", "2"};
  }
  Words pictures(const Words& more = {}) const {
    return joined({"render", model, "--view", "all", "--mono", "--size", "36x24", "--resume", "-o", out},
                  more);
  }

  const std::string other = folder / "other.ply";
};

TEST_F(Runs, LevelsOfTwoModelsDoNotMix) {
  expect_one_of(levels_of(model), levels_of(other), "holds levels of another run");
}

TEST_F(Runs, PicturesOfTwoOptionsDoNotMix) {
  expect_one_of(pictures(), pictures({"--background", "1,1,1"}), "holds pictures of another run");
}

TEST_F(Runs, PointsOfTwoScenesDoNotMix) {
  write_text(folder / "axes.json", R"({"eyes": [1], "sizes": ["32x24"], "views": 1, "frames": 1, "repeats": 1,
                                       "settings": [{"tiles": ["ellipse"]}]})");
  const auto bench = [&](const std::string& of) {
    return Words{"bench", of, "--axes", folder / "axes.json", "-o", out};
  };
  expect_one_is_told(bench(model), bench(other), "holds points of another run");
}

// Work is done twice, and no harm.
TEST_F(Runs, OfOneKindShareAFolder) {
  for (const Words& line : {levels_of(model), pictures()}) {
    ASSERT_TRUE(good(run_program(line)));
    const Files alone = contents_of_folder(out);
    fs::remove_all(out);
    Program first(line), second(line);
    EXPECT_TRUE(good(first.wait()));
    EXPECT_TRUE(good(second.wait()));
    EXPECT_EQ(contents_of_folder(out), alone);
    fs::remove_all(out);
  }
}

TEST_F(Runs, ThatDrawOverOneAnotherSaySo) {
  Program slow(pictures({"--frames", "300"}));
  while (!fs::exists(out + "/view0.png")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(good(render({"--view", "view2", "--mono", "--size", "36x24", "-o", out})));
  EXPECT_TRUE(ended(slow.wait(), 2, "another run has drawn into the folder meanwhile"));
}

/// Each of a run's files cut, one after the other, and what the next run makes of it.
struct CutRuns : Runs {
  void expect_whole_again(const Words& line, const std::string& run_file) const {
    ASSERT_TRUE(good(run_program(line)));
    const Files whole = contents_of_folder(out);
    std::size_t made_again = 0;
    const std::size_t most = test::switched_on("BINOSPLAT_LONG") ? whole.size() : 6;  // a run each
    for (const auto& [name, bytes] : whole) {
      if (made_again == most) break;
      if (name == run_file || bytes.size() < 10) continue;
      const std::size_t left =
          std::array{std::size_t{0}, bytes.size() / 2, bytes.size() - 3}[made_again++ % 3];
      write_text(fs::path(out) / name, bytes.substr(0, left));
      EXPECT_TRUE(good(run_program(line))) << name << " of " << left << " bytes";
      EXPECT_EQ(contents_of_folder(out), whole) << name << " of " << left << " bytes";
    }
    EXPECT_GT(made_again, 5);
    write_text(fs::path(out) / run_file, "");
    EXPECT_TRUE(ended(run_program(line), 2, run_file));
  }
};

TEST_F(CutRuns, PicturesAreDrawnAgain) {
  expect_whole_again(pictures({"--exr", "half"}), "render-run.json");
  EXPECT_TRUE(ended(run_program(pictures()), 2, "render-run.json"));
}

TEST_F(CutRuns, LevelsAreWrittenAgain) {
  test::save_ply(model, test::random_model(1, 200, 1));
  expect_whole_again(levels_of(model), "levels-run.json");
}

}  // namespace
}  // namespace binosplat
