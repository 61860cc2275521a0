#pragma once
// The tile tests and the lists of tiles (docs/method.md 4).

#include <cstdint>
#include <span>
#include <vector>

#include "reference/approximate.h"
#include "reference/project.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::reference {

/// Whether the cone's outline may differ from an ellipse at any visible level (docs/method.md 4).
bool is_wide(const Cone& cone);

/// q of a splat at a point of the picture (docs/method.md 2 and 3); infinite if the ray points away.
double squared_distance(const Splat& splat, const glm::dvec2& at);

/// Indices of drawn splats, nearest first; equal depths by index.
std::vector<std::uint32_t> depth_order(const std::vector<Splat>& splats);

/// For each tile, in rows from the top, the Gaussians that it blends, nearest first.
struct TileLists {
  std::uint32_t tiles_x = 0;
  std::uint32_t tiles_y = 0;
  std::uint32_t tile_size = 0;           // px
  std::vector<std::uint32_t> begin;      // tiles + 1: tile t owns gaussians from begin[t] to begin[t + 1] - 1
  std::vector<std::uint32_t> gaussians;  // indices into the model
  Approximation approximation;           // applied when blending
  /// The view z of a mesh in each pixel, in rows; splats beyond it are hidden. Empty: no mesh.
  std::vector<float> mesh_depths = {};

  std::size_t pairs() const { return gaussians.size(); }
  std::span<const std::uint32_t> tile(std::uint32_t tx, std::uint32_t ty) const;
  /// The list of the tile that contains pixel (x, y).
  std::span<const std::uint32_t> at_pixel(int x, int y) const;
};

/// Whether a splat belongs to tile (tx, ty) of the view; false if it is not drawn. `tiles` is a tile test of
/// shared/axes.h. R is the tile's rectangle of pixel centres, clipped to the picture. rho = 2 ln(sigma / Th),
/// with the splat's own Th:
/// - TILES_AABB: exactly as 3D-GS, independent of sigma and Th.
/// - TILES_OBB: the box of three standard deviations along the ellipse's axes intersects R (GSCore); sigma >=
///   Th.
/// - TILES_SNUG: the upright box around q <= rho contains a pixel centre of R (Speedy-Splat).
/// - TILES_ELLIPSE: as TILES_SNUG, and the smallest q over R is at most rho.
/// - TILES_ALL: always.
bool touches(const Splat& splat, int tiles, int tile_size, int tx, int ty, const shared::View& view);

/// Whether it belongs to any tile of the view.
bool touches_any(const Splat& splat, int tiles, int tile_size, const shared::View& view);

/// The lists of all tiles of a view. `order` comes from depth_order(). Skips splats that are no longer
/// `drawn`.
TileLists make_lists(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& order,
                     const shared::View& view, int tiles, int tile_size = TILE_SIZE_DEFAULT);

}  // namespace binosplat::reference
