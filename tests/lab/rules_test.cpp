// Every rule at one error, and timed, where the camera stands still.

#include "lab/rules.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

constexpr double target = 40.0;

struct Rules : testing::Test {
  const Model model = test::random_model(71, 2500, 0);
  const std::array<shared::View, 2> eyes =
      stereo::make_rig(test::front_camera(64, 48, 60), {.ipd = 0.05}).views;
  FixedCamera camera{test::gl_context(), model, {eyes.begin(), eyes.end()}};

  /// The dB of a rule's frames 9 to 20, drawn anew and judged with a read-back.
  double fresh_db(const Variant& rule) {
    render::Frame frame(test::gl_context(), model);
    render::FrameSettings settings = rule.settings();
    settings.depth_table = camera.depth_table();
    settings.record_every = 1;
    double sum = 0.0;
    for (int n = 0; n < 20; ++n) {
      frame.draw(eyes, settings);
      if (n < 8) continue;
      const double db = judge(eyes, camera.exact(), frame.read_pictures(), settings.tile_size).psnr;
      sum += std::pow(10.0, -0.1 * db) / 12.0;
    }
    return -10.0 * std::log10(sum);
  }
};

TEST_F(Rules, ComeToTheTargetAndAreTimed) {
  std::vector<Variant> rules = all_variants();
  find_tolerances(camera, rules, target, [] {});
  constexpr int frames = 96;  // in which what ages and is measured again goes round once
  int done = 0;
  const auto results = measure_rules(camera, rules, target, frames, [&] { ++done; });
  EXPECT_EQ(done, rule_rounds * static_cast<int>(rules.size()));
  ASSERT_EQ(results.size(), rules.size());
  const RuleResult& tau = results.front();
  EXPECT_EQ(tau.variant.th, TH_TAU);
  EXPECT_TRUE(std::isinf(tau.db));
  EXPECT_TRUE(std::isinf(tau.disagreement_db));
  EXPECT_EQ(tau.removed, 0.0);
  EXPECT_EQ(tau.of_exact, 1.0);
  EXPECT_EQ(tau.of_one, 1.0);
  EXPECT_EQ(tau.problem, "");
  for (std::size_t k = 1; k < results.size(); ++k) {
    const RuleResult& r = results[k];
    SCOPED_TRACE(r.variant.name());
    EXPECT_EQ(r.problem, "");
    EXPECT_NEAR(r.db, target, 0.3);
    EXPECT_NEAR(r.db, fresh_db(r.variant), 0.01);
    EXPECT_LE(r.worst_db, r.db);
    EXPECT_NEAR(r.timed_pairs, r.pairs, 0.05 * r.pairs);  // a first frame would make far more
    EXPECT_TRUE(std::isfinite(r.disagreement_db));
    EXPECT_GT(r.removed, 0.01);
    EXPECT_LE(r.lower_ms, r.upper_ms);
    double sum = 0.0;
    for (const gl::StageTime& stage : r.stages) sum += stage.ms;
    EXPECT_NEAR(sum, r.frame_ms, 0.5 * r.frame_ms);
    EXPECT_NEAR(r.of_exact, r.frame_ms / tau.frame_ms, 1e-12);
  }
  EXPECT_EQ(results[1].of_one, 1.0);  // peripheral, one
  EXPECT_EQ(results[2].of_one, results[2].frame_ms / results[1].frame_ms);
}

TEST_F(Rules, AWrongToleranceIsCaught) {
  std::vector<Variant> rules = {{.th = TH_TAU}, {.transmittance = TRANSMITTANCE_LAST}};
  find_tolerances(camera, rules, target, [] {});
  EXPECT_EQ(measure_rules(camera, rules, target, 1, [] {})[1].problem, "");
  rules[1].tolerance *= 1.5f;
  EXPECT_NE(measure_rules(camera, rules, target, 1, [] {})[1].problem.find("not within 0.3 dB of 40 dB"),
            std::string::npos);
}

TEST_F(Rules, ATargetThatNothingReachesIsReported) {
  for (const double beyond : {1.0, 300.0}) {
    std::vector<Variant> rules = {{.th = TH_TAU}, {.th = TH_PERIPHERAL}, {}};
    find_tolerances(camera, rules, beyond, [] {});
    const auto results = measure_rules(camera, rules, beyond, 1, [] {});
    EXPECT_EQ(results[0].problem, "");
    for (std::size_t k = 1; k < 3; ++k)
      EXPECT_NE(results[k].problem.find("not within"), std::string::npos) << beyond << results[k].db;
  }
}

TEST_F(Rules, OneEyeHasNoDisagreement) {
  FixedCamera one(test::gl_context(), model, {eyes[0]});
  const auto results = measure_rules(one, {{.th = TH_TAU}}, target, 1, [] {});
  EXPECT_TRUE(std::isnan(results[0].disagreement_db));
  EXPECT_TRUE(std::isinf(results[0].db));
}

}  // namespace
}  // namespace binosplat::lab
