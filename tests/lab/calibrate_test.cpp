#include "lab/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "formats/training/calibration_file.h"
#include "lab/bench_settings.h"
#include "measure/metrics.h"
#include "scene/axes.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using nlohmann::ordered_json;

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
  Calibrator by_quality(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::quality);
  Calibrator by_drop(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::drop);
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
  Calibrator calibrator(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::quality);
  const CalibrationEntry entry =
      calibrator.find({{.tolerance = 0.1f, .threshold = Threshold::squared}}, 42.0);
  EXPECT_GE(entry.reached_db, 42.0);
  EXPECT_LT(entry.reached_db, 42.5);
  EXPECT_LE(entry.worst_db, entry.reached_db);
  // A larger tolerance misses the target. The cost of a tolerance does not depend on earlier views'
  // measurements.
  render::FrameSettings settings{
      {.tolerance = static_cast<float>(1.1 * entry.tolerance), .threshold = Threshold::squared}};
  EXPECT_LT(calibrator.cost(settings).mean_db, 42.0);
  settings.transmittance = Transmittance::last;
  const double once = calibrator.cost(settings).mean_db;
  EXPECT_EQ(calibrator.cost(settings).mean_db, once);
}

TEST_F(CalibratorTest, CalibratesAllSettings) {
  model = test::random_model(11, 300, 1);
  std::size_t done = 0;
  const ThresholdCalibration c =
      calibrate(test::gl_context(), model, views, near_default,
                {{CalibrationTarget::Kind::quality, 40.0}, {.bins = 5, .far = 6.5f}},
                [&](std::size_t, std::size_t) { ++done; });
  EXPECT_EQ(c.entries.size(), calibrated_settings().size());
  EXPECT_EQ(done, c.entries.size());
  EXPECT_EQ(c.depth_table.bounds.size(), 5);
  EXPECT_EQ(c.depth_table.far, 6.5f);
  EXPECT_TRUE(is_of(c, model));
  for (const CalibrationEntry& e : c.entries) {
    EXPECT_GE(e.reached_db, 40.0);
    EXPECT_GT(e.tolerance, 0.0);
  }
  EXPECT_EQ(json_of(parse_calibration("c", json_of(c).dump())), json_of(c));
}

TEST_F(CalibratorTest, ResumesFromKeptEntries) {
  std::map<std::string, ordered_json> kept;
  std::size_t measured = 0, most = 1000;
  const auto run = [&](const std::vector<ThresholdVariant>& rules) {
    const StepCache cache = [&](const std::string& step, const std::function<ordered_json()>& measure) {
      if (kept.contains(step)) return kept[step];
      if (measured == most) throw std::runtime_error("ended");
      ++measured;
      return kept[step] = ordered_json::parse(measure().dump());
    };
    ordered_json json =
        json_of(calibrate(test::gl_context(), model, views, near_default,
                          {{CalibrationTarget::Kind::quality, 40.0}, {.bins = 5}, rules, cache}));
    json["depth_table"].erase("seconds");
    for (ordered_json& entry : json["entries"]) entry.erase("seconds");
    return json;
  };
  const std::vector<ThresholdVariant> two = {{Threshold::squared, Transmittance::one},
                                             {Threshold::peripheral, Transmittance::one}};
  const ordered_json whole = run(two);
  EXPECT_EQ(whole["entries"].size(), 2);
  const std::size_t all = std::exchange(measured, 0);
  EXPECT_EQ(run(two), whole);
  EXPECT_EQ(measured, 0u) << "nothing is measured twice";
  kept.clear();
  most = all / 2;
  EXPECT_THROW(run(two), std::runtime_error);
  most = 1000;
  EXPECT_EQ(run(two), whole);
  EXPECT_EQ(measured, all);
  EXPECT_EQ(run({two[1]})["entries"], ordered_json::array({whole["entries"][1]}));
  ordered_json& any = kept.begin()->second;  // injected: wrong measurements
  any["pairs_removed"] = any["mean_db"] = 39.0;
  EXPECT_NE(run(two), whole);
}

TEST_F(CalibratorTest, NeedsViewsAndPhotos) {
  EXPECT_THROW(Calibrator(test::gl_context(), model, {}, near_default, CalibrationTarget::Kind::quality),
               Error);
  EXPECT_THROW(Calibrator(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::drop),
               Error);
}

// Cameras are in world coordinates: they see a model in other axes as in the world's.
TEST_F(CalibratorTest, AcceptsModelsOfAllAxes) {
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const auto pairs = [&](const Model& of) {
    Calibrator calibrator(test::gl_context(), of, views, near_default, CalibrationTarget::Kind::quality);
    EXPECT_EQ(calibrator.cost(of).mean_db, equal_db);
    EXPECT_LT(calibrator.cost(test::random_model(63, 500, 0)).mean_db, 40.0) << "any model is as good";
    return calibrator.cost(of).pairs;
  };
  EXPECT_GT(pairs(model), 100.0);
  EXPECT_NEAR(pairs(turned), pairs(model), 2.0);
}

}  // namespace
}  // namespace binosplat::lab
