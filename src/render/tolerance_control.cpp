#include "render/tolerance_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace binosplat::render {

namespace {

// What the filter assumes. Variances are of natural logarithms: a deviation of 0.1 is 0.43 dB.
constexpr double level_variance = 4.0;     // of the error at the first guess of a tolerance
constexpr double exponent_variance = 1.0;  // of ThresholdRule::slope
constexpr double exponent_min = 0.7;
constexpr double change_variance = 0.25;   // per square of a change: the exponent depends on the tolerance
constexpr double drift = 0.012;            // per motion of the length of a camera cut
constexpr double drift_at_rest = 0.00002;  // per frame
constexpr double between_views = 0.25;     // the part of a variance that differs between views
constexpr double probe_variance = 0.0005;  // of a probe, besides the variance that its tiles show
constexpr double contradiction = 3.0;      // deviations: a probe farther off shows that the scene has changed

// What frames do. The margin is the distance in deviations from the expected error to the requested one.
constexpr double margin = 2.0;
constexpr double max_deviation = 0.12;                  // a frame of which less is known is exact
constexpr double deviation_probed = 0.07;               // a frame of which less is known has a probe
constexpr int probe_every = 8, probe_every_exact = 30;  // frames, at least
constexpr double deviation_of_probe = 0.1;              // at most, by the unevenness of the probe before
constexpr double share_of_probe_min = 1.0 / 25.0, share_of_probe_max = 1.0 / 9.0;  // of the view's tiles
constexpr double step_up = 0.2;      // the largest rise of the tolerance's logarithm between frames
constexpr double step_unsure = 3.5;  // the same in either direction while frames are exact
constexpr double range = 12.0;  // how far that logarithm may be from its first guess, as in an empty view

// Costs on an NVIDIA H200, in pairs of the exact blend (README.md has the measurements).
constexpr double pair_cost = 1.03, tile_cost = 24.0, exact_tile_cost = 20.0, gaussian_cost = 1.5;
constexpr double probes_per_frame = 0.25;  // about, while the head moves
constexpr double max_cost = 0.93;  // share of the exact cost below which a tolerance pays, with its probes
constexpr double cost_hysteresis = 0.03;  // more than that after a frame with a tolerance
constexpr double min_kept = 0.4;          // share of the pairs that are kept, while it is unknown
constexpr double near_target = 1.5;  // a probe whose error is this near to the requested one tells that share

// Exact pairs per tile above which AdaGScale is faster at 40 dB than `squared`, and below which `squared` is
// chosen again. In long lists many faint Gaussians lie behind one another, and their errors, which `squared`
// takes for independent, add up (docs/method.md 8.4).
constexpr double long_list = 1000.0, short_list = 800.0;

double tiles_of(const shared::View& view) {
  constexpr double side = TILE_SIZE;
  return std::ceil(view.width / side) * std::ceil(view.height / side);
}

double tiles_of(std::span<const shared::View> views) {
  double tiles = 0.0;
  for (const shared::View& view : views) tiles += tiles_of(view);
  return tiles;
}

// Smaller pictures have smaller Gaussians, so the tolerance falls faster than the focal length: with
// `squared` and `last`, fox needed 0.148 at a focal length of 690 px and 0.027 at 160 px.
double careful_tolerance_at_40_db(const FrameSettings& s, double focal) {
  return rule_of(*s.threshold).starting_tolerance * std::pow(std::min(1.0, focal / 700.0), 1.75);
}

double log_error(double db) { return -0.1 * std::numbers::ln10 * db; }

}  // namespace

void ToleranceControl::start(const FrameSettings& settings, std::size_t views, double focal) {
  const double exponent = rule_of(*settings.threshold).slope;
  log_tolerance_ = std::log(careful_tolerance_at_40_db(settings, focal)) +
                   (log_error(*settings.quality) - log_error(40.0)) / exponent;
  mean_.assign(views + 1, log_error(*settings.quality));
  mean_.back() = exponent;
  covariance_.assign(mean_.size() * mean_.size(), 0.0);
  covariance(views, views) = exponent_variance;
  forget();
}

// Forgets the errors, but not the tolerance and the exponent.
void ToleranceControl::forget() {
  for (std::size_t a = 0; a < view_count(); ++a)
    for (std::size_t b = 0; b < mean_.size(); ++b) covariance(a, b) = covariance(b, a) = 0.0;
  add_variance(level_variance);
  frames_ = unsure_probes_ = 0;
}

// Makes the errors less certain.
void ToleranceControl::add_variance(double variance) {
  for (std::size_t a = 0; a < view_count(); ++a)
    for (std::size_t b = 0; b < view_count(); ++b)
      covariance(a, b) += variance * (a == b ? 1.0 : 1.0 - between_views);
}

void ToleranceControl::set_tolerance(double log_tolerance) {
  const std::size_t exponent = view_count();
  const double change = log_tolerance - log_tolerance_;
  log_tolerance_ = log_tolerance;
  for (std::size_t v = 0; v < exponent; ++v) mean_[v] += change * mean_[exponent];
  for (std::size_t v = 0; v < exponent; ++v)
    for (std::size_t b = 0; b <= exponent; ++b) covariance(v, b) += change * covariance(exponent, b);
  for (std::size_t v = 0; v < exponent; ++v)
    for (std::size_t b = 0; b <= exponent; ++b) covariance(b, v) += change * covariance(b, exponent);
  add_variance(change_variance * change * change);
}

double ToleranceControl::deviation(std::size_t view) const {
  return std::sqrt(std::max(0.0, covariance_[view * mean_.size() + view]));
}

double ToleranceControl::largest_deviation() const {
  double most = 0.0;
  for (std::size_t v = 0; v < view_count(); ++v) most = std::max(most, deviation(v));
  return most;
}

// By how much the worst view's error and its margin exceed the target.
double ToleranceControl::excess_error(double target) const {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < view_count(); ++v)
    most = std::max(most, mean_[v] + margin * std::min(deviation(v), max_deviation) - target);
  return most;
}

// Whether a tolerance saves enough, by the pairs of the last frame and those of the last probe.
bool ToleranceControl::pays(std::span<const shared::View> views, double kept, double limit) const {
  if (exact_pairs_ < 0.0) return true;  // no frame was drawn yet
  const double tiles = tiles_of(views);
  const double exact = exact_pairs_ + exact_tile_cost * tiles + gaussian_cost * gaussians_;
  const double approximate = pair_cost * kept * exact_pairs_ + tile_cost * tiles +
                             gaussian_cost * gaussians_ + probes_per_frame * probe_share_ * exact;
  return approximate < limit * exact;
}

Probe ToleranceControl::next_probe(std::span<const shared::View> views, const FrameSettings& settings) {
  const auto count = static_cast<std::uint32_t>(views.size());
  Probe probe{.view = next_probe_ % count, .step = 2};
  const double all = tiles_of(views[probe.view]);
  const double even = unevenness_ / (deviation_of_probe * deviation_of_probe);
  const double wanted = std::max(static_cast<double>(settings.probe_tiles),
                                 std::clamp(even, all * share_of_probe_min, all * share_of_probe_max));
  while ((probe.step + 1.0) * (probe.step + 1.0) * wanted <= all) ++probe.step;
  // The golden ratio spreads the offsets of successive probes evenly.
  const std::uint32_t places = probe.step * probe.step;
  probe_share_ = 1.0 / (count * static_cast<double>(places));
  std::uint32_t stride = std::max(1u, static_cast<std::uint32_t>(std::lround(0.618 * places)));
  while (std::gcd(stride, places) != 1) ++stride;
  const std::uint32_t place = next_probe_++ / count * stride % places;
  // A narrow view may have fewer tiles along an axis than the step.
  const auto last = [](std::uint32_t pixels) { return (pixels - 1) / TILE_SIZE; };
  probe.column = std::min(place % probe.step, last(views[probe.view].width));
  probe.row = std::min(place / probe.step, last(views[probe.view].height));
  return probe;
}

Threshold ToleranceControl::rule(std::span<const shared::View> views, const FrameSettings& settings) const {
  if (settings.threshold) return *settings.threshold;
  const double least = settings_.threshold == Threshold::adagscale ? short_list : long_list;
  return exact_pairs_ > least * tiles_of(views) ? Threshold::adagscale : Threshold::squared;
}

ToleranceControl::Choice ToleranceControl::choose(std::span<const shared::View> views,
                                                  const FrameSettings& requested, double motion) {
  FrameSettings settings = requested;
  settings.threshold = rule(views, requested);
  const double limit = choice_.exact == ExactReason::not_exact ? max_cost + cost_hysteresis : max_cost;
  choice_ = {.threshold = *settings.threshold};
  double fewest = std::numeric_limits<double>::infinity();
  for (const shared::View& view : views) fewest = std::min(fewest, tiles_of(view));
  if (fewest < 4.0 * settings.probe_tiles) {
    choice_.exact = ExactReason::small;
    return choice_;
  }
  const FrameSettings& s = settings_;
  if (views.size() != view_count() || settings.threshold != s.threshold ||
      settings.transmittance != s.transmittance || !s.quality)
    start(settings, views.size(), views.front().lens.y);
  settings_ = std::move(settings);
  if (motion > 1.0) forget();
  if (motion <= 1.0) add_variance(motion * drift + drift_at_rest);
  const bool is_sure = largest_deviation() < max_deviation;
  const double change = -excess_error(log_error(*s.quality)) / std::max(1.0, mean_.back());
  const bool gains = pays(views, kept_ > 0.0 ? kept_ : min_kept, limit);
  const bool may_gain = gains || pays(views, min_kept, limit);
  // While a sample after the other leaves it unsure, they become rarer.
  const int wait = !gains ? probe_every_exact : is_sure ? probe_every : 1 + unsure_probes_ / 4;
  const bool is_due = ++since_probe_ >= wait && may_gain;
  if (frames_ > 0 && (gains || is_due)) {
    const double step = std::clamp(change, -step_unsure, is_sure ? step_up : step_unsure);
    const double first = std::log(careful_tolerance_at_40_db(s, views.front().lens.y));
    set_tolerance(std::clamp(log_tolerance_ + step, first - range, first + range));
  }
  const double deviation = largest_deviation();
  choice_.exact = !gains                      ? ExactReason::no_gain
                  : deviation > max_deviation ? ExactReason::unmeasured
                                              : ExactReason::not_exact;
  choice_.tolerance = static_cast<float>(std::exp(log_tolerance_));
  if (frames_++ > 0 && (is_due || (is_sure && gains && deviation > deviation_probed))) {
    choice_.probe = next_probe(views, s);
    since_probe_ = 0;
    unsure_probes_ = is_sure ? 0 : std::min(unsure_probes_ + 1, 4 * probe_every_exact);
  }
  return choice_;
}

void ToleranceControl::drew(double pairs, double gaussians) {
  gaussians_ = gaussians;
  if (choice_.exact != ExactReason::not_exact)
    exact_pairs_ = pairs;
  else if (kept_ > 0.0)
    exact_pairs_ = pairs / kept_;
}

void ToleranceControl::measured(const ProbeResult& probe) {
  const std::size_t view = choice_.probe->view;
  // Tiles without any error, such as a sky, say little about the others.
  const bool is_none = probe.squared_error <= 0.0;
  const double error = is_none ? log_error(*settings_.quality + 30.0) : std::log(probe.squared_error);
  const double variance = is_none ? level_variance : probe_variance + probe.unevenness / probe.tiles;
  const bool is_near = std::abs(error - log_error(*settings_.quality)) < near_target;
  kept_ = is_near && probe.exact_pairs > 0.0 ? probe.pairs / probe.exact_pairs : 0.0;
  const double off = error - mean_[view];
  unevenness_ = probe.unevenness;
  if (off * off > contradiction * contradiction * (covariance(view, view) + variance)) {
    add_variance(off * off);
    covariance(view_count(), view_count()) += exponent_variance;
  }
  std::vector<double> gain(mean_.size()), row(mean_.size());
  for (std::size_t a = 0; a < mean_.size(); ++a) {
    row[a] = covariance(view, a);
    gain[a] = row[a] / (covariance(view, view) + variance);
  }
  for (std::size_t a = 0; a < mean_.size(); ++a) {
    mean_[a] += gain[a] * off;
    for (std::size_t b = 0; b < mean_.size(); ++b) covariance(a, b) -= gain[a] * row[b];
  }
  mean_.back() = std::max(mean_.back(), exponent_min);
}

double ToleranceControl::quality() const {
  if (choice_.exact != ExactReason::not_exact) return std::numeric_limits<double>::infinity();
  return -10.0 / std::numbers::ln10 * *std::max_element(mean_.begin(), mean_.end() - 1);
}

}  // namespace binosplat::render
