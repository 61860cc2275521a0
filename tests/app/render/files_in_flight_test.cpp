// Pictures are written while the next ones are drawn: the files are the same for any number of threads, and
// an error leaves no incomplete file.

#include <functional>

#include "app/scene.h"

namespace binosplat {
namespace {

struct FilesInFlight : SceneTest {
  FilesInFlight() { add_row_of_cameras(12); }

  const Words drawing = {"render", model, "--view", "all", "--exr", "half"};

  Words line(const std::string& to, const Words& more = {}) const {
    return joined(joined(drawing, {"--resume", "-o", to}), more);
  }
};

TEST_F(FilesInFlight, SameForAnyMemoryAndThreads) {
  const std::string many = folder / "many", one = folder / "one", report = folder / "run.json";
  ASSERT_TRUE(good(run_program(line(many))));
  ASSERT_TRUE(good(run_program(joined(drawing, {"-o", one, "--max-memory", "1", "--json", report}))));
  EXPECT_EQ(load_json(report)["run"]["threads"], 1);
  std::map<std::string, std::string> expected = contents_of(many);
  EXPECT_EQ(expected.erase("render-run.json"), 1);
  EXPECT_EQ(contents_of(one), expected);
  EXPECT_EQ(expected.size(), 12 * 4);
}

TEST_F(FilesInFlight, WriteErrorEndsRun) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(run_program(line(whole))));
  const auto expected = contents_of(whole);
  ASSERT_TRUE(good(run_program(line(out, {"--shard", "1/12"}))));
  fs::create_directories(folder / "out/view6_right.exr");
  EXPECT_TRUE(ended(run_program(line(out)), 2, "view6_right.exr: it is a folder"));
  for (const auto& [name, bytes] : contents_of(out))
    EXPECT_TRUE(expected.contains(name) && expected.at(name) == bytes) << name;
  fs::remove(folder / "out/view6_right.exr");
  ASSERT_TRUE(good(run_program(line(out))));
  EXPECT_EQ(contents_of(out), expected);
}

TEST_F(FilesInFlight, FullDiskLeavesNoPartialFile) {
  EXPECT_TRUE(ended(run_program(line(out), {.limits = {{RLIMIT_FSIZE, 6000}}}), 2, ".png: File too large"));
  EXPECT_TRUE(fs::exists(out));
  for (const auto& [name, bytes] : contents_of(out)) EXPECT_FALSE(has(name, ".part-"));
  ASSERT_TRUE(good(run_program(line(out))));
}

// Two signals that the program handles, and one that it cannot.
TEST_F(FilesInFlight, ResumeAfterSignal) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(run_program(line(whole))));
  const auto expected = contents_of(whole);
  for (const int signal : {SIGHUP, SIGTERM, SIGKILL}) {
    fs::remove_all(out);
    Program run(line(out));
    wait_for_file(out + "/view2_left.png");
    const auto sent = std::chrono::steady_clock::now();
    run.send(signal);
    const int code = run.wait().code;
    EXPECT_TRUE(code == -signal || code == 0) << code;  // 0 if the run had ended already
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(2));
    if (signal != SIGKILL) {
      for (const auto& [name, bytes] : contents_of(out))
        EXPECT_TRUE(expected.contains(name) && expected.at(name) == bytes) << name;
    }
    ASSERT_TRUE(good(run_program(line(out)))) << signal;
    auto found = contents_of(out);
    std::erase_if(found, [](const auto& file) { return file.first.find(".part-") != std::string::npos; });
    EXPECT_EQ(found, expected) << signal;
  }
}

}  // namespace
}  // namespace binosplat
