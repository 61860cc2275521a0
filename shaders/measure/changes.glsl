// The squared change of the picture without the splat, in the first channel. The colour behind the splat then appears:
// the rest of the picture, divided by T (1 - alpha).
#include "measure/sums.glsl"

vec4 scaled(vec4 pixel) { return pixel; }

ivec4 steps_of(uint at, uint p, float weight) {
  vec3 own = batch_colour[at].rgb;
  vec3 behind = (picture[p].rgb - colour[p] - weight * own) / (transmittance[p] - weight);
  vec3 change = weight * (behind - own);
  return ivec4(min(dot(change, change), float(CHANGE_MAX)) * float(CHANGE_SCALE) + 0.5, 0.0, 0.0, 0.0);
}
