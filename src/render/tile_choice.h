#pragma once
// The size of the tiles where it is left to the frame: TILE_SIZE_AUTO.

#include <cstdint>

#include "render/settings.h"

namespace binosplat::render {

/// Chooses by what the last frame drew. Large splats make less than half the pairs with tiles of 32 px, which
/// is worth more than what the larger tiles' blocks of pixels ask of small splats besides (README.md).
class TileChoice {
 public:
  /// The settings with a size in place of TILE_SIZE_AUTO: 32 after large splats, for exact frames where
  /// subgroups of 32 blend; else TILE_SIZE_DEFAULT. An approximate picture depends on the size, so it does
  /// not change from frame to frame there.
  FrameSettings resolve(FrameSettings settings, bool has_subgroups) const;

  /// A frame with tiles of this size made so many pairs of so many splats, over all views.
  void drew(int tile_size, std::uint64_t pairs, std::uint64_t splats);

 private:
  bool splats_are_large_ = false;
};

}  // namespace binosplat::render
