// --quality: the tolerance that keeps frames at a requested error, in simulated scenes that are only a
// formula for the error.

#include "render/tolerance_control.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/support.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::ToleranceControl;

const FrameSettings squared_40 = {.th = TH_SQUARED, .quality = 40, .probe_tiles = 64};
constexpr int control_width = 640, control_height = 480, across = control_width / 16,
              down = control_height / 16;
constexpr int attempts_most = 8;

double db(double squared_error) { return -10 * std::log10(squared_error); }

// Views with a squared error of at_one * tolerance^power. The error differs between tiles by factors of
// exp(uneven * g), where g has a variance of about 1.
class SimulatedScene {
 public:
  SimulatedScene(double power, std::vector<double> at_one, double uneven = 0.0)
      : views(at_one.size(), make_view(test::front_camera(control_width, control_height, 700))),
        at_one_(std::move(at_one)),
        power_(power) {
    test::Uniform uniform(7);
    for (std::size_t n = 0; n < views.size(); ++n) {
      std::vector<double>& of_view = by_tile_.emplace_back();
      double sum = 0;
      for (int tile = 0; tile < across * down; ++tile) {
        // A gradient, because neighbours are similar, plus a random part of each tile.
        const int row = tile / across;
        const double g = 1.5 * (2.0 * row / down - 1.0) + uniform(-1, 1);
        sum += of_view.emplace_back(std::exp(uneven * g));
      }
      for (double& tile : of_view) tile *= across * down / sum;
    }
  }

  void scale(double factor) {
    for (double& error : at_one_) error *= factor;
  }
  // Returns the squared error of a view; probed() returns that of a probe's tiles.
  double error(std::size_t view, double tolerance) const {
    return at_one_.at(view) * std::pow(tolerance, power_);
  }
  render::ProbeResult probed(const render::Probe& probe, double tolerance) const {
    double sum = 0, squares = 0;
    int count = 0;
    for (std::size_t y = probe.row; y < down; y += probe.step) {
      for (std::size_t x = probe.column; x < across; x += probe.step, ++count) {
        const double tile = by_tile_.at(probe.view).at(y * across + x);
        sum += tile;
        squares += tile * tile;
      }
    }
    return {error(probe.view, tolerance) * sum / count, std::max(0.0, count * squares / (sum * sum) - 1.0)};
  }
  double worse_db(double tolerance) const {
    double most = 0;
    for (std::size_t view = 0; view < views.size(); ++view) most = std::max(most, error(view, tolerance));
    return most > 0.0 ? db(most) : std::numeric_limits<double>::infinity();
  }

  std::vector<shared::View> views;

 private:
  std::vector<double> at_one_;
  double power_;
  std::vector<std::vector<double>> by_tile_;  // relative to the view's mean
};

struct DrawnAttempts {
  double true_db = 0.0, reported_db = 0.0;
  float tolerance = 0.0f;
  int attempts = 0;
  render::Probe probe;  // of the last attempt
};

// Draws a frame as Frame::draw does. Planted fault: a control that never redraws.
DrawnAttempts draw_frame(ToleranceControl& control, const SimulatedScene& scene, bool redraws = true,
                         const FrameSettings& settings = squared_40) {
  DrawnAttempts drawn;
  do {
    drawn.probe = control.next_probe(scene.views, settings);
    drawn.tolerance = control.next_tolerance();
    control.measured(scene.probed(drawn.probe, drawn.tolerance), true);
    ++drawn.attempts;
  } while (redraws && !control.is_final());
  drawn.true_db = scene.worse_db(drawn.tolerance);
  drawn.reported_db = control.quality();
  return drawn;
}

// Returns whether a frame's dB is from `least` to `most`, and its report within `report_off` dB of it.
testing::AssertionResult keeps(const DrawnAttempts& drawn, double least, double most, double report_off) {
  const bool good = drawn.true_db >= least && drawn.true_db <= most &&
                    std::abs(drawn.reported_db - drawn.true_db) <= report_off &&
                    drawn.attempts <= attempts_most;
  return (good ? testing::AssertionSuccess() : testing::AssertionFailure())
         << drawn.true_db << " dB, reported " << drawn.reported_db << ", tolerance " << drawn.tolerance
         << ", drawn " << drawn.attempts << " times";
}

struct Course {
  double least = 1e9, most = 0.0, mean = 0.0, report_off = 0.0;
  int frames = 0, attempts = 0;
};

void add(const DrawnAttempts& drawn, Course& course) {
  course.least = std::min(course.least, drawn.true_db);
  course.most = std::max(course.most, drawn.true_db);
  course.mean = (course.mean * course.frames + drawn.true_db) / (course.frames + 1);
  course.report_off = std::max(course.report_off, std::abs(drawn.reported_db - drawn.true_db));
  course.attempts += drawn.attempts;
  ++course.frames;
}

// Draws frames, and multiplies the scene's error by `drift` after each.
Course follow(ToleranceControl& control, SimulatedScene& scene, int frames, double drift = 1.0,
              bool redraws = true) {
  Course course;
  for (int n = 0; n < frames; ++n) {
    add(draw_frame(control, scene, redraws), course);
    scene.scale(drift);
  }
  return course;
}

// Returns a scene that has 40 dB at `tolerance` in views of relative error 1. `views` are the relative
// errors.
SimulatedScene scene_for(double power, double tolerance, std::vector<double> views = {1.0}) {
  for (double& view : views) view *= 1e-4 / std::pow(tolerance, power);
  return {power, views, 0.5};
}

TEST(ToleranceControl, FindsTheToleranceForTheFirstFrameWhateverTheSceneIsLike) {
  for (const double power : {1.0, 1.3, 2.0, 6.0, 10.0}) {
    for (double tolerance = 1e-5; tolerance < 2e4; tolerance *= 10) {
      SimulatedScene scene = scene_for(power, tolerance);
      ToleranceControl control;
      EXPECT_TRUE(keeps(draw_frame(control, scene), 39.99, 41.31, 0.01)) << tolerance << " ^ " << power;
      const Course course = follow(control, scene, 60);
      EXPECT_GT(course.least, 40.0) << tolerance << " ^ " << power;
      EXPECT_LT(course.most, 40.6) << tolerance << " ^ " << power;
      EXPECT_LT(course.report_off, 0.25) << tolerance << " ^ " << power;
      EXPECT_EQ(course.attempts, 60) << tolerance << " ^ " << power;
      // Planted fault: a fixed first tolerance, whatever its error is.
      if (std::abs(std::log10(tolerance / 0.1)) < 0.5) continue;  // it is right for these scenes
      ToleranceControl careless;
      EXPECT_FALSE(keeps(draw_frame(careless, scene, false), 39.99, 41.31, 0.01))
          << tolerance << " ^ " << power;
    }
  }
}

TEST(ToleranceControl, FollowsASceneThatChanges) {
  for (const double power : {1.3, 2.0, 6.0, 10.0}) {
    for (const double drift : {1.01, 1 / 1.01}) {  // 40 dB in a thousand frames
      SimulatedScene scene = scene_for(power, 0.05, {1.0, 0.8});
      ToleranceControl control;
      const Course course = follow(control, scene, 300, drift);
      EXPECT_GT(course.least, 39.25) << drift << " ^ " << power;  // below that a frame is drawn again
      EXPECT_LT(course.most, 41.3) << drift << " ^ " << power;
      EXPECT_NEAR(course.mean, 40.3, 0.5) << drift << " ^ " << power;
      EXPECT_LT(course.report_off, 0.6) << drift << " ^ " << power;
      EXPECT_LT(course.attempts, 320) << drift << " ^ " << power;
      // Planted fault: the first frame's tolerance, kept for all frames, ends at another quality.
      EXPECT_GT(std::abs(scene.worse_db(0.05) - 40.0), 5.0);
    }
  }
}

TEST(ToleranceControl, AJumpIsDrawnAgain) {
  for (const double power : {1.3, 2.0, 6.0, 10.0}) {
    SimulatedScene scene = scene_for(power, 0.05, {1.0, 0.9});
    for (const bool redraws : {true, false}) {
      ToleranceControl control;
      follow(control, scene, 30);
      scene.scale(10);
      const DrawnAttempts after = draw_frame(control, scene, redraws);
      scene.scale(0.1);
      if (redraws) {
        EXPECT_TRUE(keeps(after, 39.9, 41.4, 0.1)) << power;
        EXPECT_GT(after.attempts, 1);
      } else {  // planted fault: a control that accepts every frame
        EXPECT_FALSE(keeps(after, 39.0, 50.0, 10.0)) << power;
      }
    }
  }
}

TEST(ToleranceControl, AJumpToLessErrorIsNoReasonToDrawAgain) {
  SimulatedScene scene = scene_for(2, 0.05, {1.0, 0.9});
  ToleranceControl control;
  follow(control, scene, 30);
  scene.scale(0.1);
  draw_frame(control, scene);  // a better sample may be chance: the next sample is larger
  EXPECT_TRUE(keeps(draw_frame(control, scene), 49.0, 50.5, 0.5));
  const Course course = follow(control, scene, 40);
  EXPECT_EQ(course.attempts, 40);
  EXPECT_GT(course.least, 39.9);
  EXPECT_NEAR(draw_frame(control, scene).true_db, 40.3, 0.2);
}

TEST(ToleranceControl, TheWorseViewDecides) {
  for (const double ratio : {1.5, 2.0, 3.0, 10.0, 100.0}) {
    for (const std::vector<double>& views : {std::vector{1.0, ratio}, {ratio, 1.0}}) {
      SimulatedScene scene = scene_for(1.5, 0.05, views);
      ToleranceControl control;
      EXPECT_TRUE(keeps(draw_frame(control, scene), 39.99, 41.31, 0.01)) << views[0] << " " << views[1];
      SimulatedScene blind_scene = scene_for(1.5, 0.05, {views[0]});
      ToleranceControl blind;  // planted fault: a probe of the first view only
      const float blind_tolerance = draw_frame(blind, blind_scene).tolerance;
      EXPECT_TRUE(views[1] < views[0] || scene.worse_db(blind_tolerance) < 39.6) << ratio;
      control.forget();  // the other view comes first
      EXPECT_TRUE(keeps(draw_frame(control, scene), 39.99, 41.31, 0.01)) << views[0] << " " << views[1];
      const Course course = follow(control, scene, 60);
      EXPECT_GT(course.least, 39.9) << views[0] << " " << views[1];
      EXPECT_LT(course.most, 40.8) << views[0] << " " << views[1];
      EXPECT_LT(course.report_off, 0.25) << views[0] << " " << views[1];
      EXPECT_EQ(course.attempts, 60) << views[0] << " " << views[1];
    }
  }
}

TEST(ToleranceControl, ACutSearchesAnewFromTheLastTolerance) {
  SimulatedScene scene = scene_for(1.3, 3.0);
  ToleranceControl control;
  const Course first = follow(control, scene, 1);
  EXPECT_GT(first.attempts, 1);
  const float before = draw_frame(control, scene).tolerance;
  control.forget();
  const DrawnAttempts same = draw_frame(control, scene);
  EXPECT_FLOAT_EQ(same.tolerance, before);
  EXPECT_EQ(same.attempts, 1);
  EXPECT_EQ(same.probe.step, 1u);
  SimulatedScene other = scene_for(2, 0.02);
  control.forget();
  const DrawnAttempts found = draw_frame(control, other);
  EXPECT_TRUE(keeps(found, 39.99, 41.31, 0.01));
  EXPECT_GT(found.attempts, 1);
  // Another quality also starts a search, with another tolerance.
  FrameSettings better = squared_40;
  better.quality = 50;
  EXPECT_TRUE(keeps(draw_frame(control, other, true, better), 49.99, 51.31, 0.01));
}

// For example, levels of detail use a part of the allowed error, and the rest changes.
TEST(ToleranceControl, AQualityThatChangesALittleIsFollowed) {
  for (const double power : {1.3, 2.0, 6.0}) {
    const SimulatedScene scene = scene_for(power, 0.05, {1.0, 0.9});
    ToleranceControl control;
    FrameSettings settings = squared_40;
    Course course;  // dB above the request
    float first = 0.0f;
    const auto draw = [&] {
      DrawnAttempts drawn = draw_frame(control, scene, true, settings);
      if (first == 0.0f) first = drawn.tolerance;
      drawn.true_db -= settings.quality;
      drawn.reported_db -= settings.quality;
      add(drawn, course);
    };
    for (int n = 0; n < 90; ++n) {
      settings.quality = 41.5f - 1.5f * std::cos(0.07f * static_cast<float>(n));
      draw();
    }
    EXPECT_GT(course.least, -0.75) << power;
    EXPECT_LT(course.most, 1.4) << power;
    EXPECT_NEAR(course.mean, 0.3, 0.3) << power;
    EXPECT_LT(course.report_off, 0.4) << power;
    EXPECT_LT(course.attempts, 95) << power;
    settings.quality += 0.2f;
    EXPECT_TRUE(control.is_settled(scene.views, settings));
    settings.quality += 0.2f;
    EXPECT_FALSE(control.is_settled(scene.views, settings)) << "of a frame that must be better";
    settings.quality = 43.0f;  // a jump
    course = {};
    draw();
    EXPECT_GT(course.least, -0.75) << power;
    EXPECT_LT(scene.worse_db(first), 42.25) << "planted: the first tolerance for all";
  }
}

TEST(ToleranceControl, ProbesEveryTileOfEveryViewInTurn) {
  for (const int probe_tiles : {10, 64, 300}) {
    FrameSettings settings = squared_40;
    settings.probe_tiles = probe_tiles;
    const SimulatedScene scene(1.5, {1.0, 1.0});
    ToleranceControl control;
    EXPECT_EQ(draw_frame(control, scene, true, settings).probe.step, 1u);
    const render::Probe second = draw_frame(control, scene, true, settings).probe;
    const auto step = second.step;
    EXPECT_EQ(step, probe_tiles == 10 ? 8u : probe_tiles == 64 ? 4u : 2u);  // at least one tile of 64
    std::vector<int> seen(2 * across * down);
    for (std::uint32_t n = 0; n < 2 * step * step; ++n) {
      const render::Probe probe = draw_frame(control, scene, true, settings).probe;
      ASSERT_EQ(probe.step, step);
      for (auto y = probe.row; y < down; y += step)
        for (auto x = probe.column; x < across; x += step) ++seen.at((probe.view * down + y) * across + x);
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 2 * across * down);
    control.forget();
    EXPECT_EQ(control.next_probe(scene.views, settings).step, 1u);
  }
}

TEST(ToleranceControl, ASmallPictureIsProbedAsAWhole) {
  const std::vector views = {make_view(test::front_camera(100, 83, 100))};  // 7 x 6 tiles
  ToleranceControl control;
  for (int n = 0; n < 10; ++n) {
    const render::Probe probe = control.next_probe(views, squared_40);
    EXPECT_EQ(probe.step, 1u);
    EXPECT_EQ(probe.column + probe.row, 0u);
    control.next_tolerance();
    control.measured({1e-4}, true);
  }
}

TEST(ToleranceControl, UnevenScenesGetLargerProbes) {
  const auto step_after = [](double uneven) {
    const SimulatedScene scene(1.5, {1e-2}, uneven);
    ToleranceControl control;
    DrawnAttempts last;
    for (int n = 0; n < 40; ++n) last = draw_frame(control, scene);
    EXPECT_TRUE(keeps(last, 39.5, 41.5, 0.8)) << uneven;
    return last.probe.step;
  };
  EXPECT_EQ(step_after(0.0), 4u);
  EXPECT_LT(step_after(2.0), 4u);
}

TEST(ToleranceControl, ASampleThatShowsNothingIsNotTheView) {
  // The sample sees only an empty sky.
  const SimulatedScene scene(1.5, {1e-2});
  ToleranceControl control;
  const DrawnAttempts first = draw_frame(control, scene);
  EXPECT_EQ(first.probe.step, 1u);
  control.next_probe(scene.views, squared_40);
  control.next_tolerance();
  control.measured({}, true);
  EXPECT_TRUE(control.is_final());
  EXPECT_NEAR(control.quality(), 40.3, 0.6);
  EXPECT_LT(draw_frame(control, scene).probe.step, 4u);  // a larger sample
  // Planted fault: the same result for the whole view counts as the truth.
  control.forget();
  control.next_probe(scene.views, squared_40);
  control.next_tolerance();
  control.measured({}, true);
  EXPECT_EQ(control.quality(), std::numeric_limits<double>::infinity());
}

// Returns the attempts for a frame whose error is the same at every tolerance above 0.
int attempts_at(ToleranceControl& control, const std::vector<shared::View>& views, double error,
                bool settled = true) {
  int attempts = 0;
  do {
    control.next_probe(views, squared_40);
    const float tolerance = control.next_tolerance();
    control.measured({tolerance > 0.0f ? error : 0.0}, settled);
  } while (++attempts < 100 && !control.is_final());
  return attempts;
}

TEST(ToleranceControl, WhereNothingHoldsTheFrameIsExactAndTheNextRecovers) {
  SimulatedScene scene = scene_for(1.3, 0.05);
  for (const bool settled : {true, false}) {  // false: measurements never settle
    ToleranceControl control;
    EXPECT_EQ(attempts_at(control, scene.views, settled ? 1.0 : 1e-4, settled), attempts_most);
    EXPECT_EQ(control.quality(), std::numeric_limits<double>::infinity());
    if (!settled) continue;
    DrawnAttempts drawn;
    for (int n = 0; n < 60; ++n) {
      drawn = draw_frame(control, scene);
      EXPECT_GT(drawn.true_db, 39.2) << n;
    }
  }
}

TEST(ToleranceControl, WhereNoToleranceErrsItRisesAndEnds) {
  const SimulatedScene scene(1.5, {1.0});
  ToleranceControl control;
  EXPECT_LE(attempts_at(control, scene.views, 0.0), attempts_most);
  for (int n = 0; n < 1000; ++n) EXPECT_EQ(attempts_at(control, scene.views, 0.0), 1);
  EXPECT_EQ(control.quality(), std::numeric_limits<double>::infinity());
  control.next_probe(scene.views, squared_40);
  EXPECT_LE(control.next_tolerance(), 1e9f);
}

}  // namespace
}  // namespace binosplat
