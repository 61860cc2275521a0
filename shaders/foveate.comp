// An eye's picture of its parts: within the inset the pixels of its window as they are, beyond the seam around it the context,
// which has fewer pixels, and in the seam one going over into the other. A work group shares the context's pixels that its own
// are made of.
//   CANVASES    1: the picture goes into an image as it is shown, and its depths nowhere
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#if CANVASES
#include "canvases.glsl"
#endif

// Pixels of a work group, of which each invocation has two, one half of the rows below the other.
#define COLUMNS COMPOSE_COLUMNS
#define ROWS COMPOSE_ROWS
#define THREAD_ROWS 8u
layout(local_size_x = COLUMNS, local_size_y = THREAD_ROWS) in;

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
uniform uint seam;            // bits of a float, px
uniform uint step_x, step_y;  // bits of floats: px of the context to one of the picture

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
// The same number wherever it is asked for: by it shared memory is filled and read.
vec2 in_context(uvec2 pixel) {
  precise vec2 at = (vec2(pixel) + 0.5) * uintBitsToFloat(uvec2(step_x, step_y)) - 0.5;
  return at;
}

// The context as it would be seen, by Catmull-Rom, and along each axis within the range of the two that lie nearest, or edges
// would have bright and dark seams and T could leave its range. First the context's rows at the pixels' columns.
void filter_rows(uvec2 corner, ivec2 base, ivec2 count) {
  uvec2 self = gl_LocalInvocationID.xy;
  ivec2 most = ivec2(context_width, context_height) - 1;
  for (uint y = self.y; y < uint(count.y); y += THREAD_ROWS) {
    for (uint x = self.x; x < uint(count.x); x += COLUMNS) {
      uvec2 place = uvec2(clamp(base + ivec2(x, y), ivec2(0), most));
      Pixel one = pixel_at(context_first + place.y * context_width + place.x);
      around[y * AROUND_COLUMNS + x] = one.colour;
#if !CANVASES
      around_z[y * AROUND_COLUMNS + x] = one.z_sum;
#endif
    }
  }
  barrier();
  float at = in_context(corner + self).x;
  vec4 weights = weights_of(at - floor(at));
  for (uint y = self.y; y < uint(count.y); y += THREAD_ROWS) {
    uint from = y * AROUND_COLUMNS + uint(int(floor(at)) - 1 - base.x), to = y * COLUMNS + self.x;
    vec4 sum = vec4(0.0);
    for (uint k = 0u; k < 4u; ++k) sum += weights[k] * around[from + k];
    across[to] = clamp(sum, min(around[from + 1u], around[from + 2u]), max(around[from + 1u], around[from + 2u]));
#if !CANVASES
    float z = 0.0;
    for (uint k = 0u; k < 4u; ++k) z += weights[k] * around_z[from + k];
    across_z[to] = clamp(z, min(around_z[from + 1u], around_z[from + 2u]), max(around_z[from + 1u], around_z[from + 2u]));
#endif
  }
  barrier();
}

// Then what a pixel in this invocation's column sees of them.
Pixel context_at(uint pixel_y, int base_y) {
  float at = in_context(uvec2(0u, pixel_y)).y;
  vec4 weights = weights_of(at - floor(at));
  uint from = uint(int(floor(at)) - 1 - base_y) * COLUMNS + gl_LocalInvocationID.x;
  Pixel sum = Pixel(vec4(0.0), 0.0);
  for (uint k = 0u; k < 4u; ++k) sum.colour += weights[k] * across[from + k * COLUMNS];
  uint above = from + COLUMNS, below = above + COLUMNS;
  sum.colour = clamp(sum.colour, min(across[above], across[below]), max(across[above], across[below]));
#if !CANVASES
  for (uint k = 0u; k < 4u; ++k) sum.z_sum += weights[k] * across_z[from + k * COLUMNS];
  sum.z_sum = clamp(sum.z_sum, min(across_z[above], across_z[below]), max(across_z[above], across_z[below]));
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

void draw(uvec2 pixel, bool has_context, int base_y) {
  float share = share_of_window(pixel);
  Pixel shown;
  if (share > 0.0) shown = pixel_at(window_first + (pixel.y - window_top) * window_width + pixel.x - window_left);
  if (has_context && share < 1.0) {
    Pixel context = context_at(pixel.y, base_y);
    shown = share > 0.0 ? Pixel(mix(context.colour, shown.colour, share), mix(context.z_sum, shown.z_sum, share)) : context;
  }
#if CANVASES
  vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
  write_on_canvas(0u, canvases[nth], height, pixel, shown.colour, background);
#else
  composed[first + pixel.y * width + pixel.x] = shown.colour;
  composed_z[first + pixel.y * width + pixel.x] = shown.z_sum;
#endif
}

void main() {
  uint groups_across = (width + COLUMNS - 1u) / COLUMNS;
  uvec2 corner = uvec2(group_index() % groups_across, group_index() / groups_across) * uvec2(COLUMNS, ROWS);
  if (corner.y >= height) return;
  ivec2 base = ivec2(floor(in_context(corner))) - 1;
  bool has_context = !is_inset(corner);
  if (has_context) filter_rows(corner, base, ivec2(floor(in_context(corner + uvec2(COLUMNS - 1u, ROWS - 1u)))) + 3 - base);
  uvec2 pixel = corner + gl_LocalInvocationID.xy;
  for (uint half_rows = 0u; half_rows < ROWS; half_rows += THREAD_ROWS) {
    uvec2 one = pixel + uvec2(0u, half_rows);
    if (one.x < width && one.y < height) draw(one, has_context, base.y);
  }
}
