// render --gpu-memory and --detail: levels of detail that fit into memory, and that follow a path.

#include <cmath>

#include "app/scene.h"
#include "support/broken.h"
#include "support/level_errors.h"

namespace binosplat {
namespace {

struct RenderLevels : SceneTest {
  void SetUp() override {
    REQUIRE_FIXTURES(fixtures);
    copy.emplace(fixtures / "sog/st-lod");
  }

  /// Draws the levels, with a report in j.
  Outcome render(const Words& words) const {
    return run_into_out(joined({"render", copy->path(), "--json", folder / "j"}, words));
  }
  json report() const { return load_json(folder / "j"); }
  json levels(std::size_t view = 0) const { return report()["views"][view]["levels_of_detail"]; }

  /// Writes a path of heads that look along z, and returns its file.
  std::string save_path(const std::vector<double>& along_z) const {
    json cameras;
    for (const double z : along_z) {
      cameras.push_back(camera_json(fmt::format("z{}", z), 0.0));
      cameras.back()["position"][2] = z;
    }
    return save("path.json", cameras);
  }

  std::optional<test::Copy> copy;
};

TEST_F(RenderLevels, RefineNearCameraWithinMemory) {
  // The frame of both eyes takes 0.9 MB, and a thousand Gaussians take 0.3 MB.
  const struct {
    const char *eye, *memory, *said;
  } cases[] = {
      {"0,0,-20", "20", "1000 Gaussians of level 0\n"},
      {"0,0,-20", "1e13", "1000 Gaussians of level 0\n"},  // more than an integer holds
      {"0,0,-20", "1e30", "1000 Gaussians of level 0\n"},
      {"12,0,13", "1.015", "248 Gaussians of level 0, 185 Gaussians of level 1"},
      {"-14,-1,0", "1.075", "505 Gaussians of level 0, 130 Gaussians of level 1"},
      {"0,0,-20", "0.5", "the coarsest levels of detail have 250 Gaussians"},
  };
  for (const auto& [eye, memory, said] : cases)
    EXPECT_TRUE(
        ended(render({"--eye", eye, "--at", "0,0,5", "--size", "64x64", "--gpu-memory", memory}), 0, said));
  EXPECT_TRUE(ended(render({"--orbit", "1", "--size", "64x64", "--gpu-memory", "20"}), 0,
                    "1000 Gaussians of level 0\n"));
}

TEST_F(RenderLevels, FollowPathAndReportLoss) {
  const std::string path = save_path({-200, -60, -59, -30, -8});
  const auto along = [&](const Words& more, const std::string& to) {
    EXPECT_TRUE(good(render(joined({"--path", path, "-o", folder / to}, more))));
    return report();
  };
  along({}, "finest");
  const json views = along({"--detail", "3"}, "followed")["views"];
  std::size_t before = 0;
  for (const auto& view : views) {
    const auto& levels = view["levels_of_detail"];
    EXPECT_GE(levels["gaussians"], before) << view["name"];
    EXPECT_EQ(levels["switched"], before != 0 && levels["gaussians"] != before) << view["name"];
    before = levels["gaussians"];
    const std::string picture = view["name"].get<std::string>() + "_left.png";
    EXPECT_EQ(std::isinf(psnr_of_files(folder / "followed" / picture, folder / "finest" / picture)),
              before == 1000);
  }
  EXPECT_EQ(views[0]["levels_of_detail"]["gaussians"], 250);
  EXPECT_EQ(before, 1000u);
  // Injected: the coarsest levels on the whole path differ near the model.
  along({"--lod", "1"}, "coarse");
  EXPECT_LT(psnr_of_files(folder / "followed/z-8_left.png", folder / "coarse/z-8_left.png"), 50.0);
  // In memory that holds fewer Gaussians.
  const json small = along({"--detail", "0", "--gpu-memory", "1.35"}, "small");
  ASSERT_EQ(small["views"].size(), 5u);
  const auto bytes = [&](const char* of) { return small["memory"][of].get<double>(); };
  EXPECT_LE(bytes("model_bytes") + bytes("min_frame_bytes"), 1.35e6) << "places that are empty included";
  for (const auto& view : small["views"]) {
    EXPECT_LT(view["levels_of_detail"]["gaussians"], 1000);
    EXPECT_GT(view["levels_of_detail"]["gaussians"], 250);
  }
}

TEST_F(RenderLevels, ReachRequestedPsnr) {
  const Words line = {"--path", save_path({-800, -20}), "--detail", "40dB"};
  EXPECT_TRUE(ended(render(line), 2, "lacks the errors of its levels"));
  test::add_level_errors(*copy);
  const Outcome told = checked(render(line));
  EXPECT_EQ(report()["settings"]["detail_db"], 40.0);
  EXPECT_FALSE(report()["settings"].contains("detail_px"));
  const json far = levels(0), near = levels(1);
  EXPECT_LT(far["gaussians"], near["gaussians"]);
  EXPECT_GT(near["gaussians"], 250);
  // The coarsest level, 250 Gaussians, has 35 dB from any distance, whatever the file says.
  EXPECT_GT(far["gaussians"], 250);
  EXPECT_TRUE(has(told.out, "predicted dB"));
  EXPECT_GE(far["predicted_psnr_db"], 40.0);
  EXPECT_TRUE(has(told.out, fmt::format("  {:.2f}  ", far["predicted_psnr_db"].get<double>())));
}

// Levels of single pictures depend neither on earlier pictures nor on views to which a head might turn.
TEST_F(RenderLevels, SinglePicturesAreIndependent) {
  test::add_level_errors(*copy);
  const std::string cameras = save_path({-20, -60, 16});
  const auto gaussians_of = [&](const Words& words) {
    EXPECT_TRUE(good(render(joined({"--detail", "40dB"}, words))));
    std::vector<std::size_t> gaussians;
    const json drawn = report();
    for (const auto& view : drawn["views"]) gaussians.push_back(view["levels_of_detail"]["gaussians"]);
    return gaussians;
  };
  const auto views = [&](const char* names, const Words& more = {}) {
    return gaussians_of(joined({"--cameras", cameras, "--view", names}, more));
  };
  const std::vector<std::size_t> all = views("all");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_GT(all[0], 250u);
  EXPECT_EQ(all[2], 250u) << "all of it is behind";
  EXPECT_EQ(views("z-20"), std::vector(1, all[0]));
  EXPECT_EQ(views("z-60"), std::vector(1, all[1]));
  EXPECT_GT(gaussians_of({"--path", cameras}).back(), 250u) << "injected: heads turn";
  // Single pictures do not depend on each other, so shards may draw them.
  views("all", {"-o", folder / "whole"});
  views("all", {"-o", folder / "parts", "--shard", "2/2"});
  EXPECT_EQ(read_text(folder / "parts/z-60_left.png"), read_text(folder / "whole/z-60_left.png"));
  EXPECT_FALSE(fs::exists(folder / "parts/z-20_left.png"));
}

// --quality covers both: levels get half of the allowed error, and the frame gets the rest.
TEST_F(RenderLevels, ShareErrorWithFrame) {
  const Words line = {"--cameras", save_path({-400}), "--quality", "40"};
  const auto render_with = [&](const Words& more) { return render(joined(line, more)); };
  ASSERT_TRUE(good(render_with({})));
  EXPECT_FALSE(report()["views"][0].contains("levels_of_detail")) << "the finest";
  test::add_level_errors(*copy);
  // Of so few Gaussians all are drawn, unless memory is short.
  ASSERT_TRUE(good(render_with({})));
  EXPECT_EQ(levels()["gaussians"], 1000);
  ASSERT_TRUE(good(render_with({"--gpu-memory", "1000"})));
  const json view = report()["views"][0], of_view = levels();
  const auto error = [](const json& db) { return std::pow(10.0, -0.1 * db.get<double>()); };
  EXPECT_LT(of_view["gaussians"], 1000);
  EXPECT_GE(of_view["predicted_psnr_db"], 43.0);
  EXPECT_NEAR(error(view["reported_psnr_db"]), error(of_view["predicted_psnr_db"]), 1e-9);
  EXPECT_TRUE(view["probed_psnr_db"].is_null()) << "a single picture of these levels is exact";
  // --detail determines the levels.
  EXPECT_TRUE(ended(render_with({"--detail", "40dB"}), 2, "uses up the error that --quality"));
  ASSERT_TRUE(good(render_with({"--detail", "60dB"})));
  EXPECT_GT(levels()["gaussians"], of_view["gaussians"]);
}

using LevelOptionErrors = SceneTest;

TEST_F(LevelOptionErrors, SuggestFix) {
  const char* const none = "has no levels of detail";
  expect_refused({{{"--gpu-memory", "100"}, none},
                  {{"--gpu-memory", "100", "--lod", "1"}, "leave one of them out"},
                  {{"--detail", "2"}, none},
                  {{"--detail", "2px"}, none},
                  {{"--detail", "40DB"}, none},
                  {{"--detail", "2", "--lod", "1"}, "leave one of them out"},
                  {{"--gpu-memory", "0"}, "--gpu-memory"}});
  for (const char* wrong : {"-1", "inf", "5 px", "dB", "40 dB", "19.9dB", "80.1dB", "-40dB"})
    expect_refused(
        {{{"--detail", wrong}, "expected pixels as in 5px, or decibels from 20 to 80 as in 40dB"}});
  expect_refused_after({"render", "demo:room"},
                       {{{"--gpu-memory", "100"}, "--gpu-memory is for model files"}});
}

}  // namespace
}  // namespace binosplat
