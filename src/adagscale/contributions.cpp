#include "adagscale/contributions.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/statistics.h"
#include "measure/comparison.h"
#include "measure/metrics.h"
#include "reference/adagscale_contributions.h"
#include "reference/adagscale_transmittance.h"
#include "reference/blend.h"
#include "scene/axes.h"

namespace binosplat::adagscale {

namespace {

constexpr std::array skipped_shares = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
constexpr std::array known = {"alpha T", "alpha max(T)", "alpha T_upper(depth)", "alpha",
                              "alpha T, of evaluated"};
constexpr std::size_t of_evaluated = 4;  // its shares are of what INRIA's renderer evaluates in its boxes
constexpr std::size_t depth_bins = 40;

/// A Gaussian that some pixel of a view blends.
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

/// For each formula of `known`, the transmittance that it assumes for each Gaussian; empty for those with the
/// true T of each pixel.
std::array<std::vector<double>, known.size()> bounds_by(const std::vector<reference::Splat>& splats,
                                                        const std::vector<double>& largest,
                                                        const DepthTable& table) {
  std::array<std::vector<double>, known.size()> bounds;
  bounds[1] = largest;
  for (const reference::Splat& splat : splats) bounds[2].push_back(bound_at(table, splat.depth));
  bounds[3].assign(splats.size(), 1.0);
  return bounds;
}

/// Appends a row for each bin of depth, with max(T) of its Gaussians. The last bin ends at the depth within
/// which 95 % of the Gaussians lie.
void add_by_depth(const std::vector<ShownGaussian>& shown, const DepthTable& table, std::vector<Row>& rows) {
  if (shown.empty()) return;
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
    Row& row = rows.emplace_back(Row{{"kind", "depth"},
                                     {"from", from},
                                     {"to", from + width},
                                     {"gaussians", transmittance[b].size()},
                                     {"upper", bound_at(table, from + 0.5 * width)}});
    if (transmittance[b].empty()) continue;
    for (const auto& [name, share] : {std::pair{"median", 0.5}, {"p90", 0.9}, {"largest", 1.0}})
      row[name] = quantile(transmittance[b], share);
  }
}

/// Appends a row for each bin of distance from the Gaussian's middle, with its fragments' contributions.
void add_by_distance(std::vector<reference::DistanceBin> bins, std::vector<Row>& rows) {
  while (!bins.empty() && bins.back().fragments == 0) bins.pop_back();
  double all = 0.0, nearer = 0.0;
  for (const reference::DistanceBin& bin : bins) all += bin.sum;
  for (const reference::DistanceBin& bin : bins) {
    nearer += bin.sum;
    rows.push_back({{"kind", "distance"},
                    {"from", bin.from},
                    {"to", bin.to},
                    {"fragments", bin.fragments},
                    {"mean", bin.sum / static_cast<double>(bin.fragments)},
                    {"largest", bin.largest},
                    {"nearer", 100.0 * nearer / all}});
  }
}

}  // namespace

std::vector<Row> contributions(const Model& model, std::span<const CalibrationView> views, double near_plane,
                               const DepthTable& table, const DepthTable& fitted) {
  std::array<std::array<std::vector<Row>, skipped_shares.size()>, known.size()> skipping;  // rows by view
  std::vector<reference::DistanceBin> distances;
  std::vector<ShownGaussian> shown;
  for (const CalibrationView& one : views) {
    const shared::View view = make_view(into_axes(one.camera, model.axes), near_plane);
    const auto splats = reference::project_all(model, view);
    const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
    const auto transmittance = reference::measure_transmittance(splats, lists, view);
    auto by_distance = reference::contributions_by_distance(splats, lists, view);
    if (!distances.empty()) reference::add(by_distance, distances);
    distances = std::move(by_distance);
    for (std::size_t i = 0; i < splats.size(); ++i) {
      if (transmittance[i] > 0.0) shown.push_back({splats[i].depth, transmittance[i]});
    }
    const auto boxes = reference::make_lists(splats, reference::depth_order(splats), view, TILES_AABB);
    const Image exact = on_black(reference::blend(splats, lists, view));
    const auto bounds = bounds_by(splats, transmittance, table);
    for (std::size_t by = 0; by < known.size(); ++by) {
      const auto skipped =
          by == of_evaluated
              ? reference::skip_lowest(splats, boxes, view, {}, skipped_shares, reference::Counted::evaluated)
              : reference::skip_lowest(splats, lists, view, bounds[by], skipped_shares);
      for (std::size_t k = 0; k < skipped_shares.size(); ++k) {
        const Image image = on_black(skipped[k].picture);
        Row& row = skipping[by][k].emplace_back(
            Row{{"skipped", 100.0 * skipped[k].share},
                {"fragments", skipped[k].fragments},
                {"psnr_db", std::min(measure::equal_db, measure::psnr(image, exact))}});
        if (one.photo)
          row["drop_db"] = measure::photo_psnr(exact, one.exposure, *one.photo) -
                           measure::photo_psnr(image, one.exposure, *one.photo);
      }
    }
  }
  std::vector<Row> rows;
  for (std::size_t by = 0; by < known.size(); ++by) {
    for (const std::vector<Row>& of_views : skipping[by]) {
      Row& row = rows.emplace_back(Row{{"kind", "skipping"}, {"formula", known[by]}});
      for (const char* name : {"skipped", "fragments", "psnr_db", "drop_db"}) {
        std::vector<double> numbers;
        for (const Row& of_view : of_views) {
          if (of_view.contains(name)) numbers.push_back(of_view[name]);
        }
        if (!numbers.empty()) row[name] = mean(numbers);
      }
    }
  }
  add_by_distance(std::move(distances), rows);
  add_by_depth(shown, fitted, rows);
  return rows;
}

}  // namespace binosplat::adagscale
