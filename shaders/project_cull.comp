// Stage 1, project, first part: stores the sort key of each Gaussian that any view of an order group draws. Each
// Gaussian of the model's page has EYES invocations per instance, which divide the views among themselves.
#include "shared/limits.h"
#include "shared/types.h"
#include "shared/grid.glsl"
#include "projection.glsl"
#include "tiles/tiles.glsl"

layout(local_size_x = THREADS, local_size_y = EYES) in;

layout(std430, binding = 0) readonly buffer Views { View views[]; };  // (instance, view)
#include "gaussians.glsl"            // bindings 1 and 9
#include "threshold/threshold.glsl"  // binding 7
layout(std430, binding = 2) writeonly buffer DepthKeys { uint depth_keys[]; };    // by Gaussian of the frame
#if MEASURES
layout(std430, binding = 8) writeonly buffer NextBounds { float next_bounds[]; };  // (view, Gaussian)
#endif
uniform uint view_begin;
uniform uint view_end;  // without the probe

// Stores a Gaussian's bound for the next frame, 1 if out of view. If Th drops the Gaussian, its bound grows slightly;
// otherwise it would never be drawn and measured again. If it is drawn, blend_measured.comp replaces the bound.
#if MEASURES
void age_bound(View view, uint gaussian, uint v, bool projected, bool drawn, Splat splat) {
  if (v >= frame.requested_views) return;  // a probe measures nothing
  bool left_out = false;
#if TH != TH_TAU
  if (projected && !drawn) {
    splat.colour.w = visible_level(splat.opacity);
    left_out = !is_wide(splat) && touches_a_tile(splat, view);  // wide splats touch even out of view
  }
#endif
  float aged = frame.has_bounds == 0u ? 1.0 : min(1.0, float(BOUND_AGEING) * bounds[v * frame.gaussian_count + gaussian]);
  next_bounds[v * frame.gaussian_count + gaussian] = left_out ? aged : 1.0;
}
#endif

// Returns the Gaussian's key, equal in an order group's views; DEPTH_KEY_NONE if no view of this invocation draws it.
uint key_of(uint i) {
  uvec2 place = place_in_page(i);
  Gaussian g = GAUSSIAN(place.x);
  mat3 axes = scaled_axes(g);
  uint key = DEPTH_KEY_NONE;
  for (uint v = view_begin + gl_LocalInvocationID.y; v < view_end; v += EYES) {
    View view = views[place.y + v];
#if OFFSETS > 0
    g = GAUSSIAN(place_of(i, v));
    axes = scaled_axes(g);
#endif
    Splat splat;
    bool projected = is_kept(i, v) && project(view, g, axes, splat);
    if (projected) splat.colour.w = tile_level(view, v, page_first + i, splat);
#if HALF
    if (projected) splat = rounded(splat);  // an eye drawn in stereo must equal the same eye drawn alone
#endif
    bool drawn = projected && touches_a_tile(splat, view);
#if MEASURES
    age_bound(view, page_first + i, v, projected, drawn, splat);
#endif
#if PROBED
    // An exact probe of this group draws every visible Gaussian; others draw some of these.
    if (projected && !drawn && v == frame.probed_view && view.order_group == views[frame.requested_views].order_group) {
      splat.colour.w = visible_level(splat.opacity);
      drawn = touches_a_tile(splat, views[frame.requested_views]);  // the probe's tiles are the same for all instances
    }
#endif
    if (drawn) key = floatBitsToUint(order_depth(view, g));
#if !MEASURES
    if (drawn) break;  // one eye decides for both
#endif
  }
  return key;
}

#if EYES > 1
shared uint keys[THREADS];
#endif

void main() {
  uint i = thread_index();
  bool is_here = i < instance_count * page_count;
  uint key = is_here ? key_of(i) : DEPTH_KEY_NONE;
#if EYES > 1
  if (gl_LocalInvocationID.y == 0u) keys[gl_LocalInvocationID.x] = DEPTH_KEY_NONE;
  barrier();
  atomicMin(keys[gl_LocalInvocationID.x], key);
  barrier();
  key = keys[gl_LocalInvocationID.x];
#endif
  if (is_here && gl_LocalInvocationID.y == 0u) depth_keys[page_first + i] = key;
}
