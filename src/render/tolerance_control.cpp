#include "render/tolerance_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binosplat::render {

namespace {

// What a view's probe weighs after each further one of that view.
constexpr double fading = 0.7;
// Of what a new probe weighs, the most that all before it do: the whole of a view was seen long ago, too.
constexpr double carried_max = 1.25;
// dB that frames aim at above what is asked for: the promise is of the worse view, and of single frames.
constexpr double margin = 0.3;
// dB below what is asked for at which a frame is drawn again; and after a cut, about what is aimed at.
constexpr double miss = 0.75;
constexpr double fresh_below = 0.3, fresh_above = 0.6;
// The same for one probe by itself.
constexpr double miss_of_one = 1.75;
// Of what was expected: a probe that errs more shows another scene, not another part of it.
constexpr double surprise = 2.7;
// One standard deviation of what a probe tells, as a share: it has as many tiles as that takes, and at least
// one of so many.
constexpr double deviation = 0.12;
constexpr double share_max = 64.0;
constexpr double small_most = 1024.0;  // tiles
// Attempts at a frame: the last is exact; those before it may be better than need be.
constexpr int attempts_max = 8;
// Of the tolerance: the most it changes by from one frame to the next and between attempts.
constexpr double step_up = 1.2, step_down = 2.0, step_searching = 30.0;
constexpr double slope_min = 1.0, slope_max = 24.0, slope_up_min = 3.0;
constexpr double tolerance_min = 1e-9, tolerance_max = 1e9;

// dB: a quality that changes by no more is followed from frame to frame, as what is left of one that levels
// of detail share is; another one is searched for. Tightened by more than the second it needs a probe.
constexpr double followed = 3.5, unnoticed = 0.25;

// In smaller pictures than the careful tolerance is for Gaussians are smaller, too, and fox asked for 0.027
// (squared, last) at 160 px: less than in proportion.
double careful_tolerance_at_40_db(const FrameSettings& s, double focal) {
  return threshold_rules[s.th].careful_tolerance * std::pow(std::min(1.0, focal / 700.0), 1.75);
}

// Whether a probe has all tiles of a view, whatever they show.
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
  fresh_ = cut_ = holds_ = true;
}

bool ToleranceControl::knows(std::span<const shared::View> views, const FrameSettings& settings) const {
  const bool saw_all =
      std::all_of(views_.begin(), views_.end(), [](const Estimate& v) { return v.weight > 0.0; });
  return saw_all && !fresh_ && holds_ && !exact_ && same_rule(settings, settings_) &&
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
    fresh_ = cut_ = true;
  }
  if (!same_rule(settings, settings_)) begin(settings, views.front().lens.y);
  settings_.quality = settings.quality;
  const auto count = static_cast<std::uint32_t>(views.size());
  if (holds_) {
    found_ = 0;
    for (Estimate& view : views_) view.measured = false;
  }
  probe_ = {.view = static_cast<std::uint32_t>(next_ + found_) % count};
  const shared::View& view = views[probe_.view];
  is_small_ = is_small(view, settings);
  const auto side = static_cast<std::uint32_t>(settings.tile_size);
  const std::uint32_t across = (view.width + side - 1) / side, down = (view.height + side - 1) / side;
  // After a cut all of it; then more, the more tiles differ.
  const double all = static_cast<double>(across) * down;
  const double wanted = std::max(
      {static_cast<double>(settings.probe_tiles), all / share_max, unevenness_ / (deviation * deviation)});
  while (!fresh_ && (probe_.step + 1.0) * (probe_.step + 1.0) * wanted <= all) ++probe_.step;
  // A golden step, so that the places of a few probes are spread evenly.
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
  if (holds_) {
    attempts_ = 0;
    bracket_ = {};
  }
  exact_ = ++attempts_ == attempts_max;
  if (exact_) return 0.0f;
  if (attempts_ > 1) {
    tolerance_ = std::clamp(searched_tolerance(target()), tolerance_min, tolerance_max);
  } else if (!fresh_ && found_ == 0) {
    tolerance_ = std::clamp(followed_tolerance(target()), tolerance_min, tolerance_max);
  }
  return static_cast<float>(tolerance_);
}

// From one frame to the next.
double ToleranceControl::followed_tolerance(double target) const {
  const double error = worst();
  if (error <= 0.0) return tolerance_ * step_up;
  const double slope = error > target ? slope_ : std::max(slope_, slope_up_min);
  return tolerance_ * std::clamp(std::pow(target / error, 1.0 / slope), 1.0 / step_down, step_up);
}

// Between attempts at a frame.
double ToleranceControl::searched_tolerance(double target) const {
  const Bracket& b = bracket_;
  if (b.held > 0.0 && b.missed > 0.0) {
    if (attempts_ > attempts_max - 2) return b.held;
    double share = 0.5;  // of the way from the one to the other, by their logarithms
    if (b.held_error > 0.0) share = std::log(target / b.held_error) / std::log(b.missed_error / b.held_error);
    return b.held * std::pow(b.missed / b.held, std::clamp(share, 0.1, 0.9));
  }
  const double error = worst();
  if (error <= 0.0) return tolerance_ * step_searching;
  return tolerance_ *
         std::clamp(std::pow(target / error, 1.0 / slope_), 1.0 / step_searching, step_searching);
}

void ToleranceControl::take(const Probed& probed) {
  Estimate& view = views_[probe_.view];
  const double expected = error_now(view);
  const double error = probed.squared_error;
  const bool whole = probe_.step == 1;
  // Of a view that was not seen yet nothing is expected. That some tiles show little is no promise of the
  // others.
  if (view.weight > 0.0 && !fresh_ &&
      (error > surprise * expected || (whole && surprise * error < expected))) {
    for (Estimate& any : views_) any.weight = any.measured ? any.weight : 0.0;
  }
  unevenness_ = std::max(probed.unevenness, fading * unevenness_);
  // These may be the sky: a larger probe is to tell.
  const bool doubtful = view.weight > 0.0 && !fresh_ && !whole && surprise * error < expected;
  if (doubtful) unevenness_ = std::max(unevenness_, 16.0 * deviation * deviation * probe_tiles_);
  const bool follows = view.weight > 0.0 && expected > 0.0;
  view.weight *= fresh_ || whole ? 0.0 : fading;
  if (!doubtful) view.weight = std::min(view.weight, carried_max * probe_tiles_);
  const double together = view.weight + probe_tiles_;
  view.error = view.weight > 0.0 ? (view.weight * expected + probe_tiles_ * error) / together : error;
  // What changes in one view changes in the others, mostly; what another tolerance changes, always.
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

// What two attempts at a frame say of the error's law about here.
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

void ToleranceControl::measured(const Probed& probed, bool settled) {
  holds_ = exact_;
  if (!exact_) {
    take(probed);
    if (fresh_) {
      // What is too good costs time only: not all attempts are for that.
      const double above = quality() - settings_.quality - margin;
      const bool too_good = above > fresh_above && found_ == 0 && attempts_ <= attempts_max - 3;
      holds_ = settled && above >= -fresh_below && !too_good;
      if (settled) learn(target());
    } else {
      const double wanted = std::pow(10.0, -0.1 * settings_.quality);
      holds_ = settled && worst() <= wanted * std::pow(10.0, 0.1 * miss) &&
               probed.squared_error <= wanted * std::pow(10.0, 0.1 * miss_of_one);
    }
  }
  const bool goes_on = holds_ && (cut_ || is_small_) && !exact_ && ++found_ < views_.size();
  if (goes_on) {  // others may err more at this tolerance
    holds_ = false;
    attempts_ = 0;
    bracket_ = {};
  }
  // Further attempts see the whole of this view: two views have no law of error together.
  fresh_ = !holds_ && (!goes_on || cut_);
  if (holds_) {
    cut_ = false;
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
