// Shared by project_cull.comp and project.comp: the Gaussians of a page, the views, and the splats that tile tests see.
#include "shared/grid.glsl"
#include "tiles/tiles.glsl"

layout(std430, binding = 0) readonly buffer Views { View views[]; };  // (instance, view)
#include "gaussians.glsl"            // bindings 1 and 9
#include "threshold/threshold.glsl"  // binding 7
uniform uint view_begin;
uniform uint view_end;

// Sets the level of the tile tests. Then rounds the splat to the values that `bin` reads, in both programs: an eye drawn
// in stereo must equal the same eye drawn alone.
void set_level(View view, uint v, uint gaussian, inout Splat splat) {
  splat.colour.w = tile_level(view, v, gaussian, splat);
#if HALF
  splat = rounded(splat);
#endif
}
