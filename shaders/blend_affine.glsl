// The blend with the affine projection: a splat's q is the same along a ray (blend_tangent.glsl). Part of blending.glsl.
#define OF_TILE
void begin_rays(View view, vec2 corner) {}
float exponent_in(uint p, float exponent, vec4 down) { return exponent; }
void drop_behind_eye(uint at[AHEAD]) {}
float view_z_of(uint p, float depth) { return depth; }
float from_view_z(uint p, float z) { return z; }

vec3 staged_rest(Splat splat, float v, float bits) {
  precise float level = fma(v, v, -bits);
  return vec3(level, packed_colour(splat));
}
