#include "render/loss_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binosplat::render {

namespace {

// A sample's weight after each further frame: what was seen 20 frames ago counts for a third.
constexpr double fading = 0.95;
// Before anything is measured, so many strips at the target; their weight falls faster.
constexpr double start_weight = 2.0;
constexpr double start_fading = 0.5;
constexpr double step = 4.0 / 3.0;
constexpr double loss_min = 1e-9, loss_max = 1e9;

double target_of(const FrameSettings& s) { return std::pow(10.0, -0.1 * s.quality); }

// METHOD 8: losses that gave 40 dB or a little more on every shared scene at a focal length of 700 px. In
// smaller pictures Gaussians are smaller, too, and fox asked for 0.027 (squared, last) at 160 px: less than
// in proportion.
double careful_loss_at_40_db(const FrameSettings& s, double focal) {
  const double smaller = std::pow(std::min(1.0, focal / 700.0), 1.75);
  if (s.th == TH_PERIPHERAL) return 1.0 * smaller;
  if (s.contrast == CONTRAST_FINAL) return 0.006 * smaller;
  return (s.contrast == CONTRAST_BEHIND ? 0.008 : 0.1) * smaller;
}

}  // namespace

void LossControl::reset(const FrameSettings& settings) {
  settings_ = settings;
  power_ = settings.th == TH_PERIPHERAL ? 2.0 : 1.3;
  loss_ = careful_loss_at_40_db(settings, focal_) * std::pow(10.0, -0.1 * (settings.quality - 40.0) / power_);
}

Probe LossControl::next_probe(std::span<const shared::View> views, const FrameSettings& settings) {
  const std::uint32_t view = next_ % static_cast<std::uint32_t>(views.size());
  focal_ = views[view].lens.y;
  const std::uint32_t height = views[view].height;
  const auto strips = std::min(static_cast<std::uint32_t>(settings.probe_strips), height);
  const std::uint32_t rows = (height + strips - 1) / strips;
  const std::uint32_t count = (height + rows - 1) / rows;
  // A golden step, so that the first few strips lie all over the picture.
  std::uint32_t stride = std::max(1u, static_cast<std::uint32_t>(std::lround(0.618 * count)));
  while (std::gcd(stride, count) != 1) ++stride;
  const std::uint32_t strip = next_ / static_cast<std::uint32_t>(views.size()) * stride % count;
  const std::size_t all = views.size() * static_cast<std::size_t>(settings.probe_strips);
  if (samples_.size() != all) {
    samples_.assign(all, {});
    fresh_ = true;
  }
  probed_ = view * static_cast<std::size_t>(settings.probe_strips) + strip;
  ++next_;
  return {view, strip * rows, std::min(rows, height - strip * rows)};
}

double LossControl::error_at_one() const {
  double sum = start_.weight * start_.error_at_one, weight = start_.weight;
  for (const Sample& sample : samples_) {
    sum += sample.weight * sample.error_at_one;
    weight += sample.weight;
  }
  return sum / weight;
}

float LossControl::next_loss(const FrameSettings& settings, bool cut) {
  const bool other = settings.quality != settings_.quality || settings.th != settings_.th ||
                     settings.contrast != settings_.contrast ||
                     settings.transmittance != settings_.transmittance;
  if (other || loss_ == 0.0) reset(settings);
  if (other || cut || fresh_) {
    for (Sample& sample : samples_) sample.weight = 0.0;
    fresh_ = false;
    start_ = {target_of(settings) / std::pow(loss_, power_), start_weight};
  }
  const double wanted = std::pow(target_of(settings) / std::max(error_at_one(), 1e-30), 1.0 / power_);
  loss_ = std::clamp(std::clamp(wanted, loss_ / step, loss_ * step), loss_min, loss_max);
  return static_cast<float>(loss_);
}

void LossControl::measured(double squared_error) {
  for (Sample& sample : samples_) sample.weight *= fading;
  start_.weight *= start_fading;
  samples_[probed_] = {squared_error / std::pow(loss_, power_), 1.0};
}

double LossControl::quality() const {
  const double error = error_at_one() * std::pow(loss_, power_);
  return error > 0.0 ? -10.0 * std::log10(error) : std::numeric_limits<double>::infinity();
}

}  // namespace binosplat::render
