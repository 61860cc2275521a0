// Tiles in blocks of 32 invocations with COLUMN pixels each: a subgroup draws one.
#include "shared/limits.h"
#include "shared/types.h"
#include "tiles/level.glsl"

#define BLOCK_WIDTH (COLUMN == 4 ? 16 : 8)
#define BLOCK_HEIGHT (32 / BLOCK_WIDTH * COLUMN)
#define BLOCKS_ACROSS (TILE_SIZE / BLOCK_WIDTH)
#define BLOCKS (BLOCKS_ACROSS * (TILE_SIZE / BLOCK_HEIGHT))

// In the tile, px.
uvec2 corner_of_block(uint nth) {
  return uvec2(nth % BLOCKS_ACROSS, nth / BLOCKS_ACROSS) * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
}

uvec2 place_in_block(uint lane) { return uvec2(lane % BLOCK_WIDTH, lane / BLOCK_WIDTH * COLUMN); }

// Whether alpha comes to ALPHA_MIN in any pixel of the block whose first pixel this is; that it does not is certain.
bool reaches(Splat splat, uvec2 first, uvec2 picture) {
  vec2 low = vec2(first), high = vec2(min(first + uvec2(BLOCK_WIDTH, BLOCK_HEIGHT), picture) - 1u);
  vec2 at;
  return lowest_level(splat, low, high, at) <= 2.0 * log(splat.opacity / float(ALPHA_MIN)) + 1e-4;
}
