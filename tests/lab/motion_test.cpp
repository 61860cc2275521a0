// Rules along a moving head: what is reported of them is what a second look at the same pictures finds.

#include "lab/motion.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lab/exact_frames.h"
#include "lab/settings.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using Views = std::vector<shared::View>;

/// A pair at x, or one eye.
Views head_at(double x, bool pair = true) {
  Camera camera = test::front_camera(50, 37, 48);
  camera.position.x = x;
  if (!pair) return {make_view(camera)};
  const auto eyes = stereo::make_rig(camera, {.ipd = 0.05}).views;
  return {eyes.begin(), eyes.end()};
}

/// A path of two segments.
MotionPath small_path() {
  const SegmentLengths lengths{.lead = 2, .moving = 4, .stop = 2};
  MotionPath path{"sideways", "0.05 units a frame", {}};
  for (const double from : {0.0, -0.4}) {
    std::vector<Views> frames;
    for (int n = 0; n < 6; ++n) frames.push_back(head_at(from + 0.05 * n));
    path.segments.push_back(segment_of(std::move(frames), lengths));
  }
  return path;
}

/// In the same view as 8-bit pictures, each read back and rounded on the CPU.
std::vector<double> looked_at(const std::vector<Picture>& exact, const std::vector<Picture>& drawn) {
  const auto shown = [](const Picture& picture) { return quantised(composite(picture, glm::vec3(0.0f))); };
  std::vector<double> db;
  for (std::size_t v = 0; v < exact.size(); ++v)
    db.push_back(measure::psnr(shown(exact[v]), shown(drawn[v])));
  return db;
}

struct Motions : testing::Test {
  const Model model = test::random_model(71, 800, 0);
  const Rule one{}, last{.transmittance = TRANSMITTANCE_LAST};

  MotionResult measured(const MotionPath& path, const std::vector<Rule>& rules,
                        const MotionSettings& settings) const {
    return measure_motion(test::gl_context(), model, {path}, rules, settings,
                          [](const std::string&, std::size_t, std::size_t) {})
        .front();
  }
};

TEST_F(Motions, EachViewHasItsOwnErrorAndNoGroupIsOfTwo) {
  render::Frame frame(test::gl_context(), model);
  BytePictures bytes(test::gl_context());
  gl::Buffer kept(test::gl_context(), "kept");
  const Views views = {make_view(test::front_camera(50, 37, 48)), make_view(test::front_camera(33, 21, 30)),
                       make_view(test::front_camera(16, 16, 12))};
  ASSERT_NE(views[0].width * views[0].height % THREADS, 0u);
  frame.draw(views);
  const auto exact = frame.read_pictures();
  bytes.keep(frame, views, kept);
  EXPECT_EQ(bytes.errors(frame, views, kept), std::vector<double>(3, 0.0));
  // A probe's pixels come after the views' and count for none.
  for (const render::FrameSettings& way : {render::FrameSettings{.th = TH_SQUARED, .tolerance = 2.0f},
                                           render::FrameSettings{.th = TH_SQUARED, .quality = 35.0f}}) {
    frame.draw(views, way);
    const auto errors = bytes.errors(frame, views, kept);
    const auto db = looked_at(exact, frame.read_pictures());
    for (std::size_t v = 0; v < 3; ++v) {
      EXPECT_GT(errors[v], 0.0);
      EXPECT_NEAR(-10.0 * std::log10(errors[v]), db[v], 1e-4) << v;
    }
  }
}

TEST_F(Motions, SeriesAreWhatASecondLookFinds) {
  const MotionPath path = small_path();
  const MotionResult result = measured(path, {{.th = TH_TAU}, last}, {.quality = 38.0f, .equal = false});
  ASSERT_EQ(result.rules.size(), 1u) << "tau is no rule to compare";
  const MovedPass& pass = result.rules[0].asked;
  render::FrameSettings settings = last.settings();
  settings.quality = 38.0f;
  double neighbours_off = 0.0;
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    render::Frame frame(test::gl_context(), model), still(test::gl_context(), model);
    std::vector<Picture> before;
    for (std::size_t n = 0; n < path.segments[s].frames.size(); ++n) {
      SCOPED_TRACE(fmt::format("segment {}, frame {}", s, n));
      const Views& views = path.segments[s].frames[n];
      const auto exact_pairs = static_cast<double>(still.draw(views).pairs);
      const auto exact = still.read_pictures();
      const render::FrameReport report = frame.draw(views, settings);
      const auto drawn = frame.read_pictures();
      const auto db = looked_at(exact, drawn);
      const MovedFrame& made = pass.frames[s][n];
      for (std::size_t v = 0; v < 2; ++v) EXPECT_NEAR(made.view_db[v], db[v], 1e-4);
      EXPECT_EQ(made.true_db(), std::min({made.view_db[0], made.view_db[1], equal_db}));
      EXPECT_EQ(made.reported_db, report.quality);
      EXPECT_EQ(made.pairs, static_cast<double>(report.pairs));
      EXPECT_EQ(made.exact_pairs, exact_pairs);
      EXPECT_EQ(made.tolerance, report.tolerance);
      EXPECT_GT(made.ms, 0.0);
      // The fault that this must see: the frame before is what it is compared with.
      const bool moves = n > 0 && n < path.segments[s].frames.size() - path.segments[s].stop;
      if (moves) neighbours_off = std::max(neighbours_off, made.view_db[0] - looked_at(before, drawn)[0]);
      before = exact;
    }
  }
  EXPECT_GT(neighbours_off, 3.0) << "a neighbour's exact picture would go unnoticed";
  EXPECT_EQ(pass.lead.frames, 4u);
  EXPECT_EQ(pass.moving.frames, 8u);
  EXPECT_EQ(pass.stop.frames, 4u);
  EXPECT_EQ(result.exact.moving.removed, 0.0);
  EXPECT_EQ(result.exact.moving.equal, 8u);
  EXPECT_GT(result.exact.moving.ms, 0.0);
}

TEST_F(Motions, WhatHasNoRoomIsDrawnAgain) {
  const MotionPath path = small_path();
  render::Frame frame(test::gl_context(), model);
  const std::int64_t one_frame = BytePictures::bytes(path.segments[0].frames[0]);
  EXPECT_EQ(one_frame, 4 * 2 * 50 * 37);
  ExactFrames all(frame.model(), 100 * one_frame), some(frame.model(), 3 * one_frame);
  all.draw(frame, path);
  some.draw(frame, path);
  EXPECT_EQ(all.left_out(), 0u);
  EXPECT_EQ(some.left_out(), 12u - 3) << "a stop is of one pose";
  for (std::size_t n = 0; n < 8; ++n) {
    frame.draw(path.segments[1].frames[n], {.th = TH_SQUARED, .tolerance = 1.0f});
    EXPECT_EQ(all.psnr(frame, 1, n), some.psnr(frame, 1, n)) << n;
    EXPECT_EQ(all.pairs(1, n), some.pairs(1, n));
  }
  // Another path: nothing of the first one is left.
  MotionPath other{"still", "", {still_segment(head_at(0.7), {.lead = 1, .moving = 2, .stop = 5})}};
  some.draw(frame, other);
  EXPECT_EQ(some.left_out(), 0u);
  frame.draw(other.segments[0].frames[2]);
  EXPECT_EQ(some.psnr(frame, 0, 2), (std::vector<double>{INFINITY, INFINITY}));
}

TEST_F(Motions, RulesComeToOneTrueQuality) {
  const MotionPath path = small_path();
  const MotionSettings settings{.quality = 44.0f, .target = 33.0, .rounds = 1};
  const MotionResult result = measured(path, {one, last}, settings);
  ASSERT_EQ(result.rules.size(), 2u);
  for (const MovedRule& rule : result.rules) {
    SCOPED_TRACE(rule.name());
    EXPECT_EQ(rule.problem, "");
    ASSERT_TRUE(rule.equal);
    EXPECT_NEAR(rule.equal->moving.true_db, 33.0, settings.equal_within);
    EXPECT_GT(std::abs(rule.asked.moving.true_db - 33.0), settings.equal_within);
    EXPECT_LT(rule.equal->request, 44.0f);
    EXPECT_EQ(rule.equal->moving.frames, 8u);
    EXPECT_EQ(rule.equal->stop.frames, 0u);
    EXPECT_GT(rule.equal->moving.ms, 0.0);
    EXPECT_LT(rule.equal->moving.pairs, rule.asked.moving.pairs);
  }
  const nlohmann::ordered_json json = to_json(MotionStudy{.paths = {result}})["paths"][0];
  const auto& first = json["rules"][0]["at_target"];
  const auto& second = json["rules"][1]["at_target"];
  EXPECT_EQ(first["ms_of_one"], 1.0);
  EXPECT_EQ(second["pairs_of_one"],
            result.rules[1].equal->moving.pairs / result.rules[0].equal->moving.pairs);
  EXPECT_EQ(second["ms_of_exact"], result.rules[1].equal->moving.ms / result.exact.moving.ms);
  EXPECT_EQ(second["segments"][0]["true_db"].size(), 6u);
  EXPECT_EQ(json["rules"][1]["asked"]["segments"][1]["view_db"][7].size(), 2u);
  EXPECT_FALSE(json["rules"][1]["settings"].contains("tolerance"));
}

TEST_F(Motions, ATargetThatNothingReachesSaysSo) {
  MotionPath path{"still", "", {still_segment(head_at(0.0, false), {.lead = 1, .moving = 1, .stop = 0})}};
  Rule by_depth{.transmittance = TRANSMITTANCE_DEPTH};
  const MotionResult result = measured(path, {by_depth}, {.target = 3.0, .rounds = 1});
  EXPECT_NE(result.rules[0].problem.find("not within 0.1 dB of 3 dB"), std::string::npos);
  EXPECT_FALSE(shares(result, result.rules[0], false).ms_of_one) << "there is no `one` among the rules";
  const auto json = nlohmann::ordered_json::parse(to_json(MotionStudy{.paths = {result}}).dump());
  EXPECT_TRUE(json["paths"][0]["rules"][0]["asked"]["ms_of_one"].is_null());
}

}  // namespace
}  // namespace binosplat::lab
