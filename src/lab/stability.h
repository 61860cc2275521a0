#pragma once
// The stability study: every threshold and source on every failure case, judged frame by frame against exact
// frames, with verdicts that follow from stated bounds.

#include <functional>
#include <string>
#include <vector>

#include "gl/context.h"
#include "lab/judge.h"
#include "lab/stability_cases.h"
#include "render/settings.h"

namespace binosplat::lab {

/// A rule with all that it goes by, at a tolerance.
struct Variant {
  int th = TH_SQUARED;
  int transmittance = TRANSMITTANCE_ONE;
  float tolerance = 0.0f;

  render::FrameSettings settings() const;
  std::string name() const;  // "squared, last"
};

/// Every threshold with every source that it takes; the exact one first. Tolerances are 0.
std::vector<Variant> all_variants();

/// What a verdict follows from. A case holds if none of these is broken.
struct StabilityBounds {
  double worst_db = 34.0;    // no frame below
  double settled_db = 37.0;  // the median of the last third of the frames
  double darkening = 0.004;  // no frame's mean signed error beyond, either way
  double drift_db =
      0.5;  // of a still camera from the second third to the last, of the medians: no fall beyond
  std::size_t settling = 3;  // frames after the start or a jump until, and for good, none is below settled_db
                             // and more than 1 dB below what is settled to
  double disagreement_db = 34.0;  // no frame below
};

struct StabilityResult {
  double worst_db = 0.0;
  std::size_t worst_frame = 0;
  double settled_db = 0.0;
  double drift_db = 0.0;  // settled minus the median of the second third; 0 unless the camera is still
  double largest = 0.0, p99 = 0.0, signed_mean = 0.0, edges = 0.0;  // the largest of any frame
  double disagreement_db = 0.0;                                     // the least of any frame
  std::size_t settling = 0;  // frames from the event, as the bound counts them
  double removed = 0.0;      // share of the exact frames' pairs
  std::string verdict;       // "holds", or the bounds that it breaks
};

/// Runs a case for each of the variants. `progress` is called after each.
std::vector<StabilityResult> run_case(gl::Context& context, const StabilityCase& one,
                                      const std::vector<Variant>& variants, const StabilityBounds& bounds,
                                      const std::function<void()>& progress);

/// All of a study: results are by case and by rule.
struct StabilityStudy {
  struct Case {
    std::string name, fear;
    std::vector<StabilityResult> results;
  };
  std::string scene, device;
  double target = 0.0;  // dB that the rules' tolerances are chosen for
  StabilityBounds bounds;
  std::vector<Variant> rules;
  std::vector<Case> cases;
};

}  // namespace binosplat::lab
