// Compares the table of threshold rules with their float64 references, and checks which settings are
// compatible.

#include "render/frame_settings.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/choices.h"
#include "reference/adagscale_threshold.h"
#include "reference/splats.h"
#include "render/debug_options.h"
#include "support/errors.h"

namespace binosplat::render {
namespace {

constexpr Threshold all_thresholds[] = {Threshold::exact, Threshold::adagscale, Threshold::squared};

// Returns the wrong entry of a row, or "". At the careful tolerance, the Th of the splat is above tau.
std::string wrong_with(const ThresholdRule& rule, Threshold kind) {
  const reference::Splat splat = reference::make_splat({8, 8}, {5, 2, 4}, 1.0);
  const auto threshold = [&](double tolerance, double bound = 1.0) {
    return reference::threshold(kind, tolerance, splat, bound);
  };
  if (threshold(0.0) != ALPHA_MIN) return "a tolerance of 0 costs something";
  const double careful = rule.exact ? 1.0 : rule.starting_tolerance;
  if ((threshold(careful) == ALPHA_MIN) != rule.exact) return "exact";
  if ((threshold(careful, 0.5) != threshold(careful)) != rule.uses_bound) return "bound";
  if (rule.exact == (rule.starting_tolerance > 0.0)) return "careful tolerance";
  if (rule.exact == (rule.slope >= 1.0)) return "slope";
  return "";
}

TEST(ThresholdRules, MatchReference) {
  for (const Threshold threshold : all_thresholds)
    EXPECT_EQ(wrong_with(rule_of(threshold), threshold), "") << name_of(threshold);
  EXPECT_TRUE(is_exact(Threshold::exact)) << "Stages that know no rule, and the shaders, take it for exact.";
}

TEST(ThresholdRules, DetectInjectedFaults) {
  const auto wrong_after = [](auto change) {
    ThresholdRule rule = rule_of(Threshold::squared);
    change(rule);
    return wrong_with(rule, Threshold::squared);
  };
  EXPECT_EQ(wrong_with(rule_of(Threshold::exact), Threshold::squared), "exact");
  EXPECT_EQ(wrong_with(rule_of(Threshold::squared), Threshold::exact), "exact");
  EXPECT_EQ(wrong_after([](ThresholdRule& rule) { rule.uses_bound = false; }), "bound");
  EXPECT_EQ(wrong_after([](ThresholdRule& rule) { rule.starting_tolerance = 0.0; }), "exact");
  EXPECT_EQ(wrong_after([](ThresholdRule& rule) { rule.slope = 0.0; }), "slope");
}

TEST(Settings, RejectContradictions) {
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  FrameSettings no_probe{{.quality = 40.0f}}, no_measurement;
  no_probe.probe_tiles = 0;
  no_measurement.measure_every = 0;
  const std::vector<std::pair<FrameSettings, std::string>> wrong = {
      {{{.tolerance = 1.0f, .threshold = Threshold::exact}},
       "--tolerance has no effect with an exact --threshold: leave one of them out"},
      {{{.quality = 40.0f, .threshold = Threshold::exact}},
       "--quality has no effect with an exact --threshold"},
      {{{.quality = 40.0f, .tolerance = 1.0f}}, "--quality 40 with --tolerance 1"},
      {{{.tolerance = -1.0f}}, "--tolerance -1: expected zero or more"},
      {{{.tolerance = nan}}, "--tolerance nan"},
      {{{.tolerance = infinite}}, "--tolerance inf"},
      {{{.quality = nan}}, "--quality nan: expected decibels from 10 to 100"},
      {{{.quality = -1.0f}}, "--quality -1"},
      {{{.threshold = Threshold::squared}},
       "--threshold squared needs --tolerance, --quality or a calibration"},
      {no_probe, "probe_tiles 0: expected at least 1"},
      {no_measurement, "measure_every 0: expected at least 1"},
  };
  for (const auto& [settings, said] : wrong)
    EXPECT_TRUE(test::fails_saying([&, s = settings] { check(s, "--"); }, {said}));
}

TEST(DebugOptions, RejectContradictions) {
  const render::DebugOptions blended{.stand_in = render::StandIn{render::Stage::blend, {}}};
  check(blended, {{.tolerance = 1.0f, .threshold = Threshold::squared}}, "--");
  for (const FrameSettings& settings :
       {FrameSettings{{.quality = 40.0f, .threshold = Threshold::squared}},
        FrameSettings{{.threshold = Threshold::squared, .transmittance = Transmittance::last}}}) {
    EXPECT_ERROR(check(blended, settings, "--"), "--reference-until");
  }
}

TEST(Settings, AcceptCompatibleCombinations) {
  for (const Threshold threshold : all_thresholds) {
    for (const Transmittance source : {Transmittance::one, Transmittance::depth, Transmittance::last}) {
      FrameSettings settings{{.threshold = threshold, .transmittance = source}};
      if (!is_exact(threshold))
        settings.tolerance = static_cast<float>(rule_of(threshold).starting_tolerance);
      if (can_use(threshold, source)) {
        check(settings);
      } else {
        EXPECT_ERROR(check(settings), "has no effect on exact pictures");
      }
    }
  }
  EXPECT_FALSE(can_use(Threshold::exact, Transmittance::last));
  EXPECT_TRUE(can_use(Threshold::squared, Transmittance::depth));
  check({{.tolerance = 0.0f, .threshold = Threshold::squared}});  // exact, since the tolerance is 0
  check({{.quality = 40.0f, .threshold = Threshold::squared}});
  check({{.threshold = Threshold::squared}}, "", true);
}

}  // namespace
}  // namespace binosplat::render
