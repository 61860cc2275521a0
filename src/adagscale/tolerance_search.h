#pragma once
// Searches the largest tolerance that reaches a quality. Uses few evaluations, because each draws pictures.

#include <functional>

namespace binosplat::adagscale {

struct ToleranceSearch {
  double start = 1.0;      // first tolerance; above 0
  double smallest = 1e-9;  // limits of the search
  double largest = 1e9;
  // The search ends if a value exceeds the target by at most `within`, after `evaluations` evaluations, or at
  // a step of the value: logarithms of a holding and a failing tolerance differ by less than `narrowest`.
  double within = 0.01;
  double narrowest = 1e-6;
  int evaluations = 40;
};

struct FoundTolerance {
  double tolerance = 0.0;  // the largest evaluated tolerance whose value reaches the target
  double value = 0.0;      // value(tolerance)
  int evaluations = 0;
};

/// Searches the largest tolerance that holds (`value(tolerance)` is at least `target`). No larger evaluated
/// tolerance holds. `value`, such as a PSNR, should decrease with the tolerance, but need not be monotonic;
/// for several views, use the mean or the minimum. If only 0 holds, returns 0; if 0 fails, throws Error.
FoundTolerance find_tolerance(const std::function<double(double tolerance)>& value, double target,
                              const ToleranceSearch& search = {});

}  // namespace binosplat::adagscale
