// An eye's picture of its parts: within the inset the pixels of its window as they are, beyond the seam around it the context,
// which has fewer pixels, and in the seam one going over into the other. One invocation a pixel; a work group shares the
// context's pixels that its own are made of.
//   CANVASES    1: the picture goes into an image as it is shown, and its depths nowhere
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#if CANVASES
#include "canvases.glsl"
#endif

#define COLUMNS 32u
#define ROWS 8u
layout(local_size_x = COLUMNS, local_size_y = ROWS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
#if CANVASES
uniform uint nth;                                          // of the canvases
uniform uint background_r, background_g, background_b;     // bits of floats
#else
layout(std430, binding = 2) writeonly buffer Composed { vec4 composed[]; };
layout(std430, binding = 3) writeonly buffer ComposedZ { float composed_z[]; };
uniform uint first;  // of the picture in its buffer
#endif
uniform uint width, height;  // of the picture, px
uniform uint context_first, context_width, context_height;
uniform uint window_first, window_left, window_top, window_width;  // left and top in the picture
uniform uint inset_left, inset_top, inset_right, inset_bottom;     // in the picture
uniform uint seam;                                                 // bits of a float, px

// A context has at most as many pixels as the picture; one is made of those from the one before to two after.
#define AROUND_COLUMNS (COLUMNS + 4u)
#define AROUND_ROWS (ROWS + 4u)
shared vec4 around[AROUND_ROWS * AROUND_COLUMNS];
shared vec4 across[AROUND_ROWS * COLUMNS];  // of a row, by the pixels' columns
#if !CANVASES
shared float around_z[AROUND_ROWS * AROUND_COLUMNS];
shared float across_z[AROUND_ROWS * COLUMNS];
#endif

struct Pixel {
  vec4 colour;
  float z_sum;
};

Pixel pixel_at(uint place) {
#if CANVASES
  return Pixel(colours[place], 0.0);
#else
  return Pixel(colours[place], z_sums[place]);
#endif
}

// Catmull-Rom's weights of four neighbours, t from the second to the third.
vec4 weights_of(float t) {
  return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (-5.0 + 3.0 * t), t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
}

// Where a pixel of the picture lies among the context's.
vec2 in_context(uvec2 pixel) {
  return (vec2(pixel) + 0.5) * vec2(context_width, context_height) / vec2(width, height) - 0.5;
}

// The context as it would be seen at this invocation's pixel: Catmull-Rom, within the range of the four that lie nearest, or
// edges would have bright and dark seams and T could leave its range. `corner` is the group's first pixel.
Pixel context_at(uvec2 pixel, uvec2 corner) {
  ivec2 base = ivec2(floor(in_context(corner))) - 1;
  ivec2 count = ivec2(floor(in_context(corner + uvec2(COLUMNS - 1u, ROWS - 1u)))) + 3 - base;
  ivec2 most = ivec2(context_width, context_height) - 1;
  for (uint k = gl_LocalInvocationIndex; k < uint(count.x * count.y); k += COLUMNS * ROWS) {
    uvec2 at = uvec2(k % uint(count.x), k / uint(count.x));
    uvec2 place = uvec2(clamp(base + ivec2(at), ivec2(0), most));
    Pixel one = pixel_at(context_first + place.y * context_width + place.x);
    around[at.y * AROUND_COLUMNS + at.x] = one.colour;
#if !CANVASES
    around_z[at.y * AROUND_COLUMNS + at.x] = one.z_sum;
#endif
  }
  barrier();
  vec2 at = in_context(pixel);
  vec2 cell = floor(at);
  uvec2 from = uvec2(ivec2(cell) - 1 - base);
  vec4 weights = weights_of(at.x - cell.x);
  for (uint y = gl_LocalInvocationID.y; y < uint(count.y); y += ROWS) {
    vec4 sum = vec4(0.0);
    for (uint k = 0u; k < 4u; ++k) sum += weights[k] * around[y * AROUND_COLUMNS + from.x + k];
    across[y * COLUMNS + gl_LocalInvocationID.x] = sum;
#if !CANVASES
    float z = 0.0;
    for (uint k = 0u; k < 4u; ++k) z += weights[k] * around_z[y * AROUND_COLUMNS + from.x + k];
    across_z[y * COLUMNS + gl_LocalInvocationID.x] = z;
#endif
  }
  barrier();
  weights = weights_of(at.y - cell.y);
  Pixel sum = Pixel(vec4(0.0), 0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uint row = (from.y + k) * COLUMNS + gl_LocalInvocationID.x;
    sum.colour += weights[k] * across[row];
#if !CANVASES
    sum.z_sum += weights[k] * across_z[row];
#endif
  }
  uint nearest = (from.y + 1u) * AROUND_COLUMNS + from.x + 1u, below = nearest + AROUND_COLUMNS;
  sum.colour = clamp(sum.colour, min(min(around[nearest], around[nearest + 1u]), min(around[below], around[below + 1u])),
                     max(max(around[nearest], around[nearest + 1u]), max(around[below], around[below + 1u])));
#if !CANVASES
  sum.z_sum = clamp(sum.z_sum, min(min(around_z[nearest], around_z[nearest + 1u]), min(around_z[below], around_z[below + 1u])),
                    max(max(around_z[nearest], around_z[nearest + 1u]), max(around_z[below], around_z[below + 1u])));
#endif
  return sum;
}

// 1 in the inset, 0 from the seam's end on.
float share_of_window(uvec2 pixel) {
  vec2 d = max(vec2(inset_left, inset_top) - vec2(pixel), vec2(pixel) - vec2(inset_right - 1u, inset_bottom - 1u));
  float beyond = length(max(d, vec2(0.0)));
  float wide = uintBitsToFloat(seam);
  if (beyond == 0.0) return 1.0;
  return beyond >= wide ? 0.0 : 1.0 - smoothstep(0.0, wide, beyond);
}

// The inset is convex: where the corners of a group lie in it, all of the group does.
bool is_inset(uvec2 corner) {
  uvec2 last = min(corner + uvec2(COLUMNS, ROWS), uvec2(width, height));
  return all(greaterThanEqual(corner, uvec2(inset_left, inset_top))) && all(lessThanEqual(last, uvec2(inset_right, inset_bottom)));
}

void main() {
  uint groups_across = (width + COLUMNS - 1u) / COLUMNS;
  uvec2 corner = uvec2(group_index() % groups_across, group_index() / groups_across) * uvec2(COLUMNS, ROWS);
  if (corner.y >= height) return;
  uvec2 pixel = corner + gl_LocalInvocationID.xy;
  bool is_there = pixel.x < width && pixel.y < height;
  pixel = min(pixel, uvec2(width, height) - 1u);
  float share = share_of_window(pixel);
  Pixel shown;
  if (share > 0.0) shown = pixel_at(window_first + (pixel.y - window_top) * window_width + pixel.x - window_left);
  if (!is_inset(corner)) {
    Pixel context = context_at(pixel, corner);
    if (share < 1.0)
      shown = share > 0.0 ? Pixel(mix(context.colour, shown.colour, share), mix(context.z_sum, shown.z_sum, share)) : context;
  }
  if (!is_there) return;
#if CANVASES
  vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
  write_on_canvas(0u, canvases[nth], height, pixel, shown.colour, background);
#else
  composed[first + pixel.y * width + pixel.x] = shown.colour;
  composed_z[first + pixel.y * width + pixel.x] = shown.z_sum;
#endif
}
