#pragma once
// What every rule gains where the camera stands still: each at the tolerance that costs as much as the
// others', then all timed in turns.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/fixed_camera.h"

namespace binosplat::lab {

struct RuleResult {
  Variant variant;
  double db = 0.0;                    // of the mean squared error of settled frames; infinite for --th tau
  double worst_db = 0.0;              // of one of them
  double disagreement_db = 0.0;       // of the last of them; not a number for one eye
  double pairs = 0.0, removed = 0.0;  // their mean, and as a share of the exact frame's
  double frame_ms = 0.0, lower_ms = 0.0, upper_ms = 0.0;  // mean and quartiles
  double timed_pairs = 0.0;                               // mean of the frames timed
  std::vector<gl::StageTime> stages;                      // means
  double of_exact = 0.0, of_one = 0.0;  // its frame time in that of tau, and of its threshold with `one`
  std::string problem;                  // why it cannot be compared with the others; empty: it can
};

/// Gives each rule the tolerance at which it comes to `target` dB, at most 0.1 dB above; 0 where none does.
/// `progress` is called after each.
void find_tolerances(FixedCamera& camera, std::vector<Variant>& rules, double target,
                     const std::function<void()>& progress);

/// How often measure_rules() times each rule.
constexpr int rule_rounds = 3;

/// Draws each rule until it has settled, and checks that it comes to `target` dB; then times `frames` frames
/// of each in every one of the rounds, so that a clock that drifts does the same to all. Measured rules carry
/// what they measure from frame to frame. `progress` is called after each rule of a round.
std::vector<RuleResult> measure_rules(FixedCamera& camera, const std::vector<Variant>& rules, double target,
                                      int frames, const std::function<void()>& progress);

nlohmann::ordered_json to_json(const RuleResult& result);

}  // namespace binosplat::lab
