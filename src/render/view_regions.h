#pragma once
// View regions: the drawn part of each view, and its share of the tolerance.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "shared/types.h"

namespace binosplat::render {

struct FrameSettings;

/// The drawn part of a view, and its accuracy. By default the whole view is drawn, as the frame's settings
/// request. Regions do not change the order groups.
struct ViewRegion {
  /// px. A window of the view's picture: only the window is drawn and stored, with the same bits as in the
  /// whole picture. Corner and size are multiples of BLEND_CELL px, or the window ends at the picture's edge.
  /// A size of 0 also reaches the edge. Not for Scaffold-GS models, where a window would decode other
  /// Gaussians than the whole picture.
  glm::uvec2 corner{0}, size{0};
  /// For each row of tiles, the range [x, y) of tile columns to draw; empty: all. Other tiles, such as those
  /// that no lens shows, get no splat-tile pairs: C = 0 and T = 1. Tiles are counted from
  /// the window's corner.
  std::vector<glm::uvec2> columns;
  /// px from the window's corner. Tiles inside the rectangle [hole_begin, hole_end) are not drawn.
  glm::uvec2 hole_begin{0}, hole_end{0};
  float tolerance_share = 1.0f;  // the view's tolerance divided by the frame's; 0: exact
  /// For a picture with fewer pixels than another picture of the same view: the ratio of their numbers of
  /// pixels, below 1. The low-pass has the same width in px in both pictures, so thin Gaussians would be
  /// wider and brighter in the smaller picture. This factor removes the weight that they gain. Anti-aliased
  /// models ignore it, because their Gaussians gain no weight.
  float low_pass_share = 1.0f;

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
