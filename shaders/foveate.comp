// Composes an eye's picture. In the inset it copies the pixels of the inset's window. Beyond the seam around the inset
// it interpolates the context, which has fewer pixels. In the seam it mixes window and context. A work group first
// interpolates rows of the context, at the x of its pixels, in shared memory.
//   CANVASES    1: writes the final picture into an image, without depths
//   MESH_DEPTH  1: blends over the image's colours
#include "shared/grid.glsl"
#if CANVASES
#include "canvases.glsl"
#endif

// Pixels of a work group. An invocation draws a pixel in every THREAD_ROWS-th row.
#define COLUMNS COMPOSE_COLUMNS
#define ROWS COMPOSE_ROWS
#define THREAD_ROWS 8u
layout(local_size_x = COLUMNS, local_size_y = THREAD_ROWS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T
#if CANVASES
uniform uint nth;                                          // index of the canvas
uniform uint background_r, background_g, background_b;     // bits of floats
#else
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 2) writeonly buffer Composed { vec4 composed[]; };
layout(std430, binding = 3) writeonly buffer ComposedZ { float composed_z[]; };
uniform uint first;  // the picture's first pixel in its buffer
#endif
uniform uint width, height;  // of the picture, px
uniform uint context_first, context_width, context_height;
uniform uint window_first, window_left, window_top, window_width;  // left, top: px in the picture
uniform uint inset_left, inset_top, inset_right, inset_bottom;     // in the picture
uniform uint seam;            // bits of a float, px
uniform uint step_x, step_y;  // bits of floats: px of the context per px of the picture

// A context has at most as many rows as the picture. Interpolation needs the context's rows from one before to two
// after a pixel.
#define AROUND_ROWS (ROWS + 4u)
shared vec4 across[AROUND_ROWS * COLUMNS];  // rows of the context at the pixels' columns
#if !CANVASES
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

// Catmull-Rom's weights of four neighbours; t runs from the second to the third.
vec4 weights_of(float t) {
  return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (-5.0 + 3.0 * t), t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
}

// The position in the context of a pixel of the picture. It is `precise`, because it selects places of shared memory
// for writing and for reading, which must agree.
vec2 in_context(uvec2 pixel) {
  precise vec2 at = (vec2(pixel) + 0.5) * uintBitsToFloat(uvec2(step_x, step_y)) - 0.5;
  return at;
}

// Interpolates the context by Catmull-Rom, first along rows (here), then along columns. Clamps along each axis to the
// range of the two nearest pixels: otherwise edges would have bright and dark fringes, and T could leave [0, 1].
void filter_rows(uvec2 corner, int base_y, int count) {
  uvec2 self = gl_LocalInvocationID.xy;
  ivec2 most = ivec2(context_width, context_height) - 1;
  float at = in_context(corner + self).x;
  vec4 weights = weights_of(at - floor(at));
  int from = int(floor(at)) - 1;
  for (int y = int(self.y); y < count; y += int(THREAD_ROWS)) {
    uint row = context_first + uint(clamp(base_y + y, 0, most.y)) * context_width, to = uint(y) * COLUMNS + self.x;
    Pixel of[4];
    for (int k = 0; k < 4; ++k) of[k] = pixel_at(row + uint(clamp(from + k, 0, most.x)));
    vec4 sum = weights[0] * of[0].colour + weights[1] * of[1].colour + weights[2] * of[2].colour + weights[3] * of[3].colour;
    across[to] = clamp(sum, min(of[1].colour, of[2].colour), max(of[1].colour, of[2].colour));
#if !CANVASES
    float z = weights[0] * of[0].z_sum + weights[1] * of[1].z_sum + weights[2] * of[2].z_sum + weights[3] * of[3].z_sum;
    across_z[to] = clamp(z, min(of[1].z_sum, of[2].z_sum), max(of[1].z_sum, of[2].z_sum));
#endif
  }
  barrier();
}

// Interpolates the filtered rows along this invocation's column.
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

// The inset's share of a pixel: 1 in the inset, 0 beyond the seam.
float share_of_window(uvec2 pixel) {
  vec2 d = max(vec2(inset_left, inset_top) - vec2(pixel), vec2(pixel) - vec2(inset_right - 1u, inset_bottom - 1u));
  float beyond = length(max(d, vec2(0.0)));
  float wide = uintBitsToFloat(seam);
  if (beyond == 0.0) return 1.0;
  return beyond >= wide ? 0.0 : 1.0 - smoothstep(0.0, wide, beyond);
}

// Whether all pixels of a group lie beyond the seam.
bool is_beyond(uvec2 corner) {
  vec2 wide = vec2(uintBitsToFloat(seam)), low = vec2(corner), high = low + vec2(COLUMNS, ROWS);
  return any(lessThan(high, vec2(inset_left, inset_top) - wide)) || any(greaterThan(low, vec2(inset_right, inset_bottom) + wide));
}

// Whether all pixels of a group lie in the inset. The inset is convex, so the group's corners decide.
bool is_inset(uvec2 corner) {
  uvec2 last = min(corner + uvec2(COLUMNS, ROWS), uvec2(width, height));
  return all(greaterThanEqual(corner, uvec2(inset_left, inset_top))) && all(lessThanEqual(last, uvec2(inset_right, inset_bottom)));
}

void draw(uvec2 pixel, bool has_context, bool has_window, int base_y) {
  float share = has_window ? share_of_window(pixel) : 0.0;
  Pixel shown;
  if (share > 0.0) shown = pixel_at(window_first + (pixel.y - window_top) * window_width + pixel.x - window_left);
  if (has_context && share < 1.0) {
    Pixel context = context_at(pixel.y, base_y);
    shown = share > 0.0 ? Pixel(mix(context.colour, shown.colour, share), mix(context.z_sum, shown.z_sum, share)) : context;
  }
#if CANVASES
  vec3 background = uintBitsToFloat(uvec3(background_r, background_g, background_b));
  write_on_canvas(0u, canvases[nth], height, pixel, shown.colour, vec4(background, 0.0));  // displayed already
#else
  composed[first + pixel.y * width + pixel.x] = shown.colour;
  composed_z[first + pixel.y * width + pixel.x] = shown.z_sum;
#endif
}

void main() {
  uint groups_across = (width + COLUMNS - 1u) / COLUMNS;
  uvec2 corner = uvec2(group_index() % groups_across, group_index() / groups_across) * uvec2(COLUMNS, ROWS);
  if (corner.y >= height) return;
  int base_y = int(floor(in_context(corner).y)) - 1;
  bool has_context = !is_inset(corner), has_window = !is_beyond(corner);
  if (has_context) filter_rows(corner, base_y, int(floor(in_context(corner + uvec2(0u, ROWS - 1u)).y)) + 3 - base_y);
  uvec2 pixel = corner + gl_LocalInvocationID.xy;
  for (uint row = 0u; row < ROWS; row += THREAD_ROWS) {
    uvec2 one = pixel + uvec2(0u, row);
    if (one.x < width && one.y < height) draw(one, has_context, has_window, base_y);
  }
}
