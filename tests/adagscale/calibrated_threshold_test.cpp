#include "adagscale/calibrated_threshold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/axes.h"
#include "support/calibration.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::adagscale {
namespace {

struct CalibratedThresholdTest : testing::Test {
  Model model = test::random_model(3, 100, 1);
  ThresholdCalibration calibration = test::sample_calibration();  // at a focal length of 100 px

  CalibratedThresholdTest() {
    calibration.gaussians = model.count();
    calibration.hash = model_hash(model);
    calibration.perspective = {};
  }
  CalibratedThreshold calibrated() const { return {"c.json", calibration}; }
  /// Returns a view at a position of the world, in the model's frame.
  shared::View view(double focal, const glm::dvec3& at = {0.5, 0.0, 0.0}) const {
    Camera camera = test::front_camera(60, 40, focal);
    camera.position = at;
    return make_view(into_axes(camera, model.axes));
  }
};

TEST_F(CalibratedThresholdTest, UsesToleranceOfEntry) {
  FrameSettings found = calibrated().settings({{.threshold = Threshold::adagscale}}, view(100.0), model.axes);
  EXPECT_EQ(found.tolerance, 2.0f);
  EXPECT_EQ(found.depth_table.bounds, calibration.depth_table.bounds);
  found = calibrated().settings({{.threshold = Threshold::adagscale}}, view(200.0), model.axes);
  EXPECT_FLOAT_EQ(*found.tolerance, 2.0f * std::pow(2.0f, 1.25f));
  found = calibrated().settings({{.threshold = Threshold::squared, .transmittance = Transmittance::last}},
                                view(100.0), model.axes);
  EXPECT_EQ(found.tolerance, 0.01f);
  EXPECT_EQ(found.transmittance, Transmittance::last);
  found = calibrated().settings({{.tolerance = 7.0f, .threshold = Threshold::adagscale}}, view(200.0),
                                model.axes);
  EXPECT_EQ(found.tolerance, 7.0f) << "one that is asked for stays";
  EXPECT_EQ(found.depth_table.bounds, calibration.depth_table.bounds);
}

TEST_F(CalibratedThresholdTest, IsExactOutsideCalibration) {
  // Positions within 6 world units of a calibrated view are covered, whatever the model's axes and origin
  // are.
  model.axes = {"LUF", {3.0, 2.0, 1.0}};
  EXPECT_TRUE(calibrated().covers(view(100.0, {1, 8.9, 0}), model.axes));
  EXPECT_EQ(calibrated()
                .settings({{.threshold = Threshold::adagscale}}, view(100.0, {1, 8.9, 0}), model.axes)
                .tolerance,
            2.0f);
  EXPECT_FALSE(calibrated().covers(view(100.0, {1, 9.1, 0}), model.axes));
  const FrameSettings far =
      calibrated().settings({{.threshold = Threshold::adagscale}}, view(100.0, {1, 9.1, 0}), model.axes);
  EXPECT_EQ(far.threshold, Threshold::exact);
  EXPECT_EQ(far.transmittance, Transmittance::one);
  EXPECT_FALSE(far.tolerance);
}

TEST_F(CalibratedThresholdTest, NamesRuleOfFirstEntry) {
  const auto rule_for = [&](const FrameSettings& asked) {
    const FrameSettings found = calibrated().with_rule(asked);
    return std::pair(found.threshold, found.transmittance);
  };
  using Rule = std::pair<std::optional<Threshold>, std::optional<Transmittance>>;
  EXPECT_EQ(rule_for({}), Rule(Threshold::adagscale, Transmittance::one));
  EXPECT_EQ(rule_for({{.threshold = Threshold::squared}}), Rule(Threshold::squared, Transmittance::last));
  EXPECT_EQ(rule_for({{.transmittance = Transmittance::last}}),
            Rule(Threshold::squared, Transmittance::last));
  EXPECT_EQ(rule_for({{.threshold = Threshold::exact}}).first, Threshold::exact);
  EXPECT_EQ(rule_for({{.quality = 40.0f}}), Rule()) << "a frame of a quality needs no entry";
}

TEST_F(CalibratedThresholdTest, RejectsMismatch) {
  const FrameSettings asked{{.threshold = Threshold::adagscale}};
  calibrated().check_drawing(asked, model, calibration.near_plane);
  calibrated().check_model(model);
  EXPECT_ERROR(
      calibrated().with_rule({{.threshold = Threshold::adagscale, .transmittance = Transmittance::depth}}),
      "c.json", "no entry for threshold adagscale with transmittance depth");
  EXPECT_ERROR(calibrated().check_model(test::random_model(4, 100, 1)), "c.json",
               "another model (fox.ply, 100 Gaussians)");
  EXPECT_ERROR(
      calibrated().check_drawing({{.threshold = Threshold::adagscale, .projection = Projection::tangent}},
                                 model, calibration.near_plane),
      "is for order depth, projection affine", "the frame has order depth, projection tangent");
  EXPECT_ERROR(calibrated().check_drawing(asked, model, 0.01), "a near plane of 0.2", "a near plane of 0.01");
  model.antialiased = true;
  EXPECT_ERROR(calibrated().check_drawing(asked, model, calibration.near_plane), "without anti-aliasing",
               "with anti-aliasing");
  model.antialiased = false;
  model.kernel_px2 = 0.1;
  EXPECT_ERROR(calibrated().check_drawing(asked, model, calibration.near_plane), "0.3 px^2", "0.1 px^2");
}

TEST_F(CalibratedThresholdTest, WithoutCalibrationKeepsSettings) {
  const CalibratedThreshold none;
  EXPECT_TRUE(none.covers(view(100.0, {1, 1e6, 0}), model.axes));
  const FrameSettings same =
      none.settings({{.tolerance = 0.5f, .threshold = Threshold::squared}}, view(100.0), model.axes);
  EXPECT_EQ(same.threshold, Threshold::squared);
  EXPECT_EQ(same.tolerance, 0.5f);
}

}  // namespace
}  // namespace binosplat::adagscale
