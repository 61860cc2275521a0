#pragma once
// Which tolerance gives a wanted quality: a search that asks for few pictures.

#include <functional>

namespace binosplat::measure {

struct ToleranceSearch {
  double start = 1.0;      // asked first; must be above 0
  double smallest = 1e-9;  // what is asked lies between these two
  double largest = 1e9;
  double within = 0.01;     // the search ends where a value that holds is this near to the target
  double narrowest = 1e-6;  // ... or where the next tolerance that fails is only this share larger: a step
  int evaluations = 40;     // ... or after this many evaluations
};

struct FoundTolerance {
  double tolerance = 0.0;  // the largest of those asked that holds
  double value = 0.0;      // there
  int evaluations = 0;
};

/// The largest tolerance whose value holds: is at least `target`. `value(tolerance)` is to fall as the
/// tolerance rises (PSNR, pairs left, a negated drop). A fall that is not quite steady does no harm: the
/// tolerance is always one whose own value was seen to hold, and no larger one was seen to. Where nothing
/// above 0 holds the tolerance is 0, whose value must hold (else: Error). For several views give the mean or
/// the smallest of their values.
FoundTolerance find_tolerance(const std::function<double(double tolerance)>& value, double target,
                              const ToleranceSearch& search = {});

}  // namespace binosplat::measure
