#include "render/tolerance_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binosplat::render {

namespace {

constexpr double fading = 0.7;  // factor of the weight of a view's earlier probes, for each new probe
// The limit of all earlier probes' weight, divided by a new probe's: even a probe of a whole view ages.
constexpr double carried_max = 1.25;
// dB from the requested quality up to the aim: the quality is promised for the worst view and single frames.
constexpr double margin = 0.3;
// dB. A frame that is more than `miss` below the requested quality is drawn again. After a cut, so is a frame
// that is more than fresh_below under the aim or more than fresh_above over it.
constexpr double miss = 0.75;
constexpr double fresh_below = 0.3, fresh_above = 0.6;
constexpr double miss_of_one = 1.75;  // `miss` for this frame's probe alone, without earlier probes
// A probe's error over the expected error, above which the scene has changed, not only the sample.
constexpr double surprise = 2.7;
// A probe has enough tiles for this relative standard deviation of its result, and at least one tile in
// `share_max`.
constexpr double deviation = 0.12;
constexpr double share_max = 64.0;
constexpr double small_most = 1024.0;  // a view with this many tiles is never small
// The last attempt at a frame is exact; the last three accept a quality that is too good.
constexpr int attempts_max = 8;
// The largest factors of the tolerance: up and down between frames, and between attempts.
constexpr double step_up = 1.2, step_down = 2.0, step_searching = 30.0;
constexpr double slope_min = 1.0, slope_max = 24.0, slope_up_min = 3.0;
constexpr double tolerance_min = 1e-9, tolerance_max = 1e9;

// dB. Levels of detail use a part of the error, and so change the requested quality. The tolerance follows a
// change of at most `followed`; a larger change starts a search. A rise by more than `unnoticed` needs a
// probe.
constexpr double followed = 3.5, unnoticed = 0.25;

// Smaller pictures have smaller Gaussians, so the tolerance falls faster than the focal length: with
// `squared` and `last`, fox needed 0.148 at a focal length of 690 px and 0.027 at 160 px.
double careful_tolerance_at_40_db(const FrameSettings& s, double focal) {
  return threshold_rules[s.th].careful_tolerance * std::pow(std::min(1.0, focal / 700.0), 1.75);
}

bool is_small(const shared::View& view, const FrameSettings& settings) {
  const double side = settings.tile_size, all = std::ceil(view.width / side) * std::ceil(view.height / side);
  return all < std::min(4.0 * settings.probe_tiles, small_most);
}

bool same_rule(const FrameSettings& a, const FrameSettings& b) {
  return (a.quality > 0.0f) == (b.quality > 0.0f) && std::abs(a.quality - b.quality) <= followed &&
         a.th == b.th && a.transmittance == b.transmittance;
}

}  // namespace

void ToleranceControl::forget() {
  for (Estimate& view : views_) view.weight = 0.0;
  whole_probe_ = after_cut_ = is_final_ = true;
}

bool ToleranceControl::is_settled(std::span<const shared::View> views, const FrameSettings& settings) const {
  const bool saw_all =
      std::all_of(views_.begin(), views_.end(), [](const Estimate& v) { return v.weight > 0.0; });
  return saw_all && !whole_probe_ && is_final_ && !exact_ && same_rule(settings, settings_) &&
         settings.quality <= settings_.quality + unnoticed && !is_small(views.front(), settings);
}

void ToleranceControl::begin(const FrameSettings& settings, double focal) {
  forget();
  settings_ = settings;
  slope_ = threshold_rules[settings.th].slope;
  unevenness_ = 0.0;
  tolerance_ =
      careful_tolerance_at_40_db(settings, focal) * std::pow(10.0, -0.1 * (settings.quality - 40.0) / slope_);
}

Probe ToleranceControl::next_probe(std::span<const shared::View> views, const FrameSettings& settings) {
  if (views_.size() != views.size()) {
    views_.assign(views.size(), {});
    whole_probe_ = after_cut_ = true;
  }
  if (!same_rule(settings, settings_)) begin(settings, views.front().lens.y);
  settings_.quality = settings.quality;
  const auto count = static_cast<std::uint32_t>(views.size());
  if (is_final_) {
    views_held_ = 0;
    for (Estimate& view : views_) view.measured = false;
  }
  probe_ = {.view = static_cast<std::uint32_t>(next_ + views_held_) % count};
  const shared::View& view = views[probe_.view];
  is_small_ = is_small(view, settings);
  const auto side = static_cast<std::uint32_t>(settings.tile_size);
  const std::uint32_t across = (view.width + side - 1) / side, down = (view.height + side - 1) / side;
  // After a cut, a probe has all tiles. Later the number of tiles grows with the variance of their errors.
  const double all = static_cast<double>(across) * down;
  const double wanted = std::max(
      {static_cast<double>(settings.probe_tiles), all / share_max, unevenness_ / (deviation * deviation)});
  while (!whole_probe_ && (probe_.step + 1.0) * (probe_.step + 1.0) * wanted <= all) ++probe_.step;
  // The golden ratio spreads the offsets of successive probes evenly.
  const std::uint32_t places = probe_.step * probe_.step;
  std::uint32_t stride = std::max(1u, static_cast<std::uint32_t>(std::lround(0.618 * places)));
  while (std::gcd(stride, places) != 1) ++stride;
  const std::uint32_t place = next_ / count * stride % places;
  probe_.column = std::min(place % probe_.step, across - 1);
  probe_.row = std::min(place / probe_.step, down - 1);
  probe_tiles_ = all / places;
  return probe_;
}

float ToleranceControl::next_tolerance() {
  if (is_final_) {
    attempts_ = 0;
    bracket_ = {};
  }
  exact_ = ++attempts_ == attempts_max;
  if (exact_) return 0.0f;
  if (attempts_ > 1) {
    tolerance_ = std::clamp(searched_tolerance(target()), tolerance_min, tolerance_max);
  } else if (!whole_probe_ && views_held_ == 0) {
    tolerance_ = std::clamp(followed_tolerance(target()), tolerance_min, tolerance_max);
  }
  return static_cast<float>(tolerance_);
}

// The tolerance of a frame without a cut, from the error of the frames before.
double ToleranceControl::followed_tolerance(double target) const {
  const double error = worst();
  if (error <= 0.0) return tolerance_ * step_up;
  const double slope = error > target ? slope_ : std::max(slope_, slope_up_min);
  return tolerance_ * std::clamp(std::pow(target / error, 1.0 / slope), 1.0 / step_down, step_up);
}

// The tolerance of the next attempt at a frame.
double ToleranceControl::searched_tolerance(double target) const {
  const Bracket& b = bracket_;
  if (b.held > 0.0 && b.missed > 0.0) {
    if (attempts_ > attempts_max - 2) return b.held;
    double share = 0.5;  // position between `held` and `missed`, in logarithms
    if (b.held_error > 0.0) share = std::log(target / b.held_error) / std::log(b.missed_error / b.held_error);
    return b.held * std::pow(b.missed / b.held, std::clamp(share, 0.1, 0.9));
  }
  const double error = worst();
  if (error <= 0.0) return tolerance_ * step_searching;
  return tolerance_ *
         std::clamp(std::pow(target / error, 1.0 / slope_), 1.0 / step_searching, step_searching);
}

void ToleranceControl::add_probe(const ProbeResult& probed) {
  Estimate& view = views_[probe_.view];
  const double expected = error_now(view);
  const double error = probed.squared_error;
  const bool whole = probe_.step == 1;
  // If the error is far from the expected error, earlier probes do not count. A view without probes has no
  // expected error. A small error in some tiles promises nothing about the other tiles.
  if (view.weight > 0.0 && !whole_probe_ &&
      (error > surprise * expected || (whole && surprise * error < expected))) {
    for (Estimate& any : views_) any.weight = any.measured ? any.weight : 0.0;
  }
  unevenness_ = std::max(probed.unevenness, fading * unevenness_);
  // Tiles with such a small error may show only sky, so the next probe is larger.
  const bool doubtful = view.weight > 0.0 && !whole_probe_ && !whole && surprise * error < expected;
  if (doubtful) unevenness_ = std::max(unevenness_, 16.0 * deviation * deviation * probe_tiles_);
  const bool follows = view.weight > 0.0 && expected > 0.0;
  view.weight *= whole_probe_ || whole ? 0.0 : fading;
  if (!doubtful) view.weight = std::min(view.weight, carried_max * probe_tiles_);
  const double together = view.weight + probe_tiles_;
  view.error = view.weight > 0.0 ? (view.weight * expected + probe_tiles_ * error) / together : error;
  // Half of the change in dB also applies to the other views. Between attempts all of the change applies to
  // the other views, because the tolerance causes it.
  if (follows && view.error > 0.0) {
    const double trend = std::pow(view.error / expected, attempts_ > 1 ? 1.0 : 0.5);
    for (Estimate& any : views_) {
      if (&any == &view || (any.measured && any.tolerance == tolerance_)) continue;
      any.error = trend * error_now(any);
      any.tolerance = tolerance_;
      any.measured = false;
    }
  }
  view.weight += probe_tiles_;
  view.tolerance = tolerance_;
  view.measured = whole;
}

// Estimates the local exponent of the error from two attempts at a frame.
void ToleranceControl::learn(double target) {
  Bracket& b = bracket_;
  const double error = worst(), before_tolerance = b.held > 0.0 ? b.held : b.missed,
               before = b.held > 0.0 ? b.held_error : b.missed_error;
  if (before > 0.0 && error > 0.0 && std::abs(std::log(tolerance_ / before_tolerance)) > 0.02)
    slope_ =
        std::clamp(std::log(error / before) / std::log(tolerance_ / before_tolerance), slope_min, slope_max);
  if (error > target && (b.missed == 0.0 || tolerance_ < b.missed)) {
    b.missed = tolerance_;
    b.missed_error = error;
  } else if (error <= target && tolerance_ > b.held) {
    b.held = tolerance_;
    b.held_error = error;
  }
}

void ToleranceControl::measured(const ProbeResult& probed, bool settled) {
  is_final_ = exact_;
  if (!exact_) {
    add_probe(probed);
    if (whole_probe_) {
      // A quality that is too good only costs time: the last attempts accept it.
      const double above = quality() - settings_.quality - margin;
      const bool too_good = above > fresh_above && views_held_ == 0 && attempts_ <= attempts_max - 3;
      is_final_ = settled && above >= -fresh_below && !too_good;
      if (settled) learn(target());
    } else {
      const double wanted = std::pow(10.0, -0.1 * settings_.quality);
      is_final_ = settled && worst() <= wanted * std::pow(10.0, 0.1 * miss) &&
                  probed.squared_error <= wanted * std::pow(10.0, 0.1 * miss_of_one);
    }
  }
  const bool goes_on = is_final_ && (after_cut_ || is_small_) && !exact_ && ++views_held_ < views_.size();
  if (goes_on) {  // other views may have a larger error at this tolerance
    is_final_ = false;
    attempts_ = 0;
    bracket_ = {};
  }
  // Further attempts probe all tiles of the same view, because each view has its own exponent.
  whole_probe_ = !is_final_ && (!goes_on || after_cut_);
  if (is_final_) {
    after_cut_ = false;
    ++next_;
  }
}

bool ToleranceControl::is_measured() const {
  return exact_ || std::ranges::all_of(views_, [this](const Estimate& view) {
           return view.measured && view.tolerance == tolerance_;
         });
}

double ToleranceControl::target() const { return std::pow(10.0, -0.1 * (settings_.quality + margin)); }

double ToleranceControl::error_now(const Estimate& view) const {
  return view.error > 0.0 ? view.error * std::pow(tolerance_ / view.tolerance, slope_) : 0.0;
}

double ToleranceControl::worst() const {
  double most = 0.0;
  for (const Estimate& view : views_) most = view.weight > 0.0 ? std::max(most, error_now(view)) : most;
  return most;
}

double ToleranceControl::quality() const {
  const double error = exact_ ? 0.0 : worst();
  return error > 0.0 ? -10.0 * std::log10(error) : std::numeric_limits<double>::infinity();
}

}  // namespace binosplat::render
