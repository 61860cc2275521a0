#pragma once
// View regions: the drawn part of each view, and its share of the tolerance.

#include <binosplat/settings.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::render {

struct FrameSettings;

static_assert(binosplat::ViewRegion::tile == TILE_SIZE);

/// The library's region, of a window of the view's picture. Its numbers count from the window's corner.
/// Regions do not change the order groups.
struct ViewRegion : binosplat::ViewRegion {
  /// px. Only the window is drawn and stored, with the same bits as in the whole picture. Corner and size are
  /// multiples of BLEND_CELL px, or the window ends at the picture's edge. A size of 0 also reaches the edge.
  /// Not for Scaffold-GS models, where a window would decode other Gaussians than the whole picture.
  glm::uvec2 corner{0}, size{0};

  bool is_window() const { return corner != glm::uvec2(0) || size != glm::uvec2(0); }
  /// Whether the region equals the whole view, apart from its tolerance.
  bool is_whole() const {
    return !is_window() && columns.empty() && hole_begin == hole_end && low_pass_share == 1.0f;
  }
};

/// Throws Error if there are regions, but not one for each of the `views`, and for regions that contradict
/// the settings.
void check_regions(const FrameSettings& settings, std::size_t views, bool is_scaffold);

/// Reduces a view to its window, if it has one. Throws Error for a window outside the picture, or with an
/// edge inside a cell.
void take_window(const ViewRegion& region, shared::View& view);

/// Throws Error, which names the nth view, for rows, columns and a hole outside a picture of `size` px.
void check_region(const ViewRegion& region, std::uint32_t nth, const glm::uvec2& size);

/// The rows of a view's tiles as shaders read them (tiles/regions.glsl), padded to whole supertiles. A
/// probe's first column and row are `first`, and its step is `step`. The region must be valid.
std::vector<glm::uvec2> region_rows(const ViewRegion& region, const shared::View& view,
                                    const glm::uvec2& first = glm::uvec2(0), std::uint32_t step = 1);

}  // namespace binosplat::render
