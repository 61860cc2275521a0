#pragma once
// Searches the tolerance for a quality, with few pictures.

#include <functional>

namespace binosplat::measure {

struct ToleranceSearch {
  double start = 1.0;      // first value; above 0
  double smallest = 1e-9;  // limits of the search
  double largest = 1e9;
  double within = 0.01;     // ends if a value that holds is this near to the target
  double narrowest = 1e-6;  // ... or if the next failing tolerance is larger by only this share: a step
  int evaluations = 40;     // ... or after this many evaluations
};

struct FoundTolerance {
  double tolerance = 0.0;  // the largest evaluated one that holds
  double value = 0.0;      // value at `tolerance`
  int evaluations = 0;
};

/// Searches the largest tolerance whose value holds, that is, reaches `target`. `value(tolerance)` should
/// decrease with the tolerance (PSNR, remaining pairs, a negated drop). It need not be monotonic: the
/// result's own value always holds, and no larger evaluated tolerance does. If none above 0 holds, returns 0,
/// whose value must hold (else: Error). For several views, pass the mean or the minimum of their values.
FoundTolerance find_tolerance(const std::function<double(double tolerance)>& value, double target,
                              const ToleranceSearch& search = {});

}  // namespace binosplat::measure
