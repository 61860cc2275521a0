// The blend with the tangent projection (projection/tangent.glsl): q is divided by |d|^2, with d a pixel's ray. Part of
// blending.glsl. Registers are scarce, so values of the tile are in shared memory, and all invocations write the same.
#define OF_TILE shared
OF_TILE float farthest;     // the largest |d|^2 of the tile's rays
OF_TILE vec2 middle_slope;  // the slope of the tile's middle
float nearness[COLUMN];     // by pixel: 1 / |d|^2

void begin_rays(View view, vec2 corner) {
  precise vec2 step = 1.0 / view.lens.xy;
  vec2 first = (corner + 0.5 - view.lens.zw) * step;
  vec2 most = max(abs(first), abs(first + float(TILE_SIZE - 1) * step));
  farthest = 1.0 + dot(most, most);
  middle_slope = first + float(TILE_SIZE - 1) * 0.5 * step;
  for (uint p = 0u; p < COLUMN; ++p) {
    precise vec2 ray = (vec2(first_pixel + uvec2(0u, p)) + 0.5 - view.lens.zw) * step;
    precise float inverse = 1.0 / fma(ray.y, ray.y, fma(ray.x, ray.x, 1.0));
    nearness[p] = inverse;
  }
}

float exponent_in(uint p, float exponent, vec4 down) {
  precise float divided = fma(nearness[p], exponent, down.z);
  return divided;
}

// In broad tiles a wide splat may be in front of some rays and behind others: there it gets no alpha.
void drop_behind_eye(uint at[AHEAD]) {
  for (uint p = 0u; IS_BROAD && p < COLUMN; ++p) {
    vec3 ray = vec3(slope_at(views[view_index], vec2(first_pixel + uvec2(0u, p))), 1.0);
    for (uint k = 0u; k < AHEAD; ++k) {
      if (dot(direction_of(batch_down[at[k]].w), ray) >= 0.0) continue;
      weights[p][k] = 0.0;
      MARK(p, k, 0.0);
    }
  }
}

// This projection's depths are distances.
float view_z_of(uint p, float depth) {
  precise float z = depth * sqrt(nearness[p]);
  return z;
}

float from_view_z(uint p, float z) {
  precise float distance = z * inversesqrt(nearness[p]);
  return distance;
}

vec3 staged_rest(Splat splat, float v, float bits) {
  float direction = is_wide(splat) ? direction_in_bytes(views[view_index], splat) : 0.0;
  if (!IS_BROAD && dot(direction_of(direction), vec3(middle_slope, 1.0)) < 0.0) bits = -1e30;
  precise vec3 rest = vec3(v * v, -bits, direction);
  return rest;
}
