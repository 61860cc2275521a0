#include "reference/adagscale_contributions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "reference/blend_pixel.h"

namespace binosplat::reference {

namespace {

// Scores are binned by their logarithm, down to 2^-40. 70 bins per octave are 1 % wide.
constexpr int bins_an_octave = 70, octaves = 40, bins = bins_an_octave * octaves;
using Histogram = std::array<std::uint64_t, bins>;

int bin_of(double score) {
  // Shifts the edges of bins away from powers of two: such scores are common, and differ by rounding.
  const double octave = std::log2(std::max(score, 1e-300)) + octaves - 0.25 / bins_an_octave;
  return std::clamp(static_cast<int>(octave * bins_an_octave), 0, bins - 1);
}

struct Fragment {
  std::uint32_t gaussian;
  double alpha;
  double score;  // alpha times the transmittance that BlendInput assumes
  int bin;       // bin_of(score)
};

/// A view's splats and lists of tiles, and the transmittance to assume for each Gaussian (empty: its true T).
struct BlendInput {
  const std::vector<Splat>& splats;
  const TileLists& lists;
  const shared::View& view;
  std::span<const double> transmittances;
  Counted counted = Counted::blended;
};

/// Calls visit(pixel, fragments) for every pixel of the tiles [begin, end), with its fragments front to back.
template <typename Visit>
void for_each_pixel(const BlendInput& input, std::size_t begin, std::size_t end, const Visit& visit) {
  const TileLists& lists = input.lists;
  const shared::View& view = input.view;
  for (std::size_t t = begin; t < end; ++t) {
    const auto tx = static_cast<std::uint32_t>(t % lists.tiles_x),
               ty = static_cast<std::uint32_t>(t / lists.tiles_x);
    const auto list = lists.tile(tx, ty);
    const std::uint32_t right = std::min((tx + 1) * TILE_SIZE, view.width),
                        bottom = std::min((ty + 1) * TILE_SIZE, view.height);
    std::vector<Fragment> fragments;
    for (std::uint32_t y = ty * TILE_SIZE; y < bottom; ++y) {
      for (std::uint32_t x = tx * TILE_SIZE; x < right; ++x) {
        fragments.clear();
        const auto keep = [&](std::uint32_t i, double alpha, const PixelSum& before, Verdict verdict) {
          if (verdict != Verdict::blended) alpha = 0.0;
          if (alpha == 0.0 && input.counted == Counted::blended) return;
          const double transmittance =
              input.transmittances.empty() ? before.transmittance : input.transmittances[i];
          const double score = alpha * transmittance;
          fragments.push_back({i, alpha, score, bin_of(score)});
        };
        blend_pixel(input.splats, list, {x, y}, {}, keep);
        visit(std::size_t{y} * view.width + x, fragments);
      }
    }
  }
}

// Distance bins: one below 1 px, then two per octave.
constexpr std::size_t distance_bins = 23;

std::size_t distance_bin(double px) {
  return px < 1.0 ? 0 : std::min(static_cast<std::size_t>(2.0 * std::log2(px)) + 1, distance_bins - 1);
}

}  // namespace

void add(std::vector<DistanceBin>& sums, const std::vector<DistanceBin>& more) {
  for (std::size_t b = 0; b < sums.size(); ++b) {
    sums[b].fragments += more[b].fragments;
    sums[b].sum += more[b].sum;
    sums[b].largest = std::max(sums[b].largest, more[b].largest);
  }
}

std::vector<DistanceBin> contributions_by_distance(const std::vector<Splat>& splats, const TileLists& lists,
                                                   const shared::View& view) {
  std::vector<DistanceBin> sums(distance_bins);
  for (std::size_t b = 0; b < distance_bins; ++b) {
    const double octave = 0.5 * static_cast<double>(b);
    sums[b].from = b == 0 ? 0.0 : std::exp2(octave - 0.5);
    sums[b].to = std::exp2(octave);
  }
  constexpr double unit = 0x1p-28;  // sums of multiples of `unit` are exact, in any order
  std::mutex adding;
  parallel_chunks(lists.begin.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<DistanceBin> found(distance_bins);
    for_each_pixel({splats, lists, view, {}}, begin, end,
                   [&](std::size_t pixel, const std::vector<Fragment>& fragments) {
                     const glm::dvec2 at(pixel % view.width, pixel / view.width);
                     for (const Fragment& fragment : fragments) {
                       DistanceBin& bin =
                           found[distance_bin(glm::distance(at, splats[fragment.gaussian].mean))];
                       ++bin.fragments;
                       bin.sum += std::round(fragment.score / unit) * unit;
                       bin.largest = std::max(bin.largest, fragment.score);
                     }
                   });
    const std::lock_guard lock(adding);
    add(sums, found);
  });
  return sums;
}

std::vector<Skipped> skip_lowest(const std::vector<Splat>& splats, const TileLists& lists,
                                 const shared::View& view, std::span<const double> bounds,
                                 std::span<const double> shares, Counted counted) {
  const BlendInput input{splats, lists, view, bounds, counted};
  const std::size_t tiles = lists.begin.size() - 1;
  std::array<std::uint64_t, bins + 1> below{};  // the number of fragments in lower bins
  std::mutex adding;
  parallel_chunks(tiles, 1, [&](std::size_t begin, std::size_t end) {
    Histogram counts{};
    const auto count = [&](std::size_t, const std::vector<Fragment>& fragments) {
      for (const Fragment& fragment : fragments) ++counts[static_cast<std::size_t>(fragment.bin)];
    };
    for_each_pixel(input, begin, end, count);
    const std::lock_guard lock(adding);
    for (std::size_t b = 0; b < bins; ++b) below[b + 1] += counts[b];
  });
  for (std::size_t b = 0; b < bins; ++b) below[b + 1] += below[b];

  const double all = static_cast<double>(std::max<std::uint64_t>(below[bins], 1));
  std::vector<Skipped> results;
  std::vector<int> kept_from;  // the lowest bin that is not skipped
  for (const double share : shares) {
    const auto end = std::upper_bound(below.begin(), below.end(), share * all,
                                      [](double most, std::uint64_t count) { return most < double(count); });
    kept_from.push_back(static_cast<int>(end - below.begin()) - 1);
    results.push_back({static_cast<double>(below[static_cast<std::size_t>(kept_from.back())]) / all,
                       below[bins], Picture(static_cast<int>(view.width), static_cast<int>(view.height))});
  }
  const auto blend = [&](std::size_t pixel, const std::vector<Fragment>& fragments) {
    const auto x = static_cast<int>(pixel % view.width), y = static_cast<int>(pixel / view.width);
    for (std::size_t k = 0; k < results.size(); ++k) {
      PixelSum sum;
      for (const Fragment& fragment : fragments) {
        if (fragment.bin < kept_from[k]) continue;
        const Splat& splat = splats[fragment.gaussian];
        add(sum, splat, z_at(splat, x, y), fragment.alpha);
      }
      results[k].picture.colour[pixel] = glm::vec4(glm::dvec4(sum.colour, sum.transmittance));
      results[k].picture.z_sum[pixel] = static_cast<float>(sum.z_sum);
    }
  };
  parallel_chunks(tiles, 1,
                  [&](std::size_t begin, std::size_t end) { for_each_pixel(input, begin, end, blend); });
  return results;
}

}  // namespace binosplat::reference
