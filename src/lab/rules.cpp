#include "lab/rules.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/statistics.h"
#include "lab/fields.h"
#include "lab/settings.h"
#include "lab/times.h"
#include "lab/wake.h"
#include "measure/search.h"
#include "stereo/disagreement.h"

namespace binosplat::lab {

namespace {

constexpr double near_target_db = 0.3;  // rules nearer than this to the target are compared
constexpr double within_db = 0.1;
constexpr int evaluations_max = 20;
constexpr int warm_up_frames = 5;
// Once what frames measure of themselves has settled, single frames swing in a round of twelve, as what was
// left out ages until it is measured again: the mean over a round is what a rule costs. Frames that are not
// timed all measure: those that do not are the next one's likes.
constexpr int round_frames = 12;

std::string problem_of(const RuleResult& result, double target) {
  if (render::is_exact(result.variant.th)) return std::isinf(result.db) ? "" : "differs from the exact frame";
  if (std::abs(result.db - target) <= near_target_db) return "";
  return fmt::format("not within {} dB of {:g} dB", near_target_db, target);
}

double db_of(double squared_error) { return -10.0 * std::log10(squared_error); }

// What settled frames cost.
RuleResult settled(FixedCamera& camera, const Variant& rule) {
  RuleResult result{.variant = rule};
  camera.settle(rule);
  const int frames = render::measures(rule.transmittance) ? round_frames : 1;
  double sum = 0.0, largest = 0.0;
  for (int n = 0; n < frames; ++n) {
    result.pairs += static_cast<double>(camera.draw(rule).pairs) / frames;
    const double error = camera.squared_error();
    sum += error / frames;
    largest = std::max(largest, error);
  }
  result.removed = 1.0 - result.pairs / camera.exact_pairs();
  result.db = db_of(sum);
  result.worst_db = db_of(largest);
  return result;
}

double disagreement_of(FixedCamera& camera) {
  const std::vector<shared::View>& views = camera.views();
  if (views.size() != 2) return std::numeric_limits<double>::quiet_NaN();
  return stereo::disagreement(std::array{views[0], views[1]}, camera.exact(), camera.pictures()).db;
}

void take_means(const Times& times, RuleResult& result) {
  result.timed_pairs = mean(times.pairs);
  result.frame_ms = mean(times.frame);
  result.lower_ms = quantile(times.frame, 0.25);
  result.upper_ms = quantile(times.frame, 0.75);
  for (const std::string& name : times.stage_names)
    result.stages.push_back({name, mean(times.stages.at(name))});
}

// The frame time of the rule that `is` finds; not a number where there is none.
template <typename Is>
double frame_ms_of(const std::vector<RuleResult>& results, const Is& is) {
  const auto found =
      std::find_if(results.begin(), results.end(), [&](const RuleResult& r) { return is(r.variant); });
  return found == results.end() ? std::numeric_limits<double>::quiet_NaN() : found->frame_ms;
}

}  // namespace

void find_tolerances(FixedCamera& camera, std::vector<Variant>& rules, double target,
                     const std::function<void()>& progress) {
  // The tolerance of the last rule with the same threshold is near.
  std::map<int, double> starts;
  for (Variant& rule : rules) {
    const auto db_at = [&](double tolerance) {
      if (tolerance == 0.0) return std::numeric_limits<double>::infinity();  // every rule is exact there
      rule.tolerance = static_cast<float>(tolerance);
      return settled(camera, rule).db;
    };
    if (!render::is_exact(rule.th)) {
      double& start =
          starts.try_emplace(rule.th, render::threshold_rules[rule.th].careful_tolerance).first->second;
      const double tolerance =
          measure::find_tolerance(db_at, target,
                                  {.start = start, .within = within_db, .evaluations = evaluations_max})
              .tolerance;
      rule.tolerance = static_cast<float>(tolerance);
      if (tolerance > 0.0) start = tolerance;
    }
    progress();
  }
}

std::vector<RuleResult> measure_rules(FixedCamera& camera, const std::vector<Variant>& rules, double target,
                                      int frames, const std::function<void()>& progress) {
  std::vector<RuleResult> results;
  for (const Variant& rule : rules) {
    RuleResult& result = results.emplace_back(settled(camera, rule));
    result.disagreement_db = disagreement_of(camera);
    result.problem = problem_of(result, target);
  }
  wake(camera.context(), 1000.0, [&] { camera.draw(rules.front()); });  // it slept while pictures were read
  std::vector<Times> times(rules.size());
  for (int round = 0; round < rule_rounds; ++round) {
    for (std::size_t k = 0; k < rules.size(); ++k) {
      camera.settle(rules[k]);
      const int record_every = rules[k].settings().record_every;
      for (int n = 0; n < warm_up_frames; ++n) camera.draw(rules[k], record_every);
      for (int n = 0; n < frames; ++n) times[k].add(camera.draw(rules[k], record_every));
      progress();
    }
  }
  for (std::size_t k = 0; k < rules.size(); ++k) take_means(times[k], results[k]);
  const double exact_ms = frame_ms_of(results, [](const Variant& v) { return render::is_exact(v.th); });
  for (RuleResult& result : results) {
    result.of_exact = result.frame_ms / exact_ms;
    result.of_one = result.frame_ms / frame_ms_of(results, [&](const Variant& v) {
                      return v.th == result.variant.th && v.transmittance == TRANSMITTANCE_ONE;
                    });
  }
  return results;
}

nlohmann::ordered_json to_json(const RuleResult& r) {
  nlohmann::ordered_json json = object(
      "name", r.variant.name(), "settings", to_json(r.variant.settings()), "psnr_db", r.db, "worst_psnr_db",
      r.worst_db, "disagreement_db", r.disagreement_db, "pairs", r.pairs, "pairs_removed", r.removed,
      "frame_ms", r.frame_ms, "frame_ms_quartiles", std::array{r.lower_ms, r.upper_ms}, "timed_pairs",
      r.timed_pairs, "of_exact", r.of_exact, "of_one", r.of_one, "stages_ms", r.stages);
  if (!r.problem.empty()) json["problem"] = r.problem;
  return json;
}

}  // namespace binosplat::lab
