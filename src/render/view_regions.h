#pragma once
// Regions of views: what need not be drawn, and which views may be less exact than others.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "shared/types.h"

namespace binosplat::render {

struct FrameSettings;

/// What is drawn of a view, and how exactly. By default all of it, as the frame's settings say. Regions do
/// not change which views are projected together.
struct ViewRegion {
  /// px. A window of the view's picture: it alone is drawn and kept, its pixels equal to the whole picture's
  /// to the bit. Corner and size are multiples of BLEND_CELL px, or reach to the picture's edge. A size of 0
  /// reaches there, too. A window has the whole picture's Gaussians only where models are not Scaffold-GS.
  glm::uvec2 corner{0}, size{0};
  /// For each row of tiles, the columns [x, y) of those that are drawn. Nothing is paired with other tiles,
  /// such as those that no lens shows; their pixels have C = 0 and T = 1. Tiles are of settings.tile_size px,
  /// counted from the window's corner. Empty: all are drawn.
  std::vector<glm::uvec2> columns;
  /// px from the window's corner. Tiles that lie within [hole_begin, hole_end) are not drawn, either.
  glm::uvec2 hole_begin{0}, hole_end{0};
  /// The view's tolerance over the frame's; 0: the view is exact.
  float tolerance_share = 1.0f;
  /// For a picture with fewer pixels than the one it stands for: (its pixels along an axis / the other's)
  /// squared, below 1. The low-pass is as many px wide in every picture, so that thin Gaussians would be
  /// fatter and brighter in the smaller one; so they lose as much weight as they gain area. It changes
  /// nothing of anti-aliased models, whose Gaussians lose that weight anyway.
  float low_pass_share = 1.0f;

  bool is_window() const { return corner != glm::uvec2(0) || size != glm::uvec2(0); }
  /// Whether all of the view is drawn, as it would be without a region but for the tolerance.
  bool is_whole() const {
    return !is_window() && columns.empty() && hole_begin == hole_end && low_pass_share == 1.0f;
  }
};

/// Throws Error for regions that are neither none nor one for each of the `views`, and for regions that do
/// not go with the settings.
void check_regions(const FrameSettings& settings, std::size_t views, bool is_scaffold);

/// Makes a view its window, where it is one. Throws Error for a window that lies beyond the picture or begins
/// or ends between cells.
void take_window(const ViewRegion& region, shared::View& view);

/// Throws Error, which names the nth view, for rows, columns and a hole that a picture of `size` px does not
/// have.
void check_region(const ViewRegion& region, std::uint32_t nth, const glm::uvec2& size, std::uint32_t tile);

/// The rows of a view's tiles as shaders read them (tiles/regions.glsl), filled up to whole supertiles;
/// `first` and `step` are a probe's column and row, and its step. The region must be right.
std::vector<glm::uvec2> region_rows(const ViewRegion& region, const shared::View& view, std::uint32_t tile,
                                    const glm::uvec2& first = glm::uvec2(0), std::uint32_t step = 1);

}  // namespace binosplat::render
