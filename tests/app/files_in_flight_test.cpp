// Pictures that are written while the next ones are drawn: the same files whatever the threads, and no half
// one where something fails midway.

#include <chrono>
#include <functional>
#include <thread>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::Program;
using test::read_text;
using test::Words;

struct FilesInFlight : test::SceneTest {
  FilesInFlight() { add_row_of_cameras(12); }

  const Words all = {"--view", "all", "--exr", "half", "--resume"};

  Words line(const std::string& to, const Words& more = {}) const {
    return joined(joined({"render", model, "-o", to}, all), more);
  }
  static std::map<std::string, std::string> contents(const std::filesystem::path& of) {
    std::map<std::string, std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(of)) {
      if (entry.is_regular_file()) found[entry.path().filename()] = read_text(entry.path());
    }
    return found;
  }
  /// Whether the folder has some files of the whole run, all as they are there, and no others.
  static testing::AssertionResult is_part_of(const std::map<std::string, std::string>& whole,
                                             const std::filesystem::path& folder) {
    for (const auto& [name, bytes] : contents(folder)) {
      if (!whole.contains(name) || whole.at(name) != bytes) return testing::AssertionFailure() << name;
    }
    return testing::AssertionSuccess();
  }
  static void wait_for(const std::filesystem::path& file) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(file) && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

TEST_F(FilesInFlight, AreTheSameWhateverTheMemoryAndTheThreads) {
  const std::string many = folder / "many", one = folder / "one", json = folder / "run.json";
  ASSERT_TRUE(good(test::run_program(line(many))));
  const Words alone = {"render", model,  "-o",           one, "--view", "all",
                       "--exr",  "half", "--max-memory", "1", "--json", json};
  ASSERT_TRUE(good(test::run_program(alone)));
  EXPECT_EQ(test::load_json(json)["run"]["threads"], 1);
  std::map<std::string, std::string> expected = contents(many);
  EXPECT_EQ(expected.erase("render-run.json"), 1);
  EXPECT_EQ(contents(one), expected);
  EXPECT_EQ(expected.size(), 12 * 4);
}

TEST_F(FilesInFlight, AFileThatCannotBeWrittenEndsTheRun) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(test::run_program(line(whole))));
  const auto expected = contents(whole);
  ASSERT_TRUE(good(test::run_program(line(out, {"--shard", "1/12"}))));
  std::filesystem::create_directories(folder / "out/view6_right.exr");
  const Outcome outcome = test::run_program(line(out));
  EXPECT_TRUE(ended(outcome, 2, "view6_right.exr: it is a folder"));
  EXPECT_TRUE(is_part_of(expected, out));
  std::filesystem::remove(folder / "out/view6_right.exr");
  ASSERT_TRUE(good(test::run_program(line(out))));
  EXPECT_EQ(contents(out), expected);
}

TEST_F(FilesInFlight, AFullDiskLeavesNoHalfFile) {
  test::Surroundings small;
  small.limits[RLIMIT_FSIZE] = 6000;
  const Outcome outcome = test::run_program(line(out), small);
  EXPECT_TRUE(ended(outcome, 2, "File too large"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out"));
  for (const auto& [name, bytes] : contents(out)) EXPECT_EQ(name.find(".part-"), std::string::npos) << name;
  ASSERT_TRUE(good(test::run_program(line(out))));
}

TEST_F(FilesInFlight, WhatGoesAwayMeanwhileEndsTheRun) {
  const Words more = {"--view", "all", "--exr", "half"};
  const auto ends_after = [&](const std::function<void()>& change) {
    std::filesystem::remove_all(out);
    Program run(joined({"render", model, "-o", out}, more));
    wait_for(out + "/view0_left.png");
    change();
    return run.wait();
  };
  EXPECT_TRUE(good(ends_after([] {})));
  EXPECT_TRUE(ended(ends_after([&] { std::filesystem::rename(out, out + "-gone"); }), 2, out + "/view"));
  EXPECT_FALSE(std::filesystem::exists(out)) << "a folder of the others";
  std::filesystem::remove_all(out + "-gone");
  EXPECT_TRUE(ended(ends_after([&] { std::filesystem::remove(out + "/view0_left.png"); }), 2,
                    "view0_left.png was written, and is gone"));
  EXPECT_TRUE(ended(ends_after([&] {
                      std::filesystem::remove(out + "/view0_left.png");
                      std::filesystem::create_directory(out + "/view0_left.png");
                    }),
                    2, "view0_left.png"));
}

// Signals that a program may end by itself, and one that it may not.
TEST_F(FilesInFlight, ASignalLeavesWhatResumeGoesOnFrom) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(test::run_program(line(whole))));
  const auto expected = contents(whole);
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    std::filesystem::remove_all(out);
    Program run(line(out));
    wait_for(out + "/view2_left.png");
    const auto sent = std::chrono::steady_clock::now();
    run.send(signal);
    const int code = run.wait().code;
    EXPECT_TRUE(code == -signal || code == 0) << code;  // unless it was done
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(2));
    if (signal != SIGKILL) {
      EXPECT_TRUE(is_part_of(expected, out)) << signal;
    }
    ASSERT_TRUE(good(test::run_program(line(out)))) << signal;
    auto found = contents(out);
    std::erase_if(found, [](const auto& file) { return file.first.find(".part-") != std::string::npos; });
    EXPECT_EQ(found, expected) << signal;
  }
}

}  // namespace
}  // namespace binosplat
