// Compares frames of Scaffold-GS models with the reference and the trainer's pictures. Checks that all other
// features of frames work with Gaussians that are decoded for each eye.

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/scaffold.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using render::FrameSettings;
using render::Stage;
using test::draw;
using test::same_bits;

const test::ScaffoldKind four_hundred{.anchors = 400};

std::vector<shared::View> eyes_at_scaffold(const stereo::RigSettings& settings = {.ipd = 0.2}) {
  const auto rig = stereo::make_rig(test::front_camera(150, 110, 140), settings);
  return {rig.views.begin(), rig.views.end()};
}

TEST(ScaffoldFrame, EqualsReference) {
  const Model model = test::scaffold_model(21, four_hundred);
  for (const double cant : {0.0, 5.0}) {
    const std::vector<shared::View> views = eyes_at_scaffold({.ipd = 0.2, .cant_degrees = cant});
    const std::vector<Picture> own = draw(model, views);
    for (std::size_t v = 0; v < 2; ++v)
      EXPECT_GE(test::psnr(own[v], reference::render(model, views[v])), 80.0) << v;
    EXPECT_LT(test::psnr(own[0], reference::render(model, views[1])), 60.0) << "injected: the other eye";
  }
}

TEST(ScaffoldFrame, DecodesIntoHalfPrecision) {
  const Model model = test::scaffold_model(21, four_hundred);
  const std::vector<Picture> half = draw(model, eyes_at_scaffold(), {.precision = PRECISION_HALF});
  for (std::size_t v = 0; v < 2; ++v) {
    const double db = test::psnr(half[v], reference::render(model, eyes_at_scaffold()[v]));
    EXPECT_GE(db, 60.0) << v;
    EXPECT_LT(db, 100.0) << v;
  }
}

TEST(ScaffoldFrame, PrecisionChangeDropsMeasurements) {
  const Model model = test::scaffold_model(21, four_hundred);
  FrameSettings settings = test::squared(0.5f, Transmittance::last);
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 2; ++n) frame.draw(eyes_at_scaffold(), settings);
  settings.precision = PRECISION_HALF;
  EXPECT_FALSE(frame.draw(eyes_at_scaffold(), settings).used_last);
  EXPECT_TRUE(frame.draw(eyes_at_scaffold(), settings).used_last);
}

TEST(ScaffoldFrame, EachEyeEqualsMono) {
  const Model model = test::scaffold_model(23, four_hundred);
  for (const double cant : {0.0, 5.0}) {
    const std::vector<shared::View> views = eyes_at_scaffold({.ipd = 0.2, .cant_degrees = cant});
    for (const FrameSettings& way : {FrameSettings{}, test::squared(0.05f)}) {
      const std::vector<Picture> both = draw(model, views, way);
      for (std::size_t v = 0; v < 2; ++v) EXPECT_TRUE(same_bits(both[v], draw(model, views[v], way))) << v;
    }
  }
}

TEST(ScaffoldFrame, DoesNotDependOnPages) {
  const Model model = test::scaffold_model(24, four_hundred);
  const std::vector<shared::View> views = eyes_at_scaffold();
  render::Frame frame(std::make_shared<render::GpuModel>(test::gl_context(), model, PRECISION_FULL, 70));
  frame.draw(views);
  const std::vector<Picture> whole = draw(model, views);
  for (std::size_t v = 0; v < 2; ++v) EXPECT_TRUE(same_bits(frame.read_pictures()[v], whole[v]));
}

TEST(ScaffoldFrame, ContinuesFromReferenceAfterAnyStage) {
  const Model model = test::scaffold_model(25, {.anchors = 200});
  const std::vector<shared::View> views = eyes_at_scaffold();
  const Picture expected = reference::render(model, views[1]);
  for (int n = 0; n < render::stages_with_reference; ++n) {
    const auto stage = static_cast<Stage>(n);
    EXPECT_GE(test::psnr(draw(model, views, {}, test::given(stage))[1], expected), 80.0) << name_of(stage);
  }
  const Model plain = test::random_model(1, 10, 0);
  EXPECT_ERROR(draw(plain, views, {}, test::given(Stage::decode)), "reference until decode",
               "is not a Scaffold-GS model");
}

TEST(ScaffoldFrame, EveryFrameDecodesAnew) {
  const Model model = test::scaffold_model(26, four_hundred);
  const std::vector<shared::View> views = eyes_at_scaffold();
  render::Frame frame(test::gl_context(), model);
  frame.draw(std::vector{views[1]});
  frame.draw(views);
  frame.draw(std::vector{views[0]});
  EXPECT_TRUE(same_bits(frame.read_pictures().front(), draw(model, views[0])));
  EXPECT_EQ(frame.draw(views).stages.front().name, "decode");
}

TEST(ScaffoldFrame, KeepsMeasurementsById) {
  const Model model = test::scaffold_model(27, four_hundred);
  const shared::View view = eyes_at_scaffold()[0];
  const std::size_t few = model.count() / 500;
  const std::vector<float> measured = test::measured_on_gpu(model, view);
  EXPECT_LE(test::differing(measured, model, view), few);
  Model fainter = placeholder_model(std::make_shared<Scaffold>(*model.scaffold));
  for (float& bias : fainter.scaffold->opacity.second_bias) bias -= 0.1f;
  EXPECT_GT(test::differing(measured, fainter, view), 10 * few);
}

TEST(ScaffoldFrame, RemovesHiddenPairs) {
  const Model model = test::scaffold_model(28, {.anchors = 1500});
  std::vector<shared::View> views = eyes_at_scaffold();
  const std::vector<Picture> exact = draw(model, views);
  const FrameSettings settings = test::squared(0.01f, Transmittance::last);
  render::Frame frame(test::gl_context(), model);
  const std::uint64_t first = frame.draw(views, settings).pairs;
  std::uint64_t pairs = first;
  for (int n = 0; n < 5; ++n) pairs = frame.draw(views, settings).pairs;
  EXPECT_LT(static_cast<double>(pairs), 0.9 * static_cast<double>(first));
  EXPECT_GT(test::psnr(frame.read_pictures()[0], exact[0]), 40.0);
}

TEST(ScaffoldFrame, ProbeSharesGaussiansOfView) {
  // The frame's error is almost 0 at 200 dB, so the probe must equal its view. A decoding for the probe alone
  // would cull other anchors.
  const Model model = test::scaffold_model(30, four_hundred);
  const std::vector<shared::View> views = eyes_at_scaffold();
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 2; ++n)
    EXPECT_GT(frame.draw(views, {{.quality = 200.0f, .threshold = Threshold::squared}}).quality, 100.0f) << n;
}

class ScaffoldScenes : public testing::TestWithParam<const char*> {};

TEST_P(ScaffoldScenes, MatchTrainerPhotosAndReference) {
  REQUIRE_SCENE("scaffold", scenes);
  REQUIRE_SCENE("fox", fox);
  const std::string name = GetParam();
  if (name != "0042" && !test::switched_on("BINOSPLAT_LONG")) {
    GTEST_SKIP() << "one of the longer runs: set BINOSPLAT_LONG=1";
  }
  const Model model = load_model(scenes / "fox");
  const std::vector<Camera> cameras = load_cameras(fox / "cameras.json");
  const auto camera =
      std::find_if(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.name == name; });
  ASSERT_NE(camera, cameras.end());
  const shared::View view = make_view(*camera);
  const auto on_black = [](const Picture& picture) { return quantised(composite(picture, glm::vec3(0.0f))); };
  const auto number = [&](const char* file) {
    return nlohmann::json::parse(std::ifstream(scenes / "fox" / file)).at(name);
  };
  const Image photo = load_image(fox / "photos" / (name + ".jpg"));
  const Picture drawn = draw(model, view, {.tiles = TILES_AABB});
  const fs::path inria = scenes / "fox" / "inria" / (name + ".png");
  if (fs::exists(inria)) {
    EXPECT_GT(measure::psnr(on_black(drawn), load_image(inria)), 65.0);
  }
  EXPECT_NEAR(measure::psnr(on_black(drawn), photo), number("psnr.json").get<double>(), 0.01);
  const Picture whole = draw(model, view, {.tiles = TILES_AABB, .anchor_cull = false});
  EXPECT_NEAR(measure::psnr(on_black(whole), photo), number("nocull.json").at("psnr").get<double>(), 0.01);
  const double db = test::psnr(draw(model, view), reference::render(model, view));
  EXPECT_GE(db, 70.0);
  RecordProperty("reference", std::to_string(db));
}

INSTANTIATE_TEST_SUITE_P(Fox, ScaffoldScenes,
                         testing::Values("0001", "0012", "0027", "0042", "0073", "0089", "0110"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace binosplat
