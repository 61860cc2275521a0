// The squared error of a drawn view against the picture that byte_pictures.comp stored, summed by work group, in units
// of (1 / 255)^2. Sums are integers, so their order does not matter. One invocation per pixel.
#include "shared/grid.glsl"
#include "shared/bytes.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Colours { vec4 colours[]; };  // C, and the final T; over black
layout(std430, binding = 1) readonly buffer Kept { uint kept[]; };
layout(std430, binding = 2) writeonly buffer Sums { uint sums_of_groups[]; };
uniform uint first_pixel;
uniform uint first_kept;
uniform uint first_sum;
uniform uint pixel_count;

shared uint sums[THREADS];  // each at most 3 * 255^2: their sum fits in a word

void main() {
  uint pixel = thread_index();
  uint self = gl_LocalInvocationIndex;
  sums[self] = 0u;
  if (pixel < pixel_count) {
    ivec3 drawn = ivec3(in_bytes(colours[first_pixel + pixel].rgb));
    uint word = kept[first_kept + pixel];
    ivec3 d = drawn - ivec3(word & 255u, word >> 8u & 255u, word >> 16u & 255u);
    sums[self] = uint(d.r * d.r + d.g * d.g + d.b * d.b);
  }
  barrier();
  for (uint half_way = THREADS / 2u; half_way > 0u; half_way /= 2u) {
    if (self < half_way) sums[self] += sums[self + half_way];
    barrier();
  }
  uint group = group_index();
  if (self == 0u && group * THREADS < pixel_count) sums_of_groups[first_sum + group] = sums[0];
}
