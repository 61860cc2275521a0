#include "reference/blend.h"

#include <algorithm>

#include "base/parallel.h"
#include "reference/blend_pixel.h"

namespace binosplat::reference {

namespace {

/// Blends all pixels of a tile into the picture.
BlendCounts blend_tile(const std::vector<Splat>& splats, const TileLists& lists, std::uint32_t tx,
                       std::uint32_t ty, Faults faults, Picture& picture) {
  const std::span<const std::uint32_t> list = lists.tile(tx, ty);
  const int size = static_cast<int>(lists.tile_size);
  const int left = static_cast<int>(tx) * size, right = std::min(left + size, picture.width);
  const int top = static_cast<int>(ty) * size, bottom = std::min(top + size, picture.height);
  BlendCounts counts;
  std::uint64_t walked_by_tile = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      std::uint64_t walked = 0;
      const auto count = [&](std::uint32_t, double, const PixelSum&, Verdict verdict) {
        ++walked;
        if (verdict == Verdict::blended) ++counts.visible;
      };
      const PixelSum sum = blend_pixel(splats, list, x, y, faults, count);
      const std::size_t pixel = static_cast<std::size_t>(y) * picture.width + x;
      picture.colour[pixel] = glm::vec4(glm::dvec4(sum.colour, sum.transmittance));
      picture.z_sum[pixel] = static_cast<float>(sum.z_sum);
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
  Picture picture(static_cast<int>(view.width), static_cast<int>(view.height));
  std::vector<BlendCounts> of_tiles(lists.begin.size() - 1);
  parallel_for(of_tiles.size(), [&](std::size_t t) {
    const auto tx = static_cast<std::uint32_t>(t % lists.tiles_x),
               ty = static_cast<std::uint32_t>(t / lists.tiles_x);
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
