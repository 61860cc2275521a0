#pragma once
// Searches the largest tolerance that reaches a quality. Uses few evaluations, because each draws pictures.

#include <functional>

namespace binosplat::measure {

struct ToleranceSearch {
  double start = 1.0;      // first tolerance; above 0
  double smallest = 1e-9;  // limits of the search
  double largest = 1e9;
  // The search ends if a value exceeds the target by at most `within`, or after `evaluations` evaluations. It
  // also ends if the logarithms of a tolerance that holds and of one that fails differ by less than
  // `narrowest`: the value has a step between the two.
  double within = 0.01;
  double narrowest = 1e-6;
  int evaluations = 40;
};

struct FoundTolerance {
  double tolerance = 0.0;  // the largest evaluated tolerance whose value reaches the target
  double value = 0.0;      // value(tolerance)
  int evaluations = 0;
};

/// Searches the largest tolerance that holds: its value is at least `target`. `value(tolerance)`, such as a
/// PSNR or the number of remaining pairs, should decrease with the tolerance, but need not be monotonic. The
/// result holds, and no larger evaluated tolerance does. If no tolerance above 0 holds, returns 0, which must
/// hold (else: Error). For several views, pass the mean or the minimum of their values.
FoundTolerance find_tolerance(const std::function<double(double tolerance)>& value, double target,
                              const ToleranceSearch& search = {});

}  // namespace binosplat::measure
