#pragma once
// Which tiles a splat is blended in, and the lists that follow (docs/method.md 4).

#include <cstdint>
#include <span>
#include <vector>

#include "reference/approximate.h"
#include "reference/project.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// Whether a cone may cut the picture in something else than an ellipse, at any level that can be seen
/// (docs/method.md 4).
bool is_wide(const Cone& cone);

/// q of a splat at a point of the picture (docs/method.md 2 and 3); infinite where a ray leaves it behind.
double squared_distance(const Splat& splat, const glm::dvec2& at);

/// Indices of what is drawn, nearest first; equal depths in the order of their indices.
std::vector<std::uint32_t> depth_order(const std::vector<Splat>& splats);

/// For each tile, row by row from the top, the Gaussians that it blends, nearest first.
struct TileLists {
  std::uint32_t tiles_x = 0;
  std::uint32_t tiles_y = 0;
  std::uint32_t tile_size = 0;  // px
  std::vector<std::uint32_t>
      begin;  // tiles + 1: tile t owns gaussians[begin[t]] up to gaussians[begin[t + 1]]
  std::vector<std::uint32_t> gaussians;  // indices into the model
  Approximation approximation;           // with which they are blended
  /// By pixel of the picture, row by row: nothing is seen beyond this view z, where a mesh stands. Empty:
  /// there is none.
  std::vector<float> mesh_depths = {};

  std::size_t pairs() const { return gaussians.size(); }
  std::span<const std::uint32_t> tile(std::uint32_t tx, std::uint32_t ty) const;
  /// The list of the tile that holds pixel (x, y).
  std::span<const std::uint32_t> at_pixel(int x, int y) const;
};

/// Whether a splat belongs to tile (tx, ty) of the view; never where it is not drawn. `tiles` is one of
/// shared/axes.h. With R the tile's rectangle of pixel centres, clipped to the picture, and
/// rho = 2 ln(sigma / Th), Th the splat's own threshold:
/// - TILES_AABB: exactly as 3D-GS, whatever sigma and Th are.
/// - TILES_OBB: the box of three standard deviations along the ellipse's axes meets R (GSCore); sigma >= Th.
/// - TILES_SNUG: the upright box around q <= rho holds one of R's pixel centres (Speedy-Splat).
/// - TILES_ELLIPSE: that, and the smallest q over R is at most rho.
/// - TILES_ALL: always.
bool touches(const Splat& splat, int tiles, int tile_size, int tx, int ty, const shared::View& view);

/// Whether it belongs to any tile of the view.
bool touches_any(const Splat& splat, int tiles, int tile_size, const shared::View& view);

/// The lists of all tiles of a view. `order` is from depth_order(); what has lost its `drawn` since is passed
/// over.
TileLists make_lists(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& order,
                     const shared::View& view, int tiles, int tile_size = TILE_SIZE_DEFAULT);

}  // namespace binosplat::reference
