#include "lab/contributions.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/statistics.h"
#include "lab/settings.h"
#include "measure/comparison.h"
#include "reference/render.h"

namespace binosplat::lab {

namespace {

constexpr std::array skipped_shares = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
constexpr std::array known = {"alpha T", "alpha max(T)", "alpha T_upper(depth)", "alpha"};
constexpr std::size_t depth_bins = 40;

/// A Gaussian that a pixel of a view blends.
struct ShownGaussian {
  double depth;          // world units
  double transmittance;  // max(T)
};

double bound_at(const DepthTable& table, double depth) {
  const auto bins = static_cast<double>(table.bounds.size());
  const double bin = depth / static_cast<double>(table.far) * bins;
  if (!(bin >= 0.0) || bin >= bins) return 1.0;
  const float bound = table.bounds[static_cast<std::size_t>(bin)];
  return bound > 0.0f ? static_cast<double>(bound) : 1.0;
}

/// What each of `known` takes for the transmittance bounds of the Gaussians; empty for what each pixel truly
/// sees.
std::array<std::vector<double>, known.size()> bounds_by(const std::vector<reference::Splat>& splats,
                                                        const std::vector<double>& largest,
                                                        const DepthTable& table) {
  std::array<std::vector<double>, known.size()> bounds;
  bounds[1] = largest;
  for (const reference::Splat& splat : splats) bounds[2].push_back(bound_at(table, splat.depth));
  bounds[3].assign(splats.size(), 1.0);
  return bounds;
}

Spread spread(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {quantile(values, 0.5), quantile(values, 0.9), quantile(values, 1.0)};
}

std::vector<DepthBin> bins_by_depth(const std::vector<ShownGaussian>& shown, const DepthTable& table) {
  std::vector<DepthBin> bins;
  if (shown.empty()) return bins;
  std::vector<double> depths;
  for (const ShownGaussian& one : shown) depths.push_back(one.depth);
  const double far = quantile(depths, 0.95), width = far / depth_bins;
  std::array<std::vector<double>, depth_bins> transmittance;
  for (const ShownGaussian& one : shown) {
    if (one.depth > far) continue;
    const auto b = std::min<std::size_t>(static_cast<std::size_t>(one.depth / width), depth_bins - 1);
    transmittance[b].push_back(one.transmittance);
  }
  for (std::size_t b = 0; b < depth_bins; ++b) {
    const double from = width * static_cast<double>(b);
    bins.push_back({from, from + width, transmittance[b].size(), spread(transmittance[b]),
                    bound_at(table, from + 0.5 * width)});
  }
  return bins;
}

double capped(double db) { return std::min(db, equal_db); }

}  // namespace

Contributions contributions(const Model& model, std::span<const ContributionView> views,
                            const DepthTable& table, const DepthTable& fitted,
                            const std::function<void()>& progress) {
  Contributions found;
  for (const char* by : known)
    found.skipping.push_back({by, std::vector<SkippingCurve::Point>(skipped_shares.size())});
  std::vector<ShownGaussian> shown;
  const auto count = static_cast<double>(views.size());
  const bool photos =
      std::all_of(views.begin(), views.end(), [](const ContributionView& v) { return v.photo; });
  for (const ContributionView& one : views) {
    const auto splats = reference::project_all(model, one.view);
    const auto lists = reference::make_lists(splats, reference::depth_order(splats), one.view, TILES_ELLIPSE);
    const auto transmittance = reference::measure_transmittance(splats, lists, one.view);
    auto by_distance = reference::contributions_by_distance(splats, lists, one.view);
    if (!found.by_distance.empty()) reference::add(by_distance, found.by_distance);
    found.by_distance = std::move(by_distance);
    for (std::size_t i = 0; i < splats.size(); ++i) {
      if (transmittance[i] > 0.0) shown.push_back({splats[i].depth, transmittance[i]});
    }
    const Image exact = on_black(reference::blend(splats, lists, one.view));
    const auto bounds = bounds_by(splats, transmittance, table);
    for (std::size_t by = 0; by < known.size(); ++by) {
      const auto skipped = reference::skip_lowest(splats, lists, one.view, bounds[by], skipped_shares);
      for (std::size_t k = 0; k < skipped_shares.size(); ++k) {
        const Image image = on_black(skipped[k].picture);
        SkippingCurve::Point& mean = found.skipping[by].points[k];
        mean.share += skipped[k].share / count;
        mean.psnr_db += capped(measure::psnr(image, exact)) / count;
        if (photos)
          mean.drop_db = mean.drop_db.value_or(0.0) + (measure::photo_psnr(exact, one.exposure, *one.photo) -
                                                       measure::photo_psnr(image, one.exposure, *one.photo)) /
                                                          count;
      }
    }
    progress();
  }
  while (!found.by_distance.empty() && found.by_distance.back().fragments == 0) found.by_distance.pop_back();
  found.by_depth = bins_by_depth(shown, fitted);
  return found;
}

}  // namespace binosplat::lab
