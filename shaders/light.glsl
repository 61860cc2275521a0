// The map of light: how far light came in each block of a view's picture (METHOD 5: T_upper, local). For level k a block keeps
// the depth beyond which no pixel of it has more than LIGHT_STEP^(k + 1) left, and for the last level none at all: eight halves,
// of depths in near planes, rounded up. Then levels of it, each block the farthest of up to 2 x 2.
#include "shared/limits.h"
#include "shared/types.h"

#define LIGHT_NEVER 3e38

uvec2 light_blocks(View view, uint level) {
  uvec2 blocks = (uvec2(view.width, view.height) + uint(LIGHT_BLOCK - 1)) / uint(LIGHT_BLOCK);
  return (blocks + (1u << level) - 1u) >> level;
}

// Where a block of a level is kept.
uint light_place(View view, uint level, uvec2 block) {
  uint first = view.light_offset;
  for (uint below = 0u; below < level; ++below) {
    uvec2 blocks = light_blocks(view, below);
    first += blocks.x * blocks.y;
  }
  return first + block.y * light_blocks(view, level).x + block.x;
}

// Two depths in near planes as halves: never less than they are.
uint light_word(float a, float b) { return packHalf2x16(min(1.0005 * vec2(a, b), 65504.0)); }

uint farther(uint a, uint b) {
  return max(a & 0xFFFFu, b & 0xFFFFu) | max(a >> 16, b >> 16) << 16;
}

uvec4 farther(uvec4 a, uvec4 b) {
  return uvec4(farther(a.x, b.x), farther(a.y, b.y), farther(a.z, b.z), farther(a.w, b.w));
}
