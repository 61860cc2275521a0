// Compares the table of threshold rules with their float64 twins, and checks which settings are compatible.

#include "render/settings.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/splats.h"
#include "reference/threshold.h"
#include "render/debug_options.h"
#include "support/errors.h"

namespace binosplat::render {
namespace {

// Returns the wrong entry of a row, or "". At the careful tolerance, the Th of the splat is above tau.
std::string wrong_with(const ThresholdRule& rule, int th) {
  const reference::Splat splat = reference::make_splat({8, 8}, {5, 2, 4}, 1.0);
  const auto threshold = [&](double tolerance, double bound = 1.0) {
    return reference::threshold(th, tolerance, splat, bound);
  };
  if (threshold(0.0) != ALPHA_MIN) return "a tolerance of 0 costs something";
  const double careful = rule.exact ? 1.0 : rule.careful_tolerance;
  if ((threshold(careful) == ALPHA_MIN) != rule.exact) return "exact";
  if ((threshold(careful, 0.5) != threshold(careful)) != rule.uses_bound) return "bound";
  if (rule.exact == (rule.careful_tolerance > 0.0)) return "careful tolerance";
  if (rule.exact == (rule.slope >= 1.0)) return "slope";
  return "";
}

TEST(ThresholdRules, AreWhatTheirTwinsDo) {
  for (int th = 0; th < std::ssize(threshold_rules); ++th)
    EXPECT_EQ(wrong_with(threshold_rules[th], th), "") << th_choices[th].name;
  EXPECT_TRUE(is_exact(TH_TAU)) << "Stages that know no rule, and the shaders, take TH_TAU for exact.";
}

TEST(ThresholdRules, PlantedFaultsAreCaught) {
  const auto planted = [](auto change) {
    ThresholdRule rule = threshold_rules[TH_SQUARED];
    change(rule);
    return wrong_with(rule, TH_SQUARED);
  };
  EXPECT_EQ(wrong_with(threshold_rules[TH_TAU], TH_SQUARED), "exact");
  EXPECT_EQ(wrong_with(threshold_rules[TH_SQUARED], TH_TAU), "exact");
  EXPECT_EQ(planted([](ThresholdRule& rule) { rule.uses_bound = false; }), "bound");
  EXPECT_EQ(planted([](ThresholdRule& rule) { rule.careful_tolerance = 0.0; }), "exact");
  EXPECT_EQ(planted([](ThresholdRule& rule) { rule.slope = 0.0; }), "slope");
}

TEST(Settings, ThatContradictAreNamed) {
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<FrameSettings, std::string>> wrong = {
      {{.tolerance = 1.0f}, "--tolerance has no effect with the rule tau, which is exact"},
      {{.quality = 40.0f}, "--quality has no effect with the rule tau, which is exact"},
      {{.th = TH_SQUARED, .tolerance = 1.0f, .quality = 40.0f}, "--tolerance with --quality"},
      {{.th = TH_SQUARED, .tolerance = -1.0f}, "--tolerance -1"},
      {{.th = TH_SQUARED, .tolerance = nan}, "--tolerance nan"},
      {{.th = TH_SQUARED, .tolerance = infinite}, "--tolerance inf"},
      {{.th = TH_SQUARED, .quality = nan}, "--quality nan"},
      {{.th = TH_SQUARED, .quality = -1.0f}, "--quality -1"},
      {{.th = TH_SQUARED, .quality = 40.0f, .probe_tiles = 0}, "probe_tiles 0: expected at least 1"},
      {{.measure_every = 0}, "measure_every 0: expected at least 1"},
  };
  for (const auto& [settings, said] : wrong) {
    EXPECT_TRUE(test::fails_saying([&, s = settings] { check(s, "--"); }, {said}));
    EXPECT_TRUE(test::fails_saying([&, s = settings] { check_choice(s, "--"); }, {said}));
  }
  EXPECT_ERROR(check({.quality = 40.0f}), "quality has no effect with the rule tau");
}

TEST(DebugOptions, ThatContradictAreNamed) {
  const render::DebugOptions blended{.stand_in = render::StandIn{render::Stage::blend, {}}};
  check(blended, {.th = TH_SQUARED, .tolerance = 1.0f}, "--");
  for (const FrameSettings& settings :
       {FrameSettings{.th = TH_SQUARED, .quality = 40.0f},
        FrameSettings{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST}}) {
    EXPECT_ERROR(check(blended, settings, "--"), "--reference-until");
  }
}

TEST(Settings, ThatGoTogetherDo) {
  for (int th = 0; th < std::ssize(th_choices); ++th) {
    for (int source = 0; source < std::ssize(transmittance_choices); ++source) {
      FrameSettings settings{.th = th, .transmittance = source};
      settings.tolerance = static_cast<float>(threshold_rules[th].careful_tolerance);
      check(settings);  // every rule may use measurements
      if (can_use(th, source)) {
        check_choice(settings);
      } else {
        EXPECT_ERROR(check_choice(settings), "transmittance has no effect with the rule");
      }
    }
  }
  EXPECT_FALSE(can_use(TH_TAU, TRANSMITTANCE_LAST));
  EXPECT_TRUE(can_use(TH_SQUARED, TRANSMITTANCE_DEPTH));
  check({.th = TH_SQUARED});  // exact, since the tolerance is 0
  check({.th = TH_SQUARED, .quality = 40.0f});
}

}  // namespace
}  // namespace binosplat::render
