// The tangent projection (docs/method.md 2.2): a unit ray d, dropped at a right angle onto the plane that touches the unit
// sphere in the Gaussian's direction, goes by a covariance in that plane. It depends on place and ray only, so that turning the
// head changes nothing. In the picture q = (p - mean)^T Q (p - mean) / |d|^2, |d| the length of p's ray with d.z = 1: Q is what
// a splat keeps, and sqrt(det Q^-1).
//
// A wide splat, whose level lines need not be ellipses there, is kept with a negative depth. Its mean is (n.x, n.y) / (1 + n.z)
// of its direction n, its conic that in the tangent plane, in px of the picture's middle, along what tangent_axes() gives.

// The largest squared sine at which anything is seen, as a multiple of the variance in the tangent plane: a little more than
// 2 ln 255.
#define LEVEL_MAX 11.2

bool is_wide(Splat splat) { return splat.depth < 0.0; }

vec2 slope_at(View view, vec2 pixel) {
  precise vec2 slope = (pixel + 0.5 - view.lens.zw) / view.lens.xy;
  return slope;
}

// Two axes across n; the second is level with the picture's rows.
void tangent_axes(vec3 n, out vec3 first, out vec3 second) {
  float size = length(n.yz);
  second = size > 0.0 ? vec3(0.0, n.z, -n.y) / size : vec3(0.0, 1.0, 0.0);
  first = cross(second, n);
}

vec3 direction_of(Splat splat) {
  float square = dot(splat.mean, splat.mean);
  return vec3(2.0 * splat.mean, 1.0 - square) / (1.0 + square);
}

// Whether a Gaussian at v is too far from all rays of the picture to be seen.
bool is_beside(View view, vec3 v, float distance, float widest) {
  float spread = widest / distance;
  float variance = spread * spread + float(KERNEL_PX2) / (view.lens.x * view.lens.y);
  float sine2 = min(LEVEL_MAX * variance, LEVEL_MAX * float(WIDEST_TANGENT) * float(WIDEST_TANGENT));
  float cosine = (sqrt(1.0 - sine2) - sqrt(sine2 * view.centre.w)) / sqrt(1.0 + view.centre.w);
  return v.z < distance * (cosine - 1e-4);
}

// What project() keeps of a wide splat; false where it is not drawn.
bool keep_wide(View view, vec3 v, float distance, mat3 axes, inout Splat splat, out float kept) {
  precise vec3 n = v / distance;
  vec3 first, second;
  tangent_axes(n, first, second);
  mat3 to_world = transpose(mat3(view.row_x.xyz, view.row_y.xyz, view.row_z.xyz));
  float gain = sqrt(view.lens.x * view.lens.y) / distance;
  precise vec3 e1 = gain * vec3(dot(first, to_world[0]), dot(first, to_world[1]), dot(first, to_world[2]));
  precise vec3 e2 = gain * vec3(dot(second, to_world[0]), dot(second, to_world[1]), dot(second, to_world[2]));
  vec3 across = vec3(dot_precise(e1, axes[0]), dot_precise(e1, axes[1]), dot_precise(e1, axes[2]));
  vec3 down = vec3(dot_precise(e2, axes[0]), dot_precise(e2, axes[1]), dot_precise(e2, axes[2]));
  vec4 conic = conic_of(across, down, LowPass(vec2(0.0), 1.0), kept);
  if (conic.w == 0.0) return false;
  // No wider than WIDEST_TANGENT.
  precise float det = 1.0 / conic.w / conic.w;
  precise float half_difference = 0.5 * (conic.x - conic.z);
  precise float most = 0.5 * (conic.x + conic.z) + sqrt(half_difference * half_difference + conic.y * conic.y);
  precise float least = float(1.0 / (WIDEST_TANGENT * WIDEST_TANGENT)) / (view.lens.x * view.lens.y);
  precise float more = max(0.0, least - det / most);
  precise vec4 limited = vec4(conic.x + more, conic.y, conic.z + more,
                              inversesqrt(det + more * (conic.x + conic.z + more)));
  splat.conic = limited;
  precise vec2 mean = n.xy / (1.0 + n.z);
  splat.mean = mean;
  splat.depth = -distance;
  return true;
}

bool project(View view, Gaussian g, mat3 axes, out Splat splat) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
  vec3 v = to_eye(view, d);
  precise vec3 away = d - view.eye.xyz;
  precise float distance = sqrt(dot_precise(away, away));
#if ORDER == ORDER_DISTANCE
  if (!(distance > view.anchor.w)) return false;
#else
  if (!(v.z > view.anchor.w)) return false;
#endif
  if (is_beside(view, v, distance, max(max(g.scale.x, g.scale.y), g.scale.z))) return false;
  splat.depth = distance;
  splat.colour = vec4(0.0);
  // As the affine projection without a limit to its slopes, at the distance in place of the depth.
  precise vec2 slope = v.xy / v.z;
  precise vec2 gain = view.lens.xy / distance;
  precise vec3 jx = gain.x * (view.row_x.xyz - slope.x * view.row_z.xyz);
  precise vec3 jy = gain.y * (view.row_y.xyz - slope.y * view.row_z.xyz);
  vec3 across = vec3(dot_precise(jx, axes[0]), dot_precise(jx, axes[1]), dot_precise(jx, axes[2]));
  vec3 down = vec3(dot_precise(jy, axes[0]), dot_precise(jy, axes[1]), dot_precise(jy, axes[2]));
  float kept;
  vec4 conic = vec4(0.0);
  if (v.z > 0.0) conic = conic_of(across, down, LowPass(slope, view.lens.x / view.lens.y), kept);
  // Narrow: both eigenvalues of Q, in slopes of the picture, are above WIDE_LEVEL.
  precise vec3 q = vec3(view.lens.x * view.lens.x * conic.x, view.lens.x * view.lens.y * conic.y,
                        view.lens.y * view.lens.y * conic.z);
  precise float det = view.lens.x * view.lens.y / conic.w;
  precise float over = det * det - float(WIDE_LEVEL) * (q.x + q.z - float(WIDE_LEVEL));
  if (v.z > 0.0 && conic.w > 0.0 && q.x > float(WIDE_LEVEL) && over > 0.0) {
    precise vec2 mean = view.lens.xy * slope + view.lens.zw - 0.5;
    splat.mean = mean;
    splat.conic = conic;
  } else if (!keep_wide(view, v, distance, axes, splat, kept)) {
    return false;
  }
  splat.opacity = g.position.w;
#if ANTIALIASED
  splat.opacity *= kept;
#endif
  return true;
}

// sqrt(det C2), in px^2 of the picture's middle: what a threshold goes by.
float size_of(View view, Splat splat) {
  if (is_wide(splat)) return splat.conic.w;
  vec2 slope = slope_at(view, splat.mean);
  precise float size = splat.conic.w / sqrt(1.0 + dot(slope, slope));
  return size;
}
