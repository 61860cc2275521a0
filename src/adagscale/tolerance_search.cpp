#include "adagscale/tolerance_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"

namespace binosplat::adagscale {

namespace {

/// An evaluation: the logarithm of a tolerance, in which PSNR is nearly linear, and the value minus the aim.
struct Asked {
  double log_tolerance, above;
};

/// Returns the logarithm of the next tolerance: the zero of the line through both evaluations. It stays at
/// least 5 % of the bracket away from both evaluations, so that the bracket shrinks.
double between(const Asked& holds, const Asked& fails) {
  double share = holds.above / (holds.above - fails.above);
  if (!std::isfinite(share)) share = 0.5;
  return std::lerp(holds.log_tolerance, fails.log_tolerance, std::clamp(share, 0.05, 0.95));
}

}  // namespace

FoundTolerance find_tolerance(const std::function<double(double tolerance)>& value, double target,
                              const ToleranceSearch& search) {
  if (!(search.smallest > 0.0 && search.smallest <= search.start && search.start <= search.largest)) {
    fail("tolerance search from {} in [{}, {}]: expected 0 < smallest <= start <= largest", search.start,
         search.smallest, search.largest);
  }
  const double low = std::log(search.smallest), high = std::log(search.largest);
  const double aim = target + 0.5 * search.within;
  FoundTolerance found;
  std::optional<Asked> holds, fails;
  bool last_held = false;
  double next = std::log(search.start), step = std::log(2.0);
  while (found.evaluations < search.evaluations) {
    const double tolerance = std::clamp(std::exp(next), search.smallest, search.largest);
    const double at_tolerance = value(tolerance);
    ++found.evaluations;
    // The Illinois rule: if an end of the bracket stays for two rounds, halves its value for the line. The
    // next zero then lies closer to this end, and the bracket shrinks from both sides.
    if (at_tolerance >= target) {
      if (fails && last_held) fails->above *= 0.5;
      holds = {next, at_tolerance - aim};
      found.tolerance = tolerance;
      found.value = at_tolerance;
      if (at_tolerance - target <= search.within || next >= high) return found;
    } else {
      if (holds && !last_held) holds->above *= 0.5;
      fails = {next, at_tolerance - aim};
      if (next <= low) break;
    }
    last_held = at_tolerance >= target;
    if (holds && fails) {
      if (fails->log_tolerance - holds->log_tolerance < search.narrowest)
        return found;  // the value has a step between `holds` and `fails`
      next = between(*holds, *fails);
    } else {
      next = std::clamp(next + (holds ? step : -step), low, high);
      step *= 2;
    }
  }
  if (holds) return found;
  found.value = value(0.0);
  ++found.evaluations;
  if (!(found.value >= target))
    fail("no tolerance reaches {}: even tolerance 0 gives {}", target, found.value);
  return found;
}

}  // namespace binosplat::adagscale
