#pragma once
// Which loss gives a wanted quality: a search that asks for few pictures.

#include <functional>

namespace binosplat::measure {

struct LossSearch {
  double start = 1.0;      // asked first; must be above 0
  double smallest = 1e-9;  // what is asked lies between these two
  double largest = 1e9;
  double tolerance = 0.01;  // the search ends where a value that holds is this near to the target
  double narrowest = 1e-6;  // ... or where the next loss that fails is only this share larger: a step
  int evaluations = 40;     // ... or after so many
};

struct FoundLoss {
  double loss = 0.0;   // the largest of those asked that holds
  double value = 0.0;  // there
  int evaluations = 0;
};

/// The largest loss whose value holds: is at least `target`. `value(loss)` is to fall as the loss rises
/// (PSNR, pairs left, a negated drop). A fall that is not quite steady does no harm: the loss is always one
/// whose own value was seen to hold, and no larger one was seen to. Where nothing above 0 holds the loss is
/// 0, whose value must hold (else: Error). For several views give the mean or the smallest of their values.
FoundLoss find_loss(const std::function<double(double loss)>& value, double target,
                    const LossSearch& search = {});

}  // namespace binosplat::measure
