#pragma once
// Measures rules along moving heads: the true quality of every frame against the exact one, the quality that
// the frame reports, and its cost; with every rule at one request, and with every rule at one true quality.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gl/context.h"
#include "lab/motion_numbers.h"
#include "lab/rule.h"
#include "scene/model.h"

namespace binosplat::lab {

struct MotionSettings {
  float quality = 40.0f;      // dB that every rule is asked for
  double target = 40.0;       // dB of the moving frames' true mean that rules are compared at
  bool equal = true;          // whether they are
  double equal_within = 0.1;  // dB
  int rounds = 2;             // in which frames are timed
  /// Exact pictures stay on the GPU up to so many bytes; those beyond are drawn again for each rule.
  std::int64_t exact_bytes = std::int64_t{8} << 30;
};

/// A rule at one request, along one path.
struct MovedPass {
  float request = 0.0f;  // dB
  MovedFrames frames;
  MotionSummary lead, moving, stop;
};

struct MovedRule : Rule {
  MovedPass asked;
  bool compared = false;  // at the target: what follows was looked for
  /// As near to the target as a request was found, without stops. None where the request asked for came
  /// nearest itself.
  std::optional<MovedPass> equal;
  int evaluations = 0;  // of requests, beside the one asked for
  std::string problem;  // why it cannot be compared with the others there; empty: it can

  const MovedPass& at_target() const { return equal ? *equal : asked; }
};

struct MotionResult {
  MotionPath path;
  MovedPass exact;  // pairs and times of --th tau
  std::vector<MovedRule> rules;
};

/// The rules along each of the paths. Every segment is drawn as by a program that has just started
/// (Frame::start_over). Frames are judged in one pass and timed in others, which only draw: segment by
/// segment, rule after rule, so that a clock that drifts does the same to all; --th tau, which goes by no
/// rule, is timed with them. Tables of bounds by depth are measured in the first and last views of segments.
/// `progress(what, done, of)` tells what is under way.
std::vector<MotionResult> measure_motion(
    gl::Context& context, const Model& model, const std::vector<MotionPath>& paths, std::vector<Rule> rules,
    const MotionSettings& settings,
    const std::function<void(const std::string&, std::size_t, std::size_t)>& progress);

/// Of a rule's moving frames: their time in the exact frames', and it and the pairs in those of the rule that
/// takes a bound of 1 with the same threshold; none where that is not among the rules.
struct MovedShares {
  std::optional<double> ms_of_exact, ms_of_one, pairs_of_one;
};

MovedShares shares(const MotionResult& result, const MovedRule& rule, bool at_target);

/// All of a study, and where it was made.
struct MotionStudy {
  std::string device, scene;
  std::size_t gaussians = 0;
  std::size_t eyes = 0;
  std::uint32_t width = 0, height = 0;  // px, of an eye's picture
  double frames_per_second = 0.0;
  double units_per_metre = 0.0;
  std::string metre_source;
  MotionSettings settings;
  std::vector<MotionResult> paths;
};

/// The members, with units. A path has name, motion, lengths of the segments (in frames), exact and rules; a
/// rule its name and settings, and under `asked` and, where it was compared, `at_target` a pass: request_db,
/// moving, lead and stop (summaries), segments (series) and the shares, null where there are none.
nlohmann::ordered_json to_json(const MotionStudy& study);

}  // namespace binosplat::lab
