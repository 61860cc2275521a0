// binosplat render --gpu-memory and --detail: levels of detail that fit, and that follow a path.

#include <fmt/format.h>

#include <cmath>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"
#include "support/broken.h"
#include "support/fixtures.h"
#include "support/level_errors.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;

TEST(RenderLevels, FitTheMemoryNearTheCameraFirst) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const auto render = [&](const std::string& eye, const std::string& memory) {
    return test::run_program({"render", fixtures / "sog/st-lod", "--eye", eye, "--at", "0,0,5", "--size",
                              "64x64", "--gpu-memory", memory, "-o", folder / "out"});
  };
  // Both eyes' frame takes 0.9 MB, and a thousand Gaussians 0.3.
  const Outcome all = render("0,0,-20", "20");
  ASSERT_TRUE(good(all));
  EXPECT_NE(all.err.find("1000 Gaussians of level 0\n"), std::string::npos) << all.err;
  for (const char* more_than_numbers_hold : {"1e13", "1e30"}) {
    const Outcome more = render("0,0,-20", more_than_numbers_hold);
    ASSERT_TRUE(good(more));
    EXPECT_NE(more.err.find("1000 Gaussians of level 0\n"), std::string::npos) << more.err;
  }
  const Outcome right = render("12,0,13", "1.015");
  ASSERT_TRUE(good(right));
  EXPECT_NE(right.err.find("248 Gaussians of level 0, 185 Gaussians of level 1"), std::string::npos)
      << right.err;
  const Outcome left = render("-14,-1,0", "1.075");
  ASSERT_TRUE(good(left));
  EXPECT_NE(left.err.find("505 Gaussians of level 0, 130 Gaussians of level 1"), std::string::npos)
      << left.err;
  const Outcome none = render("0,0,-20", "0.5");
  ASSERT_TRUE(good(none));
  EXPECT_NE(none.err.find("even its coarsest levels of detail have 250 Gaussians"), std::string::npos)
      << none.err;
  const Outcome framed = test::run_program({"render", fixtures / "sog/st-lod", "--orbit", "1", "--size",
                                            "64x64", "--gpu-memory", "20", "-o", folder / "out"});
  ASSERT_TRUE(good(framed));
  EXPECT_NE(framed.err.find("1000 Gaussians of level 0\n"), std::string::npos) << framed.err;
}

/// A path of heads that look along z.
std::string write_path(const test::TempFolder& folder, const std::vector<double>& along_z) {
  nlohmann::json cameras;
  for (const double z : along_z) {
    nlohmann::json camera = test::camera_json(fmt::format("z{}", z), 0.0);
    camera["position"][2] = z;
    cameras.push_back(camera);
  }
  test::write_text(folder / "path.json", cameras.dump());
  return folder / "path.json";
}

TEST(RenderLevels, FollowAPathAndTellWhatTheyCost) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const std::string path = write_path(folder, {-200, -60, -59, -30, -8});
  const auto render = [&](const std::vector<std::string>& more, const std::string& out) {
    std::vector<std::string> arguments = {
        "render", fixtures / "sog/st-lod", "--path", path, "-o", folder / out,
        "--json", folder / (out + ".json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program(arguments);
  };
  ASSERT_TRUE(good(render({"--detail", "3", "--detail-report"}, "followed")));
  ASSERT_TRUE(good(render({}, "finest")));
  const auto views = test::load_json(folder / "followed.json")["views"];
  std::size_t before = 0;
  for (const auto& view : views) {
    const auto& levels = view["levels_of_detail"];
    EXPECT_GE(levels["gaussians"], before) << view["name"];
    EXPECT_EQ(levels["switched"], before != 0 && levels["gaussians"] != before) << view["name"];
    EXPECT_EQ(levels.contains("switch_psnr_db"), levels["switched"]) << view["name"];
    before = levels["gaussians"];
    // What it says of its pictures against the finest, within the rounding to 8 bits.
    const std::string name = view["name"];
    const auto picture = [&](const std::string& out, const char* eye) {
      return load_image(folder / (out + "/" + name + eye + ".png"));
    };
    double error = 0.0;
    for (const char* eye : {"_left", "_right"})
      error += 0.5 * std::pow(10.0, -0.1 * measure::psnr(picture("followed", eye), picture("finest", eye)));
    if (before == 1000) {
      EXPECT_EQ(error, 0.0) << name;
    } else {
      EXPECT_NEAR(-10.0 * std::log10(error), levels["finest_psnr_db"], 0.5) << name;
    }
  }
  EXPECT_EQ(views[0]["levels_of_detail"]["gaussians"], 250);
  EXPECT_EQ(before, 1000u);
  // Planted: the coarsest levels for all of the path are not what is near.
  ASSERT_TRUE(good(render({"--lod", "1"}, "coarse")));
  EXPECT_GT(measure::largest_difference(load_image(folder / "followed/z-8_left.png"),
                                        load_image(folder / "coarse/z-8_left.png"))
                .max,
            0.1);
  // Within a memory that has room for fewer.
  ASSERT_TRUE(good(render({"--detail", "0", "--gpu-memory", "1.35"}, "small")));
  const auto small = test::load_json(folder / "small.json");
  ASSERT_EQ(small["views"].size(), 5u);
  const auto bytes = [&](const char* of) { return small["memory"][of].get<double>(); };
  EXPECT_LE(bytes("model_bytes") + bytes("frame_bytes_at_least"), 1.35e6) << "places that are empty included";
  for (const auto& view : small["views"]) {
    EXPECT_LT(view["levels_of_detail"]["gaussians"], 1000);
    EXPECT_GT(view["levels_of_detail"]["gaussians"], 250);
  }
}

TEST(RenderLevels, ByDecibelsAsAFileTells) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const test::Copy copy(fixtures / "sog/st-lod");
  const auto render = [&] {
    return test::run_program({"render", copy.path(), "--path", write_path(folder, {-800, -20}), "--detail",
                              "40dB", "--detail-report", "-o", folder / "out", "--json", folder / "j"});
  };
  EXPECT_TRUE(ended(render(), 2, "has no errors of its levels to go by"));
  test::add_level_errors(copy);
  const Outcome told = render();
  ASSERT_TRUE(good(told));
  const auto report = test::load_json(folder / "j");
  EXPECT_EQ(report["settings"]["detail_db"], 40.0);
  EXPECT_FALSE(report["settings"].contains("detail_px"));
  const auto far = report["views"][0]["levels_of_detail"], near = report["views"][1]["levels_of_detail"];
  EXPECT_LT(far["gaussians"], near["gaussians"]);
  EXPECT_GT(near["gaussians"], 250);
  // The coarsest, 250, have 35 dB from however far away, whatever the file says of them.
  EXPECT_GT(far["gaussians"], 250);
  EXPECT_GE(far["finest_psnr_db"], 40.0);
  EXPECT_GE(far["predicted_psnr_db"], 40.0);
  EXPECT_NE(told.out.find("predicted dB  finest dB"), std::string::npos) << told.out;
  for (const char* key : {"predicted_psnr_db", "finest_psnr_db"})
    EXPECT_NE(told.out.find(fmt::format("  {:.2f}  ", far[key].get<double>())), std::string::npos)
        << told.out;
}

// Neither by those before them, nor by what heads might turn to.
TEST(RenderLevels, OfSinglePicturesGoByThemAlone) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const test::Copy copy(fixtures / "sog/st-lod");
  test::add_level_errors(copy);
  const std::string cameras = write_path(folder, {-20, -60, 16});
  const auto levels = [&](const std::vector<std::string>& of) {
    std::vector<std::string> arguments = {"render", copy.path(),    "--detail", "40dB",
                                          "-o",     folder / "out", "--json",   folder / "j"};
    arguments.insert(arguments.end(), of.begin(), of.end());
    EXPECT_TRUE(good(test::run_program(arguments)));
    std::vector<std::size_t> gaussians;
    const auto report = test::load_json(folder / "j");
    for (const auto& view : report["views"]) gaussians.push_back(view["levels_of_detail"]["gaussians"]);
    return gaussians;
  };
  const std::vector<std::size_t> all = levels({"--cameras", cameras, "--view", "all"});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_GT(all[0], 250u);
  EXPECT_EQ(all[2], 250u) << "all of it is behind";
  EXPECT_EQ(levels({"--cameras", cameras, "--view", "z-20"}), std::vector(1, all[0]));
  EXPECT_EQ(levels({"--cameras", cameras, "--view", "z-60"}), std::vector(1, all[1]));
  EXPECT_GT(levels({"--path", cameras}).back(), 250u) << "planted: heads turn";
  // So they may be drawn in parts.
  const auto draw = [&](const char* to, const char* shard) {
    return test::run_program({"render", copy.path(), "--detail", "40dB", "--cameras", cameras, "--view",
                              "all", "--shard", shard, "-o", folder / to});
  };
  ASSERT_TRUE(good(draw("whole", "1/1")) && good(draw("parts", "2/2")));
  EXPECT_EQ(test::read_text(folder / "parts/z-60_left.png"), test::read_text(folder / "whole/z-60_left.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "parts/z-20_left.png"));
}

// --quality is for both: levels get half of what may be lost, and a frame what they leave.
TEST(RenderLevels, ShareAQuality) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const test::Copy copy(fixtures / "sog/st-lod");
  const std::string cameras = write_path(folder, {-400});
  const auto render = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", copy.path(), "--cameras",    cameras,  "--quality",
                                          "40",     "-o",        folder / "out", "--json", folder / "j"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program(arguments);
  };
  EXPECT_TRUE(ended(render({"--detail-report"}), 2, "does not say what its levels lose"));
  ASSERT_TRUE(good(render({})));
  EXPECT_FALSE(test::load_json(folder / "j")["views"][0].contains("levels_of_detail")) << "the finest";
  test::add_level_errors(copy);
  // Of so few all are drawn, unless memory is short.
  ASSERT_TRUE(good(render({})));
  EXPECT_EQ(test::load_json(folder / "j")["views"][0]["levels_of_detail"]["gaussians"], 1000);
  ASSERT_TRUE(good(render({"--detail-report", "--gpu-memory", "1000"})));
  const auto view = test::load_json(folder / "j")["views"][0];
  const auto& levels = view["levels_of_detail"];
  const auto error = [](const nlohmann::json& db) { return std::pow(10.0, -0.1 * db.get<double>()); };
  EXPECT_LT(levels["gaussians"], 1000);
  EXPECT_GE(levels["predicted_psnr_db"], 43.0);
  EXPECT_NEAR(error(view["told_psnr_db"]), error(levels["predicted_psnr_db"]) + error(view["probed_psnr_db"]),
              1e-9);
  EXPECT_GE(view["told_psnr_db"], 39.5);
  EXPECT_GT(view["probed_psnr_db"], view["told_psnr_db"]) << "planted: the frame's alone";
  // What was asked for levels is theirs.
  EXPECT_TRUE(ended(render({"--detail", "40dB"}), 2, "leaves nothing for what a frame leaves out"));
  ASSERT_TRUE(good(render({"--detail", "60dB"})));
  EXPECT_GT(test::load_json(folder / "j")["views"][0]["levels_of_detail"]["gaussians"], levels["gaussians"]);
}

using LevelErrors = test::SceneTest;

TEST_F(LevelErrors, SayWhatToDo) {
  EXPECT_TRUE(ended(render({"--gpu-memory", "100", "-o", out}), 2, "no levels of detail to choose from"));
  EXPECT_TRUE(ended(render({"--gpu-memory", "100", "--lod", "1", "-o", out}), 2, "leave one of them out"));
  EXPECT_TRUE(ended(render({"--detail", "2", "-o", out}), 2, "no levels of detail to choose from"));
  EXPECT_TRUE(ended(render({"--detail", "2", "--lod", "1", "-o", out}), 2, "leave one of them out"));
  EXPECT_TRUE(ended(render({"--detail-report", "-o", out}), 2, "--detail"));
  EXPECT_TRUE(ended(render({"--detail", "40DB", "-o", out}), 2, "no levels of detail to choose from"));
  for (const char* wrong : {"-1", "nan", "inf", "5px", "dB", "40 dB", "19.9dB", "80.1dB", "-40dB"}) {
    EXPECT_TRUE(ended(render({"--detail", wrong, "-o", out}), 2,
                      "expected pixels as in 5, or decibels from 20 to 80 as in 40dB"))
        << wrong;
  }
  EXPECT_TRUE(ended(render({"--gpu-memory", "0", "-o", out}), 2, "--gpu-memory"));
  EXPECT_TRUE(ended(test::run_program({"render", "demo:room", "--gpu-memory", "100", "-o", out}), 2,
                    "--gpu-memory is for model files"));
  EXPECT_EQ(folder.files(), std::set<std::string>{"model.ply"});
}

}  // namespace
}  // namespace binosplat
