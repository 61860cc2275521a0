#include "reference/blend.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "reference/blend_pixel.h"

namespace binosplat::reference {

namespace {

void put(const PixelSum& sum, int x, int y, Picture& picture) {
  const std::size_t pixel = static_cast<std::size_t>(y) * picture.width + x;
  picture.colour[pixel] = glm::vec4(glm::dvec4(sum.colour, sum.transmittance));
  picture.z_sum[pixel] = static_cast<float>(sum.z_sum);
}

double mesh_at(const TileLists& lists, int width, const glm::ivec2& pixel) {
  if (lists.mesh_depths.empty()) return PixelSum{}.farthest;
  return lists.mesh_depths[static_cast<std::size_t>(pixel.y) * width + pixel.x];
}

/// Blends the pixels [first, end) of a block approximately. Once the block is dark, scales each pixel's
/// colour and Z to full coverage (T = 0).
void blend_block(const std::vector<Splat>& splats, std::span<const std::uint32_t> list,
                 const TileLists& lists, const glm::ivec2& first, const glm::ivec2& end, Picture& picture) {
  const Approximation& approximation = lists.approximation;
  const std::size_t step = list.size() > LONG_LIST ? APPROXIMATE_STEP_LONG : APPROXIMATE_STEP_SHORT;
  struct Pixel {
    glm::ivec2 at;
    PixelSum sum;
    bool ended = false;
  };
  std::vector<Pixel> pixels;
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x)
      pixels.push_back({{x, y}, {.farthest = mesh_at(lists, picture.width, {x, y})}, false});
  }
  for (std::size_t from = 0; from < list.size(); from += step) {
    std::vector<std::uint32_t> some;
    for (const std::uint32_t i : list.subspan(from, std::min(step, list.size() - from))) {
      if (!approximation.by_blocks || reaches_block(splats[i], first.x, first.y)) some.push_back(i);
    }
    bool is_dark = true;
    for (Pixel& p : pixels) {
      const auto ignore = [](auto&&...) {};
      p.ended = p.ended || blend_on(p.sum, splats, some, p.at, {}, ignore);
      is_dark = is_dark && (p.ended || p.sum.transmittance <= approximation.dark_transmittance);
    }
    if (!is_dark || !(approximation.dark_transmittance > 0.0) || from + step >= list.size()) continue;
    for (Pixel& p : pixels) {
      if (p.ended) continue;
      const double cover = 1.0 - p.sum.transmittance;
      p.sum = {p.sum.colour / cover, p.sum.z_sum / cover, 0.0};
    }
    break;
  }
  for (const Pixel& p : pixels) put(p.sum, p.at.x, p.at.y, picture);
}

void blend_tile_approximately(const std::vector<Splat>& splats, const TileLists& lists, std::uint32_t tx,
                              std::uint32_t ty, Picture& picture) {
  const std::span<const std::uint32_t> list = lists.tile(tx, ty);
  const int rows = list.size() > LONG_LIST ? APPROXIMATE_BLOCK / 2 : APPROXIMATE_BLOCK;
  const glm::ivec2 tile = glm::ivec2(tx, ty) * TILE_SIZE;
  const glm::ivec2 tile_end = glm::min(tile + TILE_SIZE, glm::ivec2(picture.width, picture.height));
  for (int y = tile.y; y < tile_end.y; y += rows) {
    for (int x = tile.x; x < tile_end.x; x += APPROXIMATE_BLOCK)
      blend_block(splats, list, lists, {x, y},
                  glm::min(glm::ivec2(x + APPROXIMATE_BLOCK, y + rows), tile_end), picture);
  }
}

BlendCounts blend_tile(const std::vector<Splat>& splats, const TileLists& lists, std::uint32_t tx,
                       std::uint32_t ty, Faults faults, Picture& picture) {
  const std::span<const std::uint32_t> list = lists.tile(tx, ty);
  const int left = static_cast<int>(tx) * TILE_SIZE, right = std::min(left + TILE_SIZE, picture.width);
  const int top = static_cast<int>(ty) * TILE_SIZE, bottom = std::min(top + TILE_SIZE, picture.height);
  BlendCounts counts;
  std::uint64_t walked_by_tile = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      std::uint64_t walked = 0;
      const auto count = [&](std::uint32_t, double, const PixelSum&, Verdict verdict) {
        ++walked;
        if (verdict == Verdict::blended) ++counts.visible;
      };
      PixelSum sum{.farthest = mesh_at(lists, picture.width, {x, y})};
      blend_on(sum, splats, list, {x, y}, faults, count);
      put(sum, x, y, picture);
      walked_by_tile = std::max(walked_by_tile, walked);
    }
  }
  counts.evaluated =
      walked_by_tile * static_cast<std::uint64_t>(right - left) * static_cast<std::uint64_t>(bottom - top);
  return counts;
}

}  // namespace

Picture blend(const std::vector<Splat>& splats, const TileLists& lists, const shared::View& view,
              Faults faults, BlendCounts* counts) {
  if (lists.approximation.any() && (faults.stop_late || counts != nullptr))
    fail("faults and counts need an exact blend");
  Picture picture(static_cast<int>(view.width), static_cast<int>(view.height));
  std::vector<BlendCounts> of_tiles(lists.begin.size() - 1);
  parallel_for(of_tiles.size(), [&](std::size_t t) {
    const auto tx = static_cast<std::uint32_t>(t % lists.tiles_x),
               ty = static_cast<std::uint32_t>(t / lists.tiles_x);
    if (lists.approximation.any())
      blend_tile_approximately(splats, lists, tx, ty, picture);
    else
      of_tiles[t] = blend_tile(splats, lists, tx, ty, faults, picture);
  });
  if (counts != nullptr) {
    *counts = {};
    for (const BlendCounts& tile : of_tiles) {
      counts->evaluated += tile.evaluated;
      counts->visible += tile.visible;
    }
  }
  return picture;
}

}  // namespace binosplat::reference
