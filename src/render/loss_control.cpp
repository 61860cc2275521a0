#include "render/loss_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binosplat::render {

namespace {

// What a view's probe weighs after each further one of that view.
constexpr double fading = 0.8;
// dB that frames aim at above what is asked for: the promise is of the worse view, and of single frames.
constexpr double margin = 0.25;
// dB below what is asked for at which a frame is drawn again; and after a cut, about what is aimed at.
constexpr double miss = 0.75;
constexpr double fresh_below = 0.3, fresh_above = 1.0;
// Of what was expected: a probe beyond these shows another scene, not another part of it.
constexpr double surprise_above = 2.2, surprise_below = 0.25;
// So many times the tiles after a cut.
constexpr std::uint64_t more_when_fresh = 4;
constexpr int attempts_max = 8;  // the last of them exact
// Of the loss from one frame to the next, and between attempts.
constexpr double step = 2.0, step_when_fresh = 30.0;
constexpr double loss_min = 1e-9, loss_max = 1e9;

double target_of(const FrameSettings& s) { return std::pow(10.0, -0.1 * (s.quality + margin)); }

// METHOD 8: losses that gave 40 dB or a little more on every shared scene at a focal length of 700 px. In
// smaller pictures Gaussians are smaller, too, and fox asked for 0.027 (squared, last) at 160 px: less than
// in proportion.
double careful_loss_at_40_db(const FrameSettings& s, double focal) {
  const double smaller = std::pow(std::min(1.0, focal / 700.0), 1.75);
  if (s.th == TH_PERIPHERAL) return 1.0 * smaller;
  if (s.contrast == CONTRAST_FINAL) return 0.006 * smaller;
  return (s.contrast == CONTRAST_BEHIND ? 0.008 : 0.1) * smaller;
}

bool same_rule(const FrameSettings& a, const FrameSettings& b) {
  return a.quality == b.quality && a.th == b.th && a.contrast == b.contrast &&
         a.transmittance == b.transmittance;
}

}  // namespace

void LossControl::forget() {
  for (Estimate& view : views_) view.weight = 0.0;
  fresh_ = true;
}

void LossControl::begin(const FrameSettings& settings) {
  forget();
  settings_ = settings;
  slope_ = power_ = settings.th == TH_PERIPHERAL ? 2.0 : 1.3;
  loss_ = careful_loss_at_40_db(settings, focal_) * std::pow(10.0, -0.1 * (settings.quality - 40.0) / power_);
}

Probe LossControl::next_probe(std::span<const shared::View> views, const FrameSettings& settings) {
  if (views_.size() != views.size()) {
    views_.assign(views.size(), {});
    fresh_ = true;
  }
  const auto count = static_cast<std::uint32_t>(views.size());
  probe_ = {.view = next_ % count};
  const shared::View& view = views[probe_.view];
  focal_ = view.lens.y;
  const auto side = static_cast<std::uint32_t>(settings.tile_size);
  const std::uint32_t across = (view.width + side - 1) / side, down = (view.height + side - 1) / side;
  const std::uint64_t wanted = std::uint64_t{static_cast<std::uint32_t>(std::max(1, settings.probe_tiles))} *
                               (fresh_ ? more_when_fresh : 1);
  while ((probe_.step + 1) * (probe_.step + 1) * wanted <= across * down) ++probe_.step;
  // A golden step, so that the places of a few probes are spread evenly.
  const std::uint32_t places = probe_.step * probe_.step;
  std::uint32_t stride = std::max(1u, static_cast<std::uint32_t>(std::lround(0.618 * places)));
  while (std::gcd(stride, places) != 1) ++stride;
  const std::uint32_t place = next_ / count * stride % places;
  probe_.column = std::min(place % probe_.step, across - 1);
  probe_.row = std::min(place / probe_.step, down - 1);
  probe_tiles_ = static_cast<double>(across) * down / places;
  ++next_;
  return probe_;
}

float LossControl::next_loss(const FrameSettings& settings) {
  if (holds_) attempts_ = 0;
  if (!same_rule(settings, settings_) || loss_ == 0.0) begin(settings);
  exact_ = ++attempts_ == attempts_max;
  if (exact_) return 0.0f;
  if (!any_known()) return static_cast<float>(loss_);
  const double error = error_now(), most = fresh_ || attempts_ > 1 ? step_when_fresh : step;
  const double wanted = error > 0.0 ? std::pow(target_of(settings) / error, 1.0 / slope_) : most;
  last_loss_ = loss_;
  last_error_ = error;
  loss_ = std::clamp(loss_ * std::clamp(wanted, 1.0 / most, most), loss_min, loss_max);
  return static_cast<float>(loss_);
}

void LossControl::take(double error_at_one) {
  Estimate& view = views_[probe_.view];
  const double expected = view.weight > 0.0 ? view.error_at_one : most_at_one();
  const bool surprises = error_at_one > surprise_above * expected || error_at_one < surprise_below * expected;
  if (fresh_ || attempts_ > 1 || surprises)
    for (Estimate& any : views_) any.weight = 0.0;
  view.weight *= fading;
  view.error_at_one =
      (view.weight * view.error_at_one + probe_tiles_ * error_at_one) / (view.weight + probe_tiles_);
  view.weight += probe_tiles_;
}

void LossControl::measured(double squared_error, bool settled) {
  if (!exact_) take(squared_error / std::pow(loss_, power_));
  holds_ = exact_ || (settled && keeps_promise());
  // Between two attempts at one frame the error's own law is known.
  const double apart = std::log(loss_ / last_loss_), grown = std::log(error_now() / last_error_);
  const bool tells = settled && !holds_ && attempts_ > 2 && std::abs(apart) > 0.1 && std::isfinite(grown);
  slope_ = tells ? std::clamp(grown / apart, 0.5 * power_, 2.0 * power_) : power_;
  if (holds_) fresh_ = false;
}

bool LossControl::keeps_promise() const {
  const double above = quality() - settings_.quality;
  if (!fresh_) return above >= -miss;
  // What is too good costs time only: that is asked of the first attempts.
  return above >= margin - fresh_below && (above <= margin + fresh_above || attempts_ > attempts_max / 2);
}

bool LossControl::any_known() const {
  return std::any_of(views_.begin(), views_.end(), [](const Estimate& view) { return view.weight > 0.0; });
}

double LossControl::most_at_one() const {
  double most = 0.0;
  for (const Estimate& view : views_) most = view.weight > 0.0 ? std::max(most, view.error_at_one) : most;
  return most;
}

double LossControl::error_now() const { return most_at_one() * std::pow(loss_, power_); }

double LossControl::quality() const {
  const double error = exact_ ? 0.0 : error_now();
  return error > 0.0 ? -10.0 * std::log10(error) : std::numeric_limits<double>::infinity();
}

}  // namespace binosplat::render
