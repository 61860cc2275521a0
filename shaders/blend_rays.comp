// The blend (docs/method.md 3) along single rays, which need not pass through pixel centres. One invocation per ray. It
// blends the list of the tile that the ray meets. Lists are made with BETWEEN (tiles/tiles.glsl).
#include "shared/grid.glsl"
#include "frame.glsl"
#include "display_values.glsl"
#include "projection.glsl"
#include "supertiles.glsl"
#include "splats.glsl"  // binding 12

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Ranges { uint ranges[]; };
layout(std430, binding = 2) readonly buffer Values { uint values[]; };
layout(std430, binding = 3) readonly buffer Rays { PlacedRay rays[]; };
layout(std430, binding = 4) writeonly buffer Colours { vec4 colours[]; };  // C, and the final T
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
layout(std430, binding = 6) buffer FrameCounters { Counters counters; };
uniform uint ray_count;
uniform uint view_index;

void main() {
  if (thread_index() >= ray_count) return;
  PlacedRay ray = rays[thread_index()];
  View view = views[view_index];
  uvec2 nearest = uvec2(clamp(floor(ray.pixel + 0.5), vec2(0.0), vec2(view.width - 1u, view.height - 1u)));
  uint tile = tile_number(nearest / uint(TILE_SIZE), view);
  uint begin = ranges[2u * tile], end = ranges[2u * tile + 1u];
  vec3 colour = vec3(0.0);
  float z_sum = 0.0;
  float transmittance = 1.0;
  bool is_done = false;
#if PROJECTION == PROJECTION_TANGENT
  vec2 slope = (ray.pixel + 0.5 - view.lens.zw) / view.lens.xy;
  float nearness = 1.0 / (1.0 + dot(slope, slope));
#else
  float nearness = 1.0;
#endif
  // A driver may end loops after too many rounds, so each round takes several splats, as in blend.comp.
  uint at = begin;
  for (; at < end && !is_done; at += BLEND_UNROLL) {
    for (uint k = 0u; k < BLEND_UNROLL; ++k) {
      Splat splat = SPLAT(values[min(at + k, end - 1u)]);
      vec2 d = ray.pixel - splat.mean;
      // The Cholesky factor of the conic keeps q positive.
      float root = sqrt(splat.conic.x);
      float across = root * d.x + splat.conic.y / root * d.y;
      float down = d.y / (abs(splat.conic.w) * root);
      float q = (across * across + down * down) * nearness;
      float alpha = min(float(ALPHA_MAX), splat.opacity * exp(-0.5 * q));
#if PROJECTION == PROJECTION_TANGENT
      float facing = 1.0 + dot((splat.mean + 0.5 - view.lens.zw) / view.lens.xy, slope);
      alpha = is_wide(splat) && facing * splat.conic.w < 0.0 ? 0.0 : alpha;
#endif
      bool is_seen = at + k < end && !is_done && alpha >= float(ALPHA_MIN);  // NaN: false
      float left = transmittance * (1.0 - alpha);
      is_done = is_done || (is_seen && left < float(TRANSMITTANCE_MIN));
      float weight = is_seen && !is_done ? transmittance * alpha : 0.0;
      if (weight == 0.0) continue;
      colour += weight * splat.colour.rgb;
      z_sum += weight * abs(splat.depth);
      transmittance = left;
    }
  }
  if (!is_done && at < end) atomicAdd(counters.truncated_lists, 1u);
  vec4 pixel = vec4(colour, transmittance);
  colours[ray.place] = frame.background.w != 0.0 ? displayed(pixel, frame.background.rgb) : pixel;
  z_sums[ray.place] = z_sum;
}
