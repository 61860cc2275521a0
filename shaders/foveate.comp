// An eye's picture of its parts: within the inset the pixels of its window as they are, beyond the seam around it the context,
// which has fewer pixels, and in the seam one going over into the other. One invocation a pixel.
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and T left
layout(std430, binding = 1) readonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 2) writeonly buffer Composed { vec4 composed[]; };
layout(std430, binding = 3) writeonly buffer ComposedZ { float composed_z[]; };
uniform uint first, width, height;  // of the picture: its first pixel in its buffer; px
uniform uint context_first, context_width, context_height;
uniform uint window_first, window_left, window_top, window_width;  // left and top in the picture
uniform uint inset_left, inset_top, inset_right, inset_bottom;     // in the picture
uniform uint seam;                                                 // bits of a float, px

struct Pixel {
  vec4 colour;
  float z_sum;
};

Pixel pixel_at(uint place) { return Pixel(colours[place], z_sums[place]); }

// Catmull-Rom's weights of four neighbours, t from the second to the third.
vec4 weights_of(float t) {
  return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (-5.0 + 3.0 * t), t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
}

// The context as it would be seen at a pixel: Catmull-Rom, within the range of the four that lie nearest, or edges would have
// bright and dark seams and T could leave its range.
Pixel context_at(uvec2 pixel) {
  vec2 size = vec2(context_width, context_height);
  vec2 at = (vec2(pixel) + 0.5) * size / vec2(width, height) - 0.5;
  vec2 cell = floor(at);
  vec4 across = weights_of(at.x - cell.x), down = weights_of(at.y - cell.y);
  Pixel sum = Pixel(vec4(0.0), 0.0), low = Pixel(vec4(3e38), 3e38), high = Pixel(vec4(-3e38), -3e38);
  for (int y = -1; y <= 2; ++y) {
    for (int x = -1; x <= 2; ++x) {
      uvec2 place = uvec2(clamp(cell + vec2(x, y), vec2(0.0), size - 1.0));
      Pixel one = pixel_at(context_first + place.y * context_width + place.x);
      float weight = across[x + 1] * down[y + 1];
      sum.colour += weight * one.colour;
      sum.z_sum += weight * one.z_sum;
      if ((x == 0 || x == 1) && (y == 0 || y == 1)) {
        low = Pixel(min(low.colour, one.colour), min(low.z_sum, one.z_sum));
        high = Pixel(max(high.colour, one.colour), max(high.z_sum, one.z_sum));
      }
    }
  }
  return Pixel(clamp(sum.colour, low.colour, high.colour), clamp(sum.z_sum, low.z_sum, high.z_sum));
}

// 1 in the inset, 0 from the seam's end on.
float share_of_window(uvec2 pixel) {
  vec2 d = max(vec2(inset_left, inset_top) - vec2(pixel), vec2(pixel) - vec2(inset_right - 1u, inset_bottom - 1u));
  float beyond = length(max(d, vec2(0.0)));
  float wide = uintBitsToFloat(seam);
  if (beyond == 0.0) return 1.0;
  return beyond >= wide ? 0.0 : 1.0 - smoothstep(0.0, wide, beyond);
}

void main() {
  if (thread_index() >= width * height) return;
  uvec2 pixel = uvec2(thread_index() % width, thread_index() / width);
  float share = share_of_window(pixel);
  Pixel shown;
  if (share > 0.0) shown = pixel_at(window_first + (pixel.y - window_top) * window_width + pixel.x - window_left);
  if (share < 1.0) {
    Pixel around = context_at(pixel);
    shown = share > 0.0 ? Pixel(mix(around.colour, shown.colour, share), mix(around.z_sum, shown.z_sum, share)) : around;
  }
  composed[first + thread_index()] = shown.colour;
  composed_z[first + thread_index()] = shown.z_sum;
}
