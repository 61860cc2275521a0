// Stage 0, decode (Scaffold-GS only): computes the Gaussians of each anchor for an eye. One invocation for each anchor
// of the page and each view. Every Gaussian has a fixed place, by its id, for its data and measurements. Bits in `kept`
// mark the Gaussians that exist.
#include "shared/grid.glsl"
#include "frame.glsl"
#include "tiles/tiles.glsl"  // aabb, 16 px, for the anchor cull

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };
layout(std430, binding = 1) readonly buffer Anchors { Anchor anchors[]; };             // of the page
layout(std430, binding = 2) readonly buffer Offsets { float offsets[]; };              // (anchor, k, 3)
#include "scaffold_networks.glsl"                                                               // bindings 3 and 4
#if HALF
#include "half_precision.glsl"
layout(std430, binding = 5) writeonly buffer Gaussians { uvec4 gaussians[]; };   // (view, anchor, k), two each
layout(std430, binding = 6) writeonly buffer Harmonics { uvec4 harmonics[]; };   // of degree 0, likewise
#else
layout(std430, binding = 5) writeonly buffer Gaussians { Gaussian gaussians[]; };      // (view, anchor, k)
layout(std430, binding = 6) writeonly buffer Harmonics { vec4 harmonics[]; };          // of degree 0, likewise
#endif
layout(std430, binding = 9) writeonly buffer Kept { uint kept[]; };  // (view, anchor), bit k

// The anchor cull (docs/method.md 1.1), as trained: whether a Gaussian with the scales `offset_scale` touches a tile.
bool sees(View view, Anchor anchor) {
  Gaussian g = Gaussian(vec4(anchor.position.xyz, 1.0), anchor.rotation, anchor.offset_scale);
  view.tiles_x = (view.width + uint(TILE_SIZE - 1)) / uint(TILE_SIZE);
  view.tiles_y = (view.height + uint(TILE_SIZE - 1)) / uint(TILE_SIZE);
  Splat splat;
  return project(view, g, scaled_axes(g), splat) && touches_a_tile(splat, view);
}

vec3 mean_of(Anchor anchor, uint n, uint k) {
  uint at = 3u * (n * uint(OFFSETS) + k);
  precise vec3 mean = anchor.position.xyz + vec3(offsets[at], offsets[at + 1u], offsets[at + 2u]) * anchor.offset_scale.xyz;
  return mean;
}

vec3 sigmoid(vec3 x) { return 1.0 / (1.0 + exp(-x)); }

// Writes Gaussian k of an anchor to place `to`. Returns false if its values overflow.
bool decode(Anchor anchor, uint n, uint k, float logit, Hidden covariance, Hidden colour, uint to) {
  uint row = COVARIANCE_ROW + 7u * k;
  vec3 scale = vec3(output_of(row, covariance), output_of(row + 1u, covariance), output_of(row + 2u, covariance));
  vec4 rotation = vec4(output_of(row + 3u, covariance), output_of(row + 4u, covariance),
                       output_of(row + 5u, covariance), output_of(row + 6u, covariance));
  row = COLOUR_ROW + 3u * k;
  vec3 rgb = sigmoid(vec3(output_of(row, colour), output_of(row + 1u, colour), output_of(row + 2u, colour)));

  Gaussian g;
  g.position = vec4(mean_of(anchor, n, k), 1.0 - 2.0 / (exp(2.0 * logit) + 1.0));  // tanh
  g.rotation = rotation / max(length(rotation), 1e-12);
  g.scale = vec4(anchor.scale.xyz * sigmoid(scale), 0.0);
  vec3 coefficients = (rgb - 0.5) / 0.28209479177387814;
#if HALF
  gaussians[2u * to] = packed_place(g);
  gaussians[2u * to + 1u] = packed_shape(g);
  harmonics[to] = uvec4(packHalf2x16(coefficients.rg), packHalf2x16(vec2(coefficients.b, 0.0)), 0u, 0u);
#else
  gaussians[to] = g;
  harmonics[to] = vec4(coefficients, 0.0);
#endif
  float sum = dot(g.rotation, vec4(1.0)) + dot(g.scale.xyz, vec3(1.0)) + dot(rgb, vec3(1.0));
  return abs(sum) < 1e38;
}

// Decodes an anchor; `to` is the place of its first Gaussian. Returns a bit for each Gaussian that exists. Computes
// opacities first, so that fewer hidden units are in registers at a time.
uint decode_anchor(Anchor anchor, uint n, vec3 towards, uint to) {
  float away = length(towards);
  vec4 ray = vec4(towards / away, away);
  vec3 mixed = bank_mix(ray);
  float logits[OFFSETS];
  Hidden opacity = hidden_of(OPACITY, n, ray, mixed);
  // The limit is a uniform, so that compilers do not unroll the loop: unrolling takes minutes.
  for (uint k = 0u; k < frame.offset_count; ++k) logits[k] = output_of(OPACITY_ROW + k, opacity);
  Hidden covariance = hidden_of(COVARIANCE, n, ray, mixed);
  Hidden colour = hidden_of(COLOUR, n, ray, mixed);
  uint bits = 0u;
  for (uint k = 0u; k < frame.offset_count; ++k) {
    if (logits[k] > 0.0 && decode(anchor, n, k, logits[k], covariance, colour, to + k)) bits |= 1u << k;
  }
  return bits;
}

void main() {
  take_weights();
  uint at = thread_index();
  uint v = at / anchor_count;
  if (v >= frame.requested_views) return;
  uint n = at % anchor_count;
  Anchor anchor = anchors[n];
  bool seen = frame.anchor_cull == 0u || sees(views[v], anchor);
  vec3 towards = (anchor.position.xyz - views[v].anchor.xyz) - views[v].eye.xyz;
  kept[at] = seen ? decode_anchor(anchor, n, towards, at * uint(OFFSETS)) : 0u;
}
