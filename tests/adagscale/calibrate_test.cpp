#include "adagscale/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "adagscale/calibration_file.h"
#include "base/error.h"
#include "measure/metrics.h"
#include "scene/axes.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::adagscale {
namespace {

std::shared_ptr<render::GpuModel> on_gpu(const Model& model) {
  return std::make_shared<render::GpuModel>(test::gl_context(), model);
}

struct CalibratorTest : testing::Test {
  Model model = test::random_model(11, 800, 1);
  std::vector<CalibrationView> views;

  CalibratorTest() {
    for (const double x : {0.0, 0.3}) {
      Camera camera = test::front_camera(60, 40, 60.0);
      camera.name = x == 0.0 ? "left" : "right";
      camera.position.x = x;
      views.push_back({camera, {}});
    }
  }
};

/// Compares with the numbers from pictures that are read back and compared on the CPU.
TEST_F(CalibratorTest, CostsMatchPictures) {
  render::Frame frame(test::gl_context(), model);
  std::vector<Image> exact;
  for (CalibrationView& view : views) {
    const shared::View v = make_view(view.camera);
    frame.draw(std::span(&v, 1));
    exact.push_back(composite(frame.read_pictures().front(), glm::vec3(0.0f)));
    view.photo = quantised(exact.back());
    for (std::size_t k = 0; k < view.photo->data.size(); k += 7) view.photo->data[k] *= 0.8f;
    view.photo = quantised(*view.photo);
  }
  Calibrator by_quality(on_gpu(model), views, near_default, CalibrationTarget::Kind::quality);
  Calibrator by_drop(on_gpu(model), views, near_default, CalibrationTarget::Kind::drop);
  render::FrameSettings settings;
  EXPECT_EQ(by_quality.cost(settings).mean_db, 100.0) << "exact pictures are equal";
  EXPECT_EQ(by_drop.cost(settings).mean_db, 0.0);
  settings.threshold = Threshold::squared;
  settings.tolerance = 0.5f;
  double quality = 0.0, drop = 0.0, worst = 100.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const shared::View v = make_view(views[i].camera);
    frame.draw(std::span(&v, 1), settings);
    const Image image = composite(frame.read_pictures().front(), glm::vec3(0.0f));
    const double db = measure::psnr(image, exact[i]);
    quality += db / 2;
    worst = std::min(worst, db);
    drop += (measure::psnr(quantised(exact[i]), *views[i].photo) -
             measure::psnr(quantised(image), *views[i].photo)) /
            2;
  }
  const auto cost = by_quality.cost(settings);
  EXPECT_LT(quality, 60.0);
  EXPECT_NEAR(cost.mean_db, quality, 1e-3);
  EXPECT_NEAR(cost.worst_db, worst, 1e-3);
  EXPECT_GT(cost.pairs_removed, 0.02);
  EXPECT_NEAR(by_drop.cost(settings).mean_db, drop, 1e-3);
  settings.tolerance = 0.6f;
  EXPECT_GT(std::abs(by_quality.cost(settings).mean_db - quality), 1e-3)
      << "another tolerance goes unnoticed";
}

TEST_F(CalibratorTest, ReachesTarget) {
  Calibrator calibrator(on_gpu(model), views, near_default, CalibrationTarget::Kind::quality);
  const CalibrationEntry entry =
      calibrator.find({{.tolerance = 0.1f, .threshold = Threshold::squared}}, 42.0);
  EXPECT_GE(entry.worst_db, 42.0);
  EXPECT_LT(entry.worst_db, 42.5);
  EXPECT_LE(entry.worst_db, entry.reached_db);
  // A larger tolerance misses the target. The cost of a tolerance does not depend on earlier views'
  // measurements.
  render::FrameSettings settings{
      {.tolerance = static_cast<float>(1.1 * entry.tolerance), .threshold = Threshold::squared}};
  EXPECT_LT(calibrator.cost(settings).worst_db, 42.0);
  settings.transmittance = Transmittance::last;
  const double once = calibrator.cost(settings).mean_db;
  EXPECT_EQ(calibrator.cost(settings).mean_db, once);
}

TEST_F(CalibratorTest, CalibratesEachRule) {
  model = test::random_model(11, 300, 1);
  std::size_t drawn = 0;
  CalibrationSettings wanted{{CalibrationTarget::Kind::quality, 40.0}, {.bins = 5, .far = 6.5f}};
  const ThresholdCalibration whole =
      calibrate(on_gpu(model), views, near_default, wanted, [&](std::size_t n) { drawn = n; });
  ASSERT_EQ(whole.entries.size(), 1u) << "AdaGScale alone";
  EXPECT_EQ(whole.entries[0].threshold, Threshold::adagscale);
  EXPECT_EQ(whole.entries[0].transmittance, Transmittance::depth);
  EXPECT_GE(drawn, 2u * views.size());
  wanted.rules = {
      render::FrameSettings{{.threshold = Threshold::squared, .transmittance = Transmittance::last}},
      whole_method};
  const ThresholdCalibration c = calibrate(on_gpu(model), views, near_default, wanted);
  ASSERT_EQ(c.entries.size(), 2u);
  EXPECT_EQ(c.entries[0].transmittance, Transmittance::last);
  EXPECT_EQ(c.entries[1].tolerance, whole.entries[0].tolerance);
  EXPECT_EQ(c.depth_table.bounds.size(), 5);
  EXPECT_EQ(c.depth_table.far, 6.5f);
  EXPECT_TRUE(is_of(c, model));
  for (const CalibrationEntry& e : c.entries) {
    EXPECT_GE(e.worst_db, 40.0) << "in each view, not in their mean";
    EXPECT_GE(e.reached_db, e.worst_db);
    EXPECT_GT(e.tolerance, 0.0);
  }
  EXPECT_EQ(json_of(parse_calibration("c", json_of(c).dump())), json_of(c));
}

TEST_F(CalibratorTest, EmptyPicturesHoldNothing) {
  model = {};
  test::add(model, {0, 0, 4}, glm::vec3(0.05f), 0.05f, glm::vec3(0.3f));
  Calibrator calibrator(on_gpu(model), views, near_default, CalibrationTarget::Kind::quality);
  render::FrameSettings settings{{.tolerance = 1e6f, .threshold = Threshold::adagscale}};
  EXPECT_EQ(calibrator.cost(settings).worst_db, 0.0);
  const CalibrationEntry entry = calibrator.find({{.threshold = Threshold::adagscale}}, 40.0);
  EXPECT_LT(entry.pairs_removed, 1.0);
}

TEST_F(CalibratorTest, NeedsViewsAndPhotos) {
  EXPECT_THROW(Calibrator(on_gpu(model), {}, near_default, CalibrationTarget::Kind::quality), Error);
  EXPECT_THROW(Calibrator(on_gpu(model), views, near_default, CalibrationTarget::Kind::drop), Error);
}

// Cameras are in world coordinates: they see a model in other axes as in the world's.
TEST_F(CalibratorTest, AcceptsModelsOfAllAxes) {
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const auto pairs = [&](const Model& of) {
    Calibrator calibrator(on_gpu(of), views, near_default, CalibrationTarget::Kind::quality);
    EXPECT_EQ(calibrator.cost(of).mean_db, measure::equal_db);
    EXPECT_LT(calibrator.cost(test::random_model(63, 500, 0)).mean_db, 40.0) << "any model is as good";
    return calibrator.cost(of).pairs;
  };
  EXPECT_GT(pairs(model), 100.0);
  EXPECT_NEAR(pairs(turned), pairs(model), 2.0);
}

}  // namespace
}  // namespace binosplat::adagscale
