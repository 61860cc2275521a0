#include "lab/calibration.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>

#include "base/error.h"
#include "lab/calibrate.h"
#include "lab/settings.h"
#include "measure/metrics.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using nlohmann::ordered_json;

Calibration sample_calibration() {
  Calibration c;
  c.model_name = "fox.ply";
  c.gaussians = 109832;
  c.hash = 0x00ff39ddbc3922b3ull;
  c.perspective = {ORDER_DISTANCE, PROJECTION_TANGENT};
  c.width = 518;
  c.height = 944;
  c.focal = 100.0;
  c.near_plane = 0.2;
  c.target = {CalibrationTarget::Kind::drop, 0.5};
  c.depth_table = {8.5f, {1.0f, 0.25f, 0.0f}};
  c.views = {{"a", {0, 0, 0}}, {"b", {1, 0, 0}}, {"c", {1, 3, 0}}};
  c.entries = {{TH_PERIPHERAL, TRANSMITTANCE_ONE, 2.0, 0.499, 0.75, "b", 0.25, 12, 0.5},
               {TH_SQUARED, TRANSMITTANCE_LAST, 0.01, 0.498, 0.6, "c", 0.5, 11, 0.25}};
  return c;
}

TEST(Calibration, ComesBackAsItWas) {
  const std::string text = to_json(sample_calibration()).dump();
  const Calibration read = parse_calibration("c.json", text);
  EXPECT_EQ(to_json(read).dump(), text);
  EXPECT_EQ(read.hash, sample_calibration().hash);
  EXPECT_EQ(read.perspective, sample_calibration().perspective);
  EXPECT_EQ(read.target.kind, CalibrationTarget::Kind::drop);
  EXPECT_EQ(read.entries[1].transmittance, TRANSMITTANCE_LAST);
  EXPECT_EQ(read.depth_table.bounds, sample_calibration().depth_table.bounds);
  Calibration other = sample_calibration();
  other.target.kind = CalibrationTarget::Kind::quality;
  EXPECT_EQ(parse_calibration("c", to_json(other).dump()).target.kind, CalibrationTarget::Kind::quality);
}

TEST(Calibration, ErrorsNameTheKey) {
  const struct {
    const char* path;
    ordered_json value;
    const char* said;
  } cases[] = {
      {"/format", "other", "not a calibration of this version"},
      {"/version", 2, "not a calibration of this version"},
      {"/model/hash", "12", "key 'model.hash': 12: expected 16 hexadecimal digits"},
      {"/model", 5, "key 'model': expected an object"},
      {"/focal_px", 0, "key 'focal_px': 0: expected a number of"},
      {"/depth_table/upper", {0.5, 1.5}, "key 'depth_table.upper[1]': 1.5: expected a number from 0 to 1"},
      {"/depth_table/upper", ordered_json::array(), "expected 1 to"},
      {"/depth_table/far", "x", "key 'depth_table.far': expected a finite number"},
      {"/target", ordered_json::object(), "psnr_db"},
      {"/views/1/position", {1, 2}, "key 'views[1].position': expected 3 values"},
      {"/entries/0/th", "none", "'th': 'none' is not one of tau"},
      {"/entries/1/tolerance", -1, "key 'entries[1].tolerance': -1: expected a number of 0 or more"},
      {"/entries/1/tolerance", 1e300, "is too large"},
      {"/entries/0/transmittance", "both", "'transmittance': 'both' is not one of"},
      {"/entries", "many", "key 'entries': expected a list"},
  };
  for (const auto& c : cases) {
    ordered_json json = to_json(sample_calibration());
    json[ordered_json::json_pointer(c.path)] = c.value;
    try {
      parse_calibration("c.json", json.dump());
      ADD_FAILURE() << "accepted " << c.path << " " << c.value;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 6), "c.json");
      EXPECT_NE(std::string(error.what()).find(c.said), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(parse_calibration("c", "{\"format\""), Error);
  EXPECT_THROW(parse_calibration("c", "[]"), Error);
  // So deep that writing it into the error would leave the stack.
  const std::string deep = std::string(300000, '[') + std::string(300000, ']');
  EXPECT_THROW(parse_calibration("c", "{\"format\": " + deep + "}"), Error);
  ordered_json json = to_json(sample_calibration());
  json["entries"][0].erase("worst_view");
  EXPECT_THROW(parse_calibration("c", json.dump()), Error);
}

TEST(Calibration, GivesTheToleranceOfItsEntry) {
  render::FrameSettings settings;
  settings.th = TH_PERIPHERAL;
  auto found = calibrated(sample_calibration(), settings, 100.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tolerance, 2.0f);
  EXPECT_EQ(found->depth_table.bounds, sample_calibration().depth_table.bounds);
  EXPECT_FLOAT_EQ(calibrated(sample_calibration(), settings, 200.0)->tolerance, 2.0f * std::pow(2.0f, 1.25f));
  settings.transmittance = TRANSMITTANCE_DEPTH;
  EXPECT_FALSE(calibrated(sample_calibration(), settings, 100.0)) << "no entry of this source";
  settings = {.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST};
  found = calibrated(sample_calibration(), settings, 100.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tolerance, 0.01f);
  EXPECT_EQ(found->transmittance, TRANSMITTANCE_LAST);
}

TEST(Calibration, KnowsItsModelAndItsViews) {
  const Model model = test::random_model(3, 100, 1);
  Calibration c = sample_calibration();
  c.gaussians = model.count();
  c.hash = model_hash(model);
  EXPECT_TRUE(is_of(c, model));
  // The smallest change of any kind of value is another model.
  for (const int what : {0, 1, 2, 3, 4}) {
    Model other = model;
    float& value = what == 0   ? other.position[99].z
                   : what == 1 ? other.scale[0].x
                   : what == 2 ? other.rotation[50].w
                   : what == 3 ? other.opacity[7]
                               : other.sh.back();
    value = std::nextafter(value, 10.0f);
    EXPECT_FALSE(is_of(c, other)) << what;
  }
  // c is 3 from its nearest neighbour, the largest such distance: up to 6 from any view is covered.
  EXPECT_TRUE(covers(c, {1, 8.9, 0}));
  EXPECT_FALSE(covers(c, {1, 9.1, 0}));
  c.views.resize(1);
  EXPECT_TRUE(covers(c, {100, 0, 0}));
}

struct Calibrating : testing::Test {
  Model model = test::random_model(11, 800, 1);
  std::vector<CalibrationView> views;

  Calibrating() {
    for (const double x : {0.0, 0.3}) {
      Camera camera = test::front_camera(60, 40, 60.0);
      camera.name = x == 0.0 ? "left" : "right";
      camera.position.x = x;
      views.push_back({camera, {}});
    }
  }
};

/// The same numbers from pictures that are read back and compared on the CPU.
TEST_F(Calibrating, CostsAreThoseOfThePictures) {
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
  settings.th = TH_SQUARED;
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

TEST_F(Calibrating, ReachesItsTarget) {
  Calibrator calibrator(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::quality);
  const CalibrationEntry entry = calibrator.find({.th = TH_SQUARED, .tolerance = 0.1f}, 42.0);
  EXPECT_GE(entry.reached_db, 42.0);
  EXPECT_LT(entry.reached_db, 42.5);
  EXPECT_LE(entry.worst_db, entry.reached_db);
  // A larger tolerance does not hold, and nothing that other views measured is left in what one costs.
  render::FrameSettings settings{.th = TH_SQUARED, .tolerance = static_cast<float>(1.1 * entry.tolerance)};
  EXPECT_LT(calibrator.cost(settings).mean_db, 42.0);
  settings.transmittance = TRANSMITTANCE_LAST;
  const double once = calibrator.cost(settings).mean_db;
  EXPECT_EQ(calibrator.cost(settings).mean_db, once);
}

TEST_F(Calibrating, TheWholeFile) {
  std::size_t done = 0;
  const Calibration c = calibrate(test::gl_context(), model, views, near_default,
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
  EXPECT_EQ(to_json(parse_calibration("c", to_json(c).dump())), to_json(c));
}

TEST_F(Calibrating, GoesOnFromWhatWasMeasured) {
  std::map<std::string, ordered_json> kept;
  std::size_t measured = 0, most = 1000;
  const auto run = [&](const std::vector<Rule>& rules) {
    const Keep keep = [&](const std::string& step, const std::function<ordered_json()>& measure) {
      if (kept.contains(step)) return kept[step];
      if (measured == most) throw std::runtime_error("ended");
      ++measured;
      return kept[step] = ordered_json::parse(measure().dump());
    };
    ordered_json json =
        to_json(calibrate(test::gl_context(), model, views, near_default,
                          {{CalibrationTarget::Kind::quality, 40.0}, {.bins = 5}, rules, keep}));
    json["depth_table"].erase("seconds");
    for (ordered_json& entry : json["entries"]) entry.erase("seconds");
    return json;
  };
  const std::vector<Rule> two = {{TH_SQUARED, TRANSMITTANCE_ONE}, {TH_PERIPHERAL, TRANSMITTANCE_ONE}};
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
  ordered_json& any = kept.begin()->second;  // planted: it is not what was measured
  any["pairs_removed"] = any["mean_db"] = 39.0;
  EXPECT_NE(run(two), whole);
}

TEST_F(Calibrating, NeedsViewsAndPhotos) {
  EXPECT_THROW(Calibrator(test::gl_context(), model, {}, near_default, CalibrationTarget::Kind::quality),
               Error);
  EXPECT_THROW(Calibrator(test::gl_context(), model, views, near_default, CalibrationTarget::Kind::drop),
               Error);
}

}  // namespace
}  // namespace binosplat::lab
