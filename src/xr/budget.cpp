#include "xr/budget.h"

#include <algorithm>
#include <iterator>

namespace binosplat::xr {

namespace {

constexpr Effort efforts[] = {{0.0f, 1.0},  {46.0f, 1.0}, {43.0f, 1.0}, {40.0f, 1.0}, {37.0f, 1.0},
                              {37.0f, 0.9}, {37.0f, 0.8}, {37.0f, 0.7}, {37.0f, 0.6}, {37.0f, 0.5}};
constexpr int least = static_cast<int>(std::size(efforts)) - 1;
constexpr double ample = 0.75, much_too_late = 1.33;
constexpr double wait_most_ms = 32000.0;

}  // namespace

Effort Budget::effort() const { return efforts[step_]; }

void Budget::took(double ms, double period_ms) {
  late_ = ms > ms_ ? late_ + 1 : 0;
  early_ms_ = ms < ample * ms_ ? early_ms_ + period_ms : 0.0;
  if (late_ >= 2 || ms > much_too_late * ms_) {
    // What was raised not long ago was raised too far.
    wait_ms_ = std::min(2.0 * wait_ms_, wait_most_ms);
    step_ = std::min(step_ + 1, least);
    late_ = 0;
  } else if (early_ms_ >= wait_ms_ && step_ > 0) {
    --step_;
    early_ms_ = 0.0;
  }
}

}  // namespace binosplat::xr
