#pragma once
// The tile tests and the lists of tiles (docs/method.md 4).

#include <cstdint>
#include <span>
#include <vector>

#include "reference/approximate.h"
#include "reference/project.h"

namespace binosplat::reference {

/// Whether the splat is wide: its visible level lines need not all be ellipses (docs/method.md 2.2).
bool is_wide(const Cone& cone);

/// q of a splat at a point of the picture (docs/method.md 2 and 3); infinite if the ray points away.
double squared_distance(const Splat& splat, const glm::dvec2& at);

/// Indices of the drawn splats, front to back. The index breaks ties.
std::vector<std::uint32_t> depth_order(const std::vector<Splat>& splats);

/// The Gaussians that each tile blends, front to back. Tiles are in rows from the top.
struct TileLists {
  std::uint32_t tiles_x = 0;
  std::uint32_t tiles_y = 0;
  std::vector<std::uint32_t> begin;      // tiles + 1 elements: tile t has gaussians [begin[t], begin[t + 1])
  std::vector<std::uint32_t> gaussians;  // indices into the model
  Approximation approximation;           // with which blend() blends the lists
  /// The view z of a mesh in each pixel, row by row. Splats beyond it are not drawn. Empty: no mesh.
  std::vector<float> mesh_depths = {};

  std::size_t pairs() const { return gaussians.size(); }
  std::span<const std::uint32_t> tile(std::uint32_t tx, std::uint32_t ty) const;
  /// The list of the tile that contains pixel (x, y).
  std::span<const std::uint32_t> at_pixel(int x, int y) const;
};

/// Whether a splat is paired with tile (tx, ty) of the view by the tile test `tiles` of shared/choices.h;
/// false if the splat is not drawn. R is the rectangle of the tile's pixel centres, clipped to the picture,
/// and rho = 2 ln(sigma / Th):
/// - TILES_AABB: as in 3D-GS, independent of sigma and Th.
/// - TILES_OBB: sigma >= Th, and the box of three standard deviations along the ellipse's axes intersects R
///   (GSCore).
/// - TILES_SNUG: the upright box around q <= rho contains a pixel centre of R (Speedy-Splat).
/// - TILES_ELLIPSE: as TILES_SNUG, and the smallest q over R is at most rho.
/// - TILES_ALL: always.
bool touches(const Splat& splat, int tiles, int tx, int ty, const shared::View& view);

/// Whether a splat is paired with any tile of the view.
bool touches_any(const Splat& splat, int tiles, const shared::View& view);

/// Returns the lists of all tiles of a view. `order` is the result of depth_order(). Skips splats whose
/// `drawn` has been cleared since.
TileLists make_lists(const std::vector<Splat>& splats, const std::vector<std::uint32_t>& order,
                     const shared::View& view, int tiles);

}  // namespace binosplat::reference
