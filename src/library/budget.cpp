#include <binosplat/report.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace binosplat {

namespace {

constexpr Effort efforts[] = {{{}, 1.0},    {46.0f, 1.0}, {43.0f, 1.0}, {40.0f, 1.0}, {37.0f, 1.0},
                              {37.0f, 0.9}, {37.0f, 0.8}, {37.0f, 0.7}, {37.0f, 0.6}, {37.0f, 0.5}};
constexpr int last_effort = static_cast<int>(std::size(efforts)) - 1;
constexpr double raise_below = 0.75, lower_above = 1.33;
constexpr double max_wait_ms = 32000.0;
constexpr int max_unmeasured = 16;

}  // namespace

Effort FrameBudget::effort() const { return efforts[step_]; }

void FrameBudget::took(const Report& frame, double period_ms) {
  // The first frame of an effort may compile programs.
  if (std::exchange(fresh_, false)) return;
  // A few such frames follow a quick turn of the head, and tell nothing about the time of those after them.
  unmeasured_ = frame.exact == ExactReason::unmeasured ? unmeasured_ + 1 : 0;
  if (unmeasured_ > 0 && unmeasured_ <= max_unmeasured) return;
  const double ms = frame.gpu_ms;
  late_ = ms > ms_ ? late_ + 1 : 0;
  early_ms_ = ms < raise_below * ms_ ? early_ms_ + period_ms : 0.0;
  since_raised_ms_ += period_ms;
  if (late_ >= 2 || ms > lower_above * ms_) {
    if (raised_) wait_ms_ = std::min(2.0 * wait_ms_, max_wait_ms);  // the last raise was too much
    if (step_ < last_effort) set(step_ + 1);
    raised_ = false;
    return;
  }
  if (raised_ && since_raised_ms_ > wait_ms_) {  // the last raise holds
    raised_ = false;
    wait_ms_ = min_wait_ms;
  }
  if (early_ms_ < wait_ms_ || step_ == 0) return;
  set(step_ - 1);
  raised_ = true;
  since_raised_ms_ = 0.0;
}

void FrameBudget::set(int step) {
  step_ = step;
  late_ = 0;
  early_ms_ = 0.0;
  fresh_ = true;
}

}  // namespace binosplat
