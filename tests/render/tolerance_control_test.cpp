// --quality: the tolerance that keeps frames at a requested error, in simulated scenes that are only a
// formula for the error.

#include "render/tolerance_control.h"

#include <algorithm>
#include <cmath>

#include "render/support.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::ToleranceControl;

const FrameSettings squared_40 = [] {
  FrameSettings settings{{.quality = 40, .threshold = Threshold::squared}};
  settings.probe_tiles = 64;
  return settings;
}();
constexpr int across = 40, down = 30;  // tiles of a view

double db(double squared_error) { return -10 * std::log10(squared_error); }

// Views with a squared error of at_one * tolerance^power. The error differs between tiles by factors of
// exp(uneven * g), where g has a variance of about 1.
struct SimulatedScene {
  SimulatedScene(double power_of_error, double tolerance_of_40_db, std::vector<double> of_views = {1.0, 0.9},
                 double uneven = 0.5)
      : views(of_views.size(), make_view(test::front_camera(16 * across, 16 * down, 700))),
        power(power_of_error) {
    for (const double error : of_views) at_one.push_back(error * 1e-4 / std::pow(tolerance_of_40_db, power));
    test::Uniform uniform(7);
    double sum = 0;
    for (int tile = 0; tile < across * down; ++tile) {
      const int row = tile / across;
      sum += by_tile.emplace_back(std::exp(uneven * (3.0 * row / down + uniform(-1, 1))));
    }
    for (double& tile : by_tile) tile *= across * down / sum;
  }

  double error(std::size_t view, double tolerance) const { return at_one[view] * std::pow(tolerance, power); }
  double worse_db(double tolerance) const {
    double most = 0;
    for (std::size_t view = 0; view < views.size(); ++view) most = std::max(most, error(view, tolerance));
    return db(most);
  }
  render::ProbeResult probed(const render::Probe& probe, double tolerance) const {
    double sum = 0, squares = 0, count = 0;
    for (std::size_t y = probe.row; y < down; y += probe.step) {
      for (std::size_t x = probe.column; x < across; x += probe.step, ++count) {
        sum += by_tile[y * across + x];
        squares += by_tile[y * across + x] * by_tile[y * across + x];
      }
    }
    return {.squared_error = error(probe.view, tolerance) * sum / count,
            .unevenness = std::max(0.0, count * squares / (sum * sum) - 1.0),
            .tiles = count,
            .pairs = kept * 100 * count,
            .exact_pairs = 100 * count};
  }

  std::vector<shared::View> views;
  std::vector<double> at_one, by_tile;
  double power, kept = 0.6;  // share of the pairs that a tolerance keeps
};

struct Course {
  double least = 1e9, most = 0.0, report_off = 0.0;  // dB, of the frames that are not exact
  int exact = 0, probes = 0, longest_exact = 0;
};

// Draws frames as Frame does, and multiplies the scene's error by `growth` after each.
Course follow(ToleranceControl& control, SimulatedScene& scene, int frames, double growth = 1.0,
              double motion = 0.01, const FrameSettings& settings = squared_40) {
  Course course;
  int in_a_row = 0;
  for (int n = 0; n < frames; ++n) {
    const ToleranceControl::Choice choice = control.choose(scene.views, settings, motion);
    const bool exact = choice.exact != ExactReason::not_exact;
    control.drew((exact ? 1.0 : scene.kept) * 100 * across * down * 2, 1e4);
    if (choice.probe) control.measured(scene.probed(*choice.probe, choice.tolerance));
    course.probes += choice.probe ? 1 : 0;
    course.exact += exact ? 1 : 0;
    course.longest_exact = std::max(course.longest_exact, in_a_row = exact ? in_a_row + 1 : 0);
    if (!exact) {
      const double truth = scene.worse_db(choice.tolerance);
      course.least = std::min(course.least, truth);
      course.most = std::max(course.most, truth);
      course.report_off = std::max(course.report_off, std::abs(control.quality() - truth));
    }
    for (double& error : scene.at_one) error *= growth;
  }
  return course;
}

TEST(ToleranceControl, FindsToleranceOfAnyScene) {
  for (const double power : {1.0, 1.3, 2.0, 6.0, 10.0}) {
    for (double tolerance = 1e-4; tolerance < 2e3; tolerance *= 10) {
      SimulatedScene scene(power, tolerance);
      ToleranceControl control;
      const Course course = follow(control, scene, 100);
      EXPECT_GE(course.least, 39.5) << tolerance << " ^ " << power;
      EXPECT_LE(course.exact, 30) << tolerance << " ^ " << power;
      EXPECT_LE(course.report_off, 1.0) << tolerance << " ^ " << power;
      const Course later = follow(control, scene, 60);
      EXPECT_LE(later.most, 41.5) << tolerance << " ^ " << power;
      EXPECT_LE(later.report_off, 0.4) << tolerance << " ^ " << power;
      // Injected: the first tolerance for all scenes.
      EXPECT_TRUE(std::abs(std::log10(tolerance / 0.1)) < 0.5 || std::abs(scene.worse_db(0.1) - 40.0) > 3.5);
    }
  }
}

TEST(ToleranceControl, FirstFrameAndCutsAreExact) {
  SimulatedScene scene(1.3, 0.1);
  ToleranceControl control;
  for (const double motion : {0.0, 1.1, 1e9}) {
    const Course cut = follow(control, scene, 1, 1.0, motion);
    EXPECT_EQ(cut.exact, 1);
    EXPECT_EQ(cut.probes, 0);
    const Course after = follow(control, scene, 30);
    EXPECT_LE(after.exact, 6) << "the tolerance is kept over a cut";
    EXPECT_GE(after.least, 39.5);
  }
}

TEST(ToleranceControl, FollowsChangingScene) {
  for (const double power : {1.0, 1.3, 2.0, 6.0}) {
    for (const double growth : {1.01, 1 / 1.01}) {  // 13 dB in 300 frames
      SimulatedScene scene(power, 0.05);
      ToleranceControl control;
      follow(control, scene, 30);
      const Course course = follow(control, scene, 300, growth, 0.05);
      EXPECT_GE(course.least, 39.5) << growth << " ^ " << power;
      EXPECT_LE(course.most, 42.0) << growth << " ^ " << power;
      EXPECT_LE(course.report_off, 0.7) << growth << " ^ " << power;
      EXPECT_EQ(course.exact, 0) << growth << " ^ " << power;
    }
  }
}

TEST(ToleranceControl, NextProbeDetectsJump) {
  for (const double jump : {10.0, 0.1}) {
    SimulatedScene scene(1.3, 0.05);
    ToleranceControl control;
    follow(control, scene, 60);
    for (double& error : scene.at_one) error *= jump;
    follow(control, scene, 9);  // a head at rest has a probe in every eighth frame
    const Course after = follow(control, scene, 60);
    EXPECT_GE(after.least, 39.5) << jump;
    EXPECT_LE(after.report_off, 0.7) << jump;
    EXPECT_LE(after.exact, 10) << jump;
    EXPECT_LE(follow(control, scene, 60).most, 41.5) << jump;
  }
}

TEST(ToleranceControl, WorseViewDecides) {
  for (const double ratio : {1.0, 3.0, 30.0}) {
    for (const std::vector<double>& views : {std::vector{1.0, ratio}, {ratio, 1.0}, {1.0, 1.0, ratio, 1.0}}) {
      SimulatedScene scene(1.5, 0.05, views);
      ToleranceControl control;
      const Course course = follow(control, scene, 100);
      EXPECT_GE(course.least, 39.3) << ratio;
      EXPECT_LE(follow(control, scene, 60).most, 41.5) << ratio;
      EXPECT_LE(course.exact, 20) << ratio;
    }
  }
}

TEST(ToleranceControl, FastMotionAddsProbesAndMargin) {
  SimulatedScene scene(1.3, 0.05);
  ToleranceControl control;
  follow(control, scene, 40);
  const Course calm = follow(control, scene, 80, 1.0, 0.001);
  const Course fast = follow(control, scene, 80, 1.0, 0.15);
  EXPECT_LT(3 * calm.probes, 2 * fast.probes);
  EXPECT_LT(calm.least, fast.most);
  const Course wild = follow(control, scene, 80, 1.0, 0.99);
  EXPECT_GT(wild.exact, 20) << "so much motion leaves too little known";
}

TEST(ToleranceControl, SmallSavingsAreDrawnExactly) {
  SimulatedScene scene(1.3, 0.1);
  scene.kept = 0.97;
  ToleranceControl control;
  follow(control, scene, 60);
  const Course course = follow(control, scene, 120);
  EXPECT_EQ(course.exact, 120);
  EXPECT_LE(course.probes, 5);
  EXPECT_EQ(control.choose(scene.views, squared_40, 0.0).exact, ExactReason::no_gain);
  scene.kept = 0.5;
  follow(control, scene, 60);
  EXPECT_LE(follow(control, scene, 60).exact, 10) << "it looks again now and then";
}

// Where many Gaussians lie behind one another, AdaGScale is faster at equal dB (docs/method.md 8).
TEST(ToleranceControl, LongListsChooseAdaGScale) {
  SimulatedScene scene(1.3, 0.1);
  ToleranceControl control;
  FrameSettings settings = squared_40;
  const auto rule_after = [&](double pairs_per_tile) {
    for (int n = 0; n < 100; ++n) {
      const auto choice = control.choose(scene.views, settings, 0.01);
      const double kept = choice.exact == ExactReason::not_exact ? scene.kept : 1.0;
      control.drew(kept * pairs_per_tile * across * down * 2, 1e4);
      if (choice.probe) control.measured(scene.probed(*choice.probe, choice.tolerance));
    }
    const auto last = control.choose(scene.views, settings, 0.01);
    EXPECT_EQ(last.exact, ExactReason::not_exact) << pairs_per_tile;
    return last.threshold;
  };
  settings.threshold.reset();
  EXPECT_EQ(rule_after(900), Threshold::squared);
  EXPECT_EQ(rule_after(1200), Threshold::adagscale);
  EXPECT_EQ(rule_after(900), Threshold::adagscale) << "rules do not alternate from frame to frame";
  EXPECT_EQ(rule_after(600), Threshold::squared);
  settings.threshold = Threshold::squared;
  EXPECT_EQ(rule_after(1200), Threshold::squared) << "it is named";
}

TEST(ToleranceControl, SmallPicturesAreDrawnExactly) {
  const std::vector views = {make_view(test::front_camera(320, 300, 100))};
  ToleranceControl control;
  for (int n = 0; n < 10; ++n) {
    const auto choice = control.choose(views, {{.quality = 40, .threshold = Threshold::squared}}, 0.0);
    EXPECT_EQ(choice.exact, ExactReason::small);
    EXPECT_FALSE(choice.probe);
    control.drew(1e5, 1e4);
  }
}

TEST(ToleranceControl, ProbesOfNarrowViewHaveTiles) {
  const std::vector views = {make_view(test::front_camera(16, 16 * 1025, 400))};
  ToleranceControl control;
  for (int n = 0; n < 40; ++n) {
    const auto choice = control.choose(views, {{.quality = 40, .threshold = Threshold::squared}}, 0.5);
    control.drew(1e6, 1e4);
    if (!choice.probe) continue;
    EXPECT_EQ(choice.probe->column, 0u);
    control.measured({.squared_error = 1e-4, .tiles = 500, .pairs = 5e4, .exact_pairs = 1e5});
  }
}

TEST(ToleranceControl, EmptyViewKeepsToleranceBounded) {
  SimulatedScene scene(1.3, 0.1);
  ToleranceControl control;
  for (int n = 0; n < 300; ++n) {
    const auto choice = control.choose(scene.views, squared_40, 0.1);
    control.drew(1e6, 1e4);
    if (choice.probe) control.measured({.tiles = 75, .pairs = 5e3, .exact_pairs = 1e4});
  }
  EXPECT_LE(follow(control, scene, 100).exact, 80);
}

// For example, levels of detail use a part of the allowed error, and the rest changes.
TEST(ToleranceControl, FollowsChangingQuality) {
  SimulatedScene scene(1.3, 0.05);
  ToleranceControl control;
  follow(control, scene, 40);
  FrameSettings settings = squared_40;
  for (int n = 0; n < 90; ++n) {
    settings.quality = 41.5f - 1.5f * std::cos(0.07f * static_cast<float>(n));
    const Course frame = follow(control, scene, 1, 1.0, 0.01, settings);
    EXPECT_TRUE(frame.exact == 1 || std::abs(frame.least - *settings.quality - 0.5) < 0.9) << n;
  }
  settings.quality = 50;
  const Course better = follow(control, scene, 40, 1.0, 0.01, settings);
  EXPECT_GE(better.least, 49.5);
  EXPECT_LE(better.exact, 5);
}

TEST(ToleranceControl, ProbesVisitEveryTile) {
  for (const int probe_tiles : {64, 280}) {
    SimulatedScene scene(1.5, 0.1);
    ToleranceControl control;
    std::vector<int> seen(2 * across * down);
    std::uint32_t step = 0;
    for (std::uint32_t n = 0; n == 0 || n < 2 * step * step;) {
      FrameSettings settings = squared_40;
      settings.probe_tiles = probe_tiles;
      const auto choice = control.choose(scene.views, settings, 0.3);
      control.drew(1e6, 1e4);
      if (!choice.probe) continue;
      control.measured(scene.probed(*choice.probe, choice.tolerance));
      step = choice.probe->step;
      for (auto y = choice.probe->row; y < down; y += step)
        for (auto x = choice.probe->column; x < across; x += step)
          ++seen.at((choice.probe->view * down + y) * across + x);
      ++n;
    }
    EXPECT_EQ(step, probe_tiles == 64 ? 4u : 2u);
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 2 * across * down);
  }
}

TEST(ToleranceControl, ErrorFreeTilesDoNotDecide) {
  SimulatedScene scene(1.5, 0.1);
  ToleranceControl control;
  follow(control, scene, 60);
  for (;;) {  // the probe sees only an empty sky
    const auto choice = control.choose(scene.views, squared_40, 0.01);
    control.drew(1e5, 1e4);
    if (!choice.probe) continue;
    control.measured({.tiles = 75});
    break;
  }
  EXPECT_GE(follow(control, scene, 60).least, 39.5);
}

}  // namespace
}  // namespace binosplat
