// After the blend: the coarser levels of the map of light. A work group makes all levels above 32 x 32 blocks.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "light.glsl"

#define SIDE 16u
layout(local_size_x = SIDE, local_size_y = SIDE) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) buffer Light { uvec4 light[]; };
uniform uint view_count;

shared uvec4 blocks[SIDE][SIDE];

void main() {
  uint group = group_index();
  uint v = 0u;
  uvec2 groups;
  for (;; ++v) {
    if (v == view_count) return;
    groups = light_blocks(views[v], LIGHT_LEVEL_MAX);
    if (group < groups.x * groups.y) break;
    group -= groups.x * groups.y;
  }
  View view = views[v];
  uvec2 self = gl_LocalInvocationID.xy;
  uvec2 corner = uvec2(group % groups.x, group / groups.x) * SIDE;
  for (uint level = 1u; level <= LIGHT_LEVEL_MAX; ++level) {
    uint side = SIDE >> (level - 1u);
    uvec2 at = (corner >> (level - 1u)) + self;
    uvec2 size = light_blocks(view, level), below = light_blocks(view, level - 1u);
    bool is_one = self.x < side && self.y < side && at.x < size.x && at.y < size.y;
    uvec4 farthest = uvec4(0u);
    if (is_one) {
      for (uint nth = 0u; nth < 4u; ++nth) {
        uvec2 part = uvec2(nth % 2u, nth / 2u);
        uvec2 of = 2u * at + part;
        if (of.x >= below.x || of.y >= below.y) continue;
        uvec2 local = 2u * self + part;
        farthest = farther(farthest, level == 1u ? light[light_place(view, 0u, of)] : blocks[local.y][local.x]);
      }
      light[light_place(view, level, at)] = farthest;
    }
    memoryBarrierShared();
    barrier();
    if (is_one) blocks[self.y][self.x] = farthest;
    memoryBarrierShared();
    barrier();
  }
}
