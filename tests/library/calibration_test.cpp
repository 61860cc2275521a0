// The settings from a calibration equal those with which the programs draw, bit for bit.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adagscale/calibrated_threshold.h"
#include "adagscale/calibration_file.h"
#include "library/renderer_fixture.h"
#include "render/frame.h"
#include "stereo/eyes.h"
#include "support/calibration.h"
#include "support/errors.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

const Settings by_adagscale{.threshold = Threshold::adagscale};

struct CalibrationTest : Library {
  test::TempFolder folder;
  Model model = test::random_model(3, 400, 2);
  adagscale::ThresholdCalibration found = test::sample_calibration();

  CalibrationTest() {
    found.gaussians = model.count();
    found.hash = adagscale::model_hash(model);
    found.perspective = {};
    found.focal = 50.0;
    found.depth_table = {8.0f, {1.0f, 0.5f, 0.25f, 0.125f}};
    found.views = {{"a", {0, 0, 0}}, {"b", {1, 0, 0}}};
    found.reach = 2.0;
    found.entries = {{Threshold::adagscale, Transmittance::depth, 3.0},
                     {Threshold::squared, Transmittance::one, 0.5}};
  }

  Calibration calibration() const {
    const std::filesystem::path path = folder / "c.json";
    test::write_text(path, json_of(found).dump());
    return {path, in_memory(model)};
  }

  /// Returns the left eye's picture as the programs draw it.
  std::vector<float> expected_left_eye(render::FrameSettings asked) const {
    const auto head = stereo::views_from_xr(quest_eyes(), placement, std::array{size, size});
    asked.background = glm::vec3(0.0f);
    asked.has_depths = false;
    const adagscale::CalibratedThreshold calibrated("c.json", found);
    render::Frame frame(*caller.context, model);
    frame.draw(head, calibrated.settings(asked, head.front(), model.axes));
    const Image image = composite(frame.read_pictures().front(), glm::vec3(0.0f));
    return {image.data.begin(), image.data.end()};
  }

  std::vector<float> drawn_left_eye(const Settings& settings) {
    Renderer renderer(caller.get_proc_address(), in_memory(model));
    renderer.draw(views(), placement, settings);
    const std::vector<float> rgba = read(0);
    std::vector<float> rgb;  // top row first
    for (int y = size.y - 1; y >= 0; --y) {
      for (int x = 0; x < size.x; ++x) {
        const float* const at = &rgba[4 * static_cast<std::size_t>(y * size.x + x)];
        rgb.insert(rgb.end(), at, at + 3);
      }
    }
    return rgb;
  }
};

TEST_F(CalibrationTest, DrawsLikePrograms) {
  Settings asked = by_adagscale;
  asked.background = glm::vec3(0.0f);
  const Settings settings = calibration().settings(views(), placement, asked);
  EXPECT_EQ(settings.depth_table.bounds, found.depth_table.bounds);
  EXPECT_GT(settings.tolerance.value_or(0.0f), 0.0f);
  const render::FrameSettings by_depth{by_adagscale};
  const std::vector<float> drawn = drawn_left_eye(settings);
  EXPECT_EQ(drawn, expected_left_eye(by_depth));
  EXPECT_NE(drawn, expected_left_eye({{.threshold = Threshold::exact}})) << "it leaves nothing out";
  found.depth_table.bounds = {1.0f, 1.0f, 1.0f, 1.0f};  // injected: another table
  EXPECT_NE(drawn, expected_left_eye(by_depth));
}

TEST_F(CalibrationTest, CompletesSettings) {
  const Calibration read = calibration();
  const Settings squared =
      read.settings(views(), placement, {.threshold = Threshold::squared, .depth = DepthKind::median});
  EXPECT_EQ(squared.threshold, Threshold::squared);
  EXPECT_EQ(squared.depth, DepthKind::median) << "what it says nothing of stays";
  EXPECT_EQ(squared.near_plane, found.near_plane);
  EXPECT_ERROR(read.settings(views(), placement, {.near_plane = 0.3}), "near plane");
  Settings own = by_adagscale;
  own.tolerance = 7.0f;
  EXPECT_EQ(read.settings(views(), placement, own).tolerance, 7.0f);
  EXPECT_EQ(read.settings(views(), placement, own).depth_table.bounds, found.depth_table.bounds);
  EXPECT_EQ(read.settings(views(), placement, {}).threshold, Threshold::adagscale) << "the first entry's";
  Settings quality = by_adagscale;
  quality.quality = 40.0f;
  EXPECT_FALSE(read.settings(views(), placement, quality).tolerance);
  // A camera more than 2 from each calibrated view is drawn exactly.
  Placement far = placement;
  far.origin.z -= 3.0;
  const Settings exact = read.settings(views(), far);
  EXPECT_EQ(exact.threshold, Threshold::exact);
  EXPECT_EQ(exact.transmittance, Transmittance::one);
  EXPECT_FALSE(exact.tolerance);
  EXPECT_EQ(drawn_left_eye(exact), drawn_left_eye({})) << "it is no setting of a renderer's";
}

TEST_F(CalibrationTest, RendererFindsK) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  Settings asked = by_adagscale;
  asked.background = glm::vec3(0.0f);
  const Report exact = renderer.draw(views(), placement, over_black),
               first = renderer.draw(views(), placement, asked),
               second = renderer.draw(views(), placement, asked);
  EXPECT_EQ(first.threshold, Threshold::adagscale);
  EXPECT_EQ(exact.threshold, Threshold::exact);
  EXPECT_LT(first.pairs, exact.pairs);
  EXPECT_EQ(first.tolerance, second.tolerance) << "it is found once";
}

TEST_F(CalibrationTest, RejectsMismatch) {
  const Calibration read = calibration();
  Settings asked = by_adagscale;
  asked.transmittance = Transmittance::one;
  EXPECT_ERROR(read.settings(views(), placement, asked), "c.json", "no entry for threshold adagscale");
  asked = by_adagscale;
  asked.projection = Projection::tangent;
  EXPECT_ERROR(read.settings(views(), placement, asked), "tangent");
  EXPECT_ERROR(read.settings({}, placement), "views");
  model.opacity[0] *= 0.5f;
  EXPECT_ERROR(Calibration(folder / "c.json", in_memory(model)), "another model");
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  asked = by_adagscale;
  asked.tolerance = 1.0f;
  asked.transmittance = Transmittance::depth;
  EXPECT_ERROR(renderer.draw(views(), placement, asked), "needs depth_table");
}

}  // namespace
}  // namespace binosplat
