// The picture times alpha T.
#include "measure/sums.glsl"
uniform uint scale;  // bits of a float

vec4 scaled(vec4 pixel) { return pixel * uintBitsToFloat(scale); }

ivec4 steps_of(uint at, uint p, float weight) { return ivec4(floor(weight * picture[p] + 0.5)); }
