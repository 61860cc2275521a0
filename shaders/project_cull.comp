// Stage 1, project, first part: stores the sort key of each Gaussian that any view of an order group draws. Each
// Gaussian of the model's page has EYES invocations per instance, which divide the views among themselves. `view_end`
// excludes the probe.
#include "project_inputs.glsl"

layout(local_size_x = THREADS, local_size_y = EYES) in;

layout(std430, binding = 2) writeonly buffer DepthKeys { uint depth_keys[]; };  // by Gaussian of the frame

#if MEASURES
#include "project_bounds.glsl"
#else
void age_bound(View view, uint gaussian, uint v, bool projected, bool drawn, Splat splat) {}
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
    if (projected) set_level(view, v, page_first + i, splat);
    bool drawn = projected && touches_a_tile(splat, view);
    age_bound(view, page_first + i, v, projected, drawn, splat);
    if (PROBED == 1 && projected && !drawn && v == frame.probed_view &&
        view.order_group == views[frame.requested_views].order_group) {
      // An exact probe of this group draws every visible Gaussian; others draw some of these.
      splat.colour.w = visible_level(splat.opacity);
      drawn = touches_a_tile(splat, views[frame.requested_views]);  // the probe's tiles are the same for all instances
    }
    if (drawn) key = floatBitsToUint(order_depth(view, g));
    if (MEASURES == 0 && drawn) break;  // one eye decides for both
  }
  return key;
}

#if EYES > 1
shared uint keys[THREADS];

// The smallest key of a Gaussian's invocations. All invocations must call it.
uint least_of_eyes(uint key) {
  if (gl_LocalInvocationID.y == 0u) keys[gl_LocalInvocationID.x] = DEPTH_KEY_NONE;
  barrier();
  atomicMin(keys[gl_LocalInvocationID.x], key);
  barrier();
  return keys[gl_LocalInvocationID.x];
}
#else
uint least_of_eyes(uint key) { return key; }
#endif

void main() {
  uint i = thread_index();
  bool is_here = i < instance_count * page_count;
  uint key = least_of_eyes(is_here ? key_of(i) : DEPTH_KEY_NONE);
  if (is_here && gl_LocalInvocationID.y == 0u) depth_keys[page_first + i] = key;
}
