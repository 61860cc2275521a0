#include "render/view_regions.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/frame_settings.h"

namespace binosplat::render {

namespace {

constexpr std::uint32_t tile = TILE_SIZE;

}  // namespace

void check_regions(const FrameSettings& settings, std::size_t views, bool is_scaffold) {
  const auto& regions = settings.regions;
  if (regions.empty()) return;
  if (regions.size() != views)
    fail("{} regions for {} views: expected none, or one per view", regions.size(), views);
  for (const ViewRegion& region : regions) {
    if (!(region.tolerance_share >= 0.0f) || !std::isfinite(region.tolerance_share))
      fail("tolerance_share {}: expected a number of 0 or more", region.tolerance_share);
    if (!(region.low_pass_share > 0.0f && region.low_pass_share <= 1.0f))
      fail("low_pass_share {}: expected a number above 0 and at most 1", region.low_pass_share);
    if (settings.quality && (region.is_window() || region.tolerance_share != 1.0f))
      fail("a quality excludes windows and a tolerance_share other than 1: set a tolerance instead");
    if (is_scaffold && region.is_window()) {
      fail(
          "a window of a Scaffold-GS model: its anchors are culled by the whole view, and a window would "
          "decode other Gaussians");
    }
  }
}

void take_window(const ViewRegion& region, shared::View& view) {
  if (!region.is_window()) return;
  const glm::uvec2 whole(view.width, view.height);
  for (int k = 0; k < 2; ++k) {
    const std::uint32_t begin = region.corner[k];
    const std::uint64_t end = region.size[k] == 0 ? whole[k] : std::uint64_t{begin} + region.size[k];
    if (begin >= end || end > whole[k] || begin % BLEND_CELL != 0 ||
        (end % BLEND_CELL != 0 && end != whole[k])) {
      fail(
          "a window of {} x {} px from ({}, {}) of {} x {} px: expected multiples of {} px within the "
          "picture, or up to its edge",
          region.size.x, region.size.y, region.corner.x, region.corner.y, whole.x, whole.y, BLEND_CELL);
    }
    (k == 0 ? view.left : view.top) = begin;
    (k == 0 ? view.width : view.height) = static_cast<std::uint32_t>(end) - begin;
  }
}

void check_region(const ViewRegion& region, std::uint32_t nth, const glm::uvec2& size) {
  const glm::uvec2 tiles = (size + tile - 1u) / tile;
  if (!region.columns.empty() && region.columns.size() != tiles.y) {
    fail("views[{}].region: columns for {} rows of tiles, but the view has {} (tiles of {} px)", nth,
         region.columns.size(), tiles.y, tile);
  }
  for (const glm::uvec2& columns : region.columns) {
    if (columns.x > columns.y || columns.y > tiles.x)
      fail("views[{}].region: columns {} to {} in a row of tiles, but the view has {}", nth, columns.x,
           columns.y, tiles.x);
  }
  if (glm::any(glm::greaterThan(region.hole_begin, region.hole_end)) ||
      glm::any(glm::greaterThan(region.hole_end, size)))
    fail("views[{}].region: a hole that does not lie in its view of {} x {} px", nth, size.x, size.y);
}

std::vector<glm::uvec2> region_rows(const ViewRegion& region, const shared::View& view,
                                    const glm::uvec2& first, std::uint32_t step) {
  const glm::uvec2 size(view.width, view.height);
  const glm::uvec2 tiles = (size + tile - 1u) / tile;
  // The tiles that lie completely in the hole; the picture's edge may clip the last of them.
  const glm::uvec2 hole_begin = (region.hole_begin + tile - 1u) / tile;
  const glm::uvec2 hole_end =
      glm::max(hole_begin, glm::mix(region.hole_end / tile, tiles, glm::equal(region.hole_end, size)));
  // Converts columns of the picture's tiles to columns of the view's tiles, because a probe skips tiles.
  const auto packed = [&](const glm::uvec2& columns) {
    const glm::uvec2 there = (glm::max(columns, first.x) - first.x + step - 1u) / step;
    return there.x | there.y << 16;
  };
  std::vector<glm::uvec2> rows((view.tiles_y + SUPERTILE_SIDE - 1) / SUPERTILE_SIDE * SUPERTILE_SIDE,
                               glm::uvec2(0));
  for (std::uint32_t n = 0; n < view.tiles_y; ++n) {
    const std::uint32_t row = first.y + n * step;
    const glm::uvec2 columns = region.columns.empty() ? glm::uvec2(0, tiles.x) : region.columns[row];
    const bool in_hole = row >= hole_begin.y && row < hole_end.y;
    rows[n] = {packed(columns), in_hole ? packed({hole_begin.x, hole_end.x}) : 0u};
  }
  return rows;
}

}  // namespace binosplat::render
