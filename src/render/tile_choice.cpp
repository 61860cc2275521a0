#include "render/tile_choice.h"

namespace binosplat::render {

namespace {

// Pairs a splat: with tiles of 16 px, from which on those of 32 are faster; with those of 32, from which on
// they stay. Views in between are as fast either way (README.md).
constexpr double large_at_16 = 6.0, large_at_32 = 2.5;

}  // namespace

FrameSettings TileChoice::resolve(FrameSettings settings, bool has_subgroups) const {
  if (settings.tile_size != TILE_SIZE_AUTO) return settings;
  const bool plain = settings.th == TH_TAU && !measures(settings.transmittance) && !settings.weigh;
  settings.tile_size = splats_are_large_ && plain && has_subgroups ? 32 : TILE_SIZE_DEFAULT;
  return settings;
}

void TileChoice::drew(int tile_size, std::uint64_t pairs, std::uint64_t splats) {
  const double needed = tile_size == 32 ? large_at_32 : large_at_16;
  splats_are_large_ = static_cast<double>(pairs) > needed * static_cast<double>(splats);
}

}  // namespace binosplat::render
