// binosplat levels, from the command line.

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "app/scene.h"
#include "formats/image_file.h"
#include "formats/model_file.h"
#include "measure/metrics.h"
#include "support/models.h"
#include "support/scaffold_files.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::run_program;
namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

/// Names of files, and the lengths and hashes of what is in them.
Files hashed_contents(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string text = test::read_text(entry.path());
    files[entry.path().lexically_relative(folder).string()] =
        fmt::format("{} {:x}", text.size(), std::hash<std::string>()(text));
  }
  return files;
}

struct LevelsTest : test::SceneTest {
  using Arguments = std::vector<std::string>;

  Arguments line(const std::string& to, const Arguments& more = {}) const {
    Arguments all = {"levels", model, "-o", to, "--leaf", "64", "--levels", "3"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Outcome levels(const std::string& to, const Arguments& more = {}) const {
    return run_program(line(to, more));
  }
};

TEST_F(LevelsTest, AreReadAndDrawn) {
  test::save_ply(model, test::floor_model());
  const Outcome outcome = levels(out);
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("    0        2000\n    1        1004\n    2         516\n"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(load_model(out).count(), 2000u);
  const Outcome info = run_program({"info", out, "--lod", "1"});
  ASSERT_TRUE(good(info));
  EXPECT_NE(info.out.find("1004"), std::string::npos) << info.out;

  const auto picture = [&](const std::string& scene, const Arguments& more) {
    Arguments all = {"render", scene,    "--eye", "0,-12,8", "--at", "0,0,0",         "--up",
                     "0,0,1",  "--size", "64x48", "--mono",  "-o",   folder / "p.png"};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_TRUE(good(run_program(all)));
    return load_image(folder / "p.png");
  };
  const Image exact = picture(model, {});
  const auto psnr = [&](const Arguments& more) { return measure::psnr(exact, picture(out, more)); };
  const double finest = psnr({"--lod", "0"}), second = psnr({"--lod", "1"}), third = psnr({"--lod", "2"});
  EXPECT_GT(finest, 50.0) << "but for the format's rounding";
  EXPECT_GT(finest, second);
  EXPECT_GT(second, third);
  EXPECT_GT(third, 34.0);
}

TEST_F(LevelsTest, GoOnAfterAnInterruption) {
  test::save_ply(model, test::random_model(4, 1200, 2));
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(levels(whole)));
  test::Program run(line(out));
  while (!fs::exists(out + "/levels-run.json")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  run.send(SIGINT);
  run.wait();
  // However far it came: one SOG is complete, and one is not.
  for (const char* file : {"0_0", "1_0"}) {
    fs::create_directories(out + "/" + file);
    fs::copy(whole + "/" + file, out + "/" + file,
             fs::copy_options::overwrite_existing | fs::copy_options::recursive);
  }
  fs::remove(out + "/1_0/meta.json");
  fs::remove(out + "/lod-meta.json");
  for (const std::string& of : {whole, out}) {
    const std::string meta = of + "/0_0/meta.json";
    test::write_text(meta, test::read_text(meta) + "  \n");  // which stays as it was
  }
  const Outcome outcome = levels(out);
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.err.find("of 3 SOGs were in"), std::string::npos) << outcome.err;
  EXPECT_EQ(hashed_contents(out), hashed_contents(whole));
  const Outcome again = levels(out);
  ASSERT_TRUE(good(again));
  EXPECT_NE(again.err.find("3 of 3 SOGs were in"), std::string::npos) << again.err;
}

TEST_F(LevelsTest, TakeNoFolderOfOthers) {
  ASSERT_TRUE(good(levels(out)));
  const Files before = hashed_contents(out);
  const auto refused = [&](const Arguments& more, const std::string& said) {
    EXPECT_TRUE(ended(levels(out, more), 2, said));
    EXPECT_EQ(hashed_contents(out), before);
  };
  refused({"--axes", "rub"}, "says other axes");
  EXPECT_TRUE(ended(run_program({"levels", model, "-o", out}), 2, "says other leaf, levels"));
  std::string other = test::read_text(model);
  ++other[other.size() - 100];
  test::write_text(model, other);
  refused({}, "says other model");

  test::write_text(folder / "mine/notes.txt", "");
  EXPECT_TRUE(ended(levels(folder.path()), 2, "has other files"));
  EXPECT_TRUE(ended(levels(model), 2, "is a file where a folder is needed"));
  EXPECT_TRUE(ended(run_program({"levels", out, "-o", out}), 2, ""));
  EXPECT_EQ(hashed_contents(out), before);
}

// 35.4 and 30.7 dB; where areas leave the low-pass out 32.5 and less.
TEST(LevelsScenes, LookLikeFox) {
  if (!test::switched_on("BINOSPLAT_LONG"))
    GTEST_SKIP() << "140,000 Gaussians take long on llvmpipe: BINOSPLAT_LONG=1";
  REQUIRE_SCENE("fox", scene);
  const test::TempFolder folder;
  ASSERT_TRUE(good(run_program({"levels", scene / "fox.ply", "-o", folder / "fox", "--levels", "3"})));
  const auto picture = [&](const std::string& model, const char* lod) {
    std::vector<std::string> line = {"render",  model,  "--cameras",     scene / "cameras.json",
                                     "--view",  "0001", "--mono",        "--size",
                                     "176x320", "-o",   folder / "p.png"};
    if (lod != nullptr) line.insert(line.end(), {"--lod", lod});
    EXPECT_TRUE(good(run_program(line)));
    return load_image(folder / "p.png");
  };
  const Image exact = picture(scene / "fox.ply", nullptr);
  EXPECT_GT(measure::psnr(exact, picture(folder / "fox", "1")), 35.0);
  EXPECT_GT(measure::psnr(exact, picture(folder / "fox", "2")), 30.3);
}

TEST(LevelsScaffold, AreRefused) {
  const test::TempFolder folder;
  fs::create_directories(folder / "model");
  test::write_scaffold(folder / "model", test::random_scaffold(1, {.anchors = 10}));
  EXPECT_TRUE(ended(run_program({"levels", folder / "model", "-o", folder / "out"}), 2,
                    "is a Scaffold-GS model, which makes its Gaussians anew for each eye"));
}

TEST_F(LevelsTest, HaveTheCamerasOfTheModelBesideThem) {
  add_cameras();
  ASSERT_TRUE(good(levels(out)));
  const auto beside = nlohmann::json::parse(test::read_text(out + "/cameras.json"));
  ASSERT_EQ(beside.size(), 4u);
  EXPECT_FALSE(beside[0].contains("time"));
  const auto picture = [&](const std::string& scene) {
    EXPECT_TRUE(good(run_program({"render", scene, "--view", "side", "--mono", "-o", folder / "p.png"})));
    return load_image(folder / "p.png");
  };
  EXPECT_GT(measure::psnr(picture(model), picture(out)), 25.0);
  // They stay where they are somebody's own by now, and broken ones are no reason to fail.
  test::write_text(out + "/cameras.json", nlohmann::json({test::camera_json("mine", 0)}).dump());
  ASSERT_TRUE(good(levels(out)));
  EXPECT_EQ(nlohmann::json::parse(test::read_text(out + "/cameras.json"))[0]["img_name"], "mine");
  test::write_text(folder / "cameras.json", "[");
  const std::string other = folder / "other";
  EXPECT_TRUE(ended(levels(other), 0, "no cameras are left beside the levels"));
  EXPECT_FALSE(fs::exists(other + "/cameras.json"));
}

// Of scenes of many sizes another size is another run.
TEST_F(LevelsTest, OfACityAndOfCopies) {
  const auto city = [&](const char* count) {
    return run_program({"levels", "demo:city", "--count", count, "--levels", "2", "-o", out});
  };
  const Outcome first = city("10000");
  ASSERT_TRUE(good(first));
  EXPECT_NE(first.out.find("    0       10000\n"), std::string::npos) << first.out;
  EXPECT_TRUE(ended(city("10001"), 2, "says other count"));
  const Outcome copies = levels(folder / "copies", {"--repeat", "2x1", "--spacing", "20"});
  ASSERT_TRUE(good(copies));
  EXPECT_NE(copies.out.find("    0         600\n"), std::string::npos) << copies.out;
  EXPECT_TRUE(
      ended(levels(folder / "copies", {"--repeat", "2x1", "--spacing", "21"}), 2, "says other spacing"));
}

TEST_F(LevelsTest, SayWhatTheyCannotTake) {
  EXPECT_TRUE(ended(levels(out, {"--levels", "0"}), 2, "--levels"));
  EXPECT_TRUE(ended(run_program({"levels", model, "-o", out, "--leaf", "1"}), 2, "--leaf"));
  EXPECT_TRUE(ended(levels(out, {"--lod", "1"}), 2, "level of detail 1: "));
  EXPECT_TRUE(ended(levels(out, {"--count", "10000"}), 2, "--count is for demo:city"));
  EXPECT_TRUE(ended(levels(out, {"--repeat", "2x2"}), 2, "--repeat and --spacing go together"));
  EXPECT_TRUE(ended(run_program({"levels", folder / "none.ply", "-o", out}), 2, "none.ply"));
  test::write_text(model, test::to_bytes(test::inria_file(0, 0)));
  EXPECT_TRUE(ended(levels(out), 2, "holds no Gaussians"));
  test::PlyFile none = test::small_model();
  for (std::size_t i = 0; i < none.rows.size(); ++i) none.at(i, "x") = NAN;
  test::write_text(model, test::to_bytes(none));
  EXPECT_TRUE(ended(levels(out), 2, "all of its 300 Gaussians have values that are not finite"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace binosplat
