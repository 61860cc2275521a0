// The tangent projection (docs/method.md 2.2) drops a unit ray d at a right angle onto the plane that touches the unit
// sphere in the Gaussian's direction. The Gaussian's covariance in that plane gives alpha, so turning the head changes
// nothing. In the picture q = (p - mean)^T Q (p - mean) / |d|^2, with |d| the length of p's ray with d.z = 1. A splat
// stores Q and sqrt(det Q^-1). A negative depth marks a wide splat, whose level lines need not be ellipses. A negative
// sqrt(det Q^-1) marks a Gaussian behind the eye. The stored mean is then the point at which the line through Gaussian
// and eye meets the picture's plane.

// The largest squared sine of the angle between a visible ray and the Gaussian, as a multiple of the variance in the
// tangent plane: slightly more than 2 ln 255.
#define LEVEL_MAX 11.2
// The smallest |z| of a Gaussian's unit direction. A direction parallel to the picture's plane would have no mean.
#if HALF
#define RISE_MIN 1e-3  // so that fp16 holds the conic
#else
#define RISE_MIN 3e-4
#endif

bool is_wide(Splat splat) { return splat.depth < 0.0; }

vec2 slope_at(View view, vec2 pixel) {
  precise vec2 slope = (pixel + 0.5 - view.lens.zw) / view.lens.xy;
  return slope;
}

// Packs the direction of a wide splat into the bits of a float. Bytes suffice: they decide only whether a ray is within
// a right angle of the direction, and the splat fades long before.
float direction_in_bytes(View view, Splat splat) {
  vec3 direction = vec3(slope_at(view, splat.mean), 1.0);
  return uintBitsToFloat(packSnorm4x8(vec4(sign(splat.conic.w) * normalize(direction), 0.0)));
}

vec3 direction_of(float bytes) { return unpackSnorm4x8(floatBitsToUint(bytes)).xyz; }

// Whether a Gaussian at v is too far from all rays of the picture to be visible.
bool is_beside(View view, vec3 v, float distance, vec3 scale) {
  float spread = view.eye.w * max(max(scale.x, scale.y), scale.z) / distance;
  float variance = spread * spread + float(KERNEL_PX2) / (view.lens.x * view.lens.y);
  float sine2 = LEVEL_MAX * min(variance, float(WIDEST_TANGENT) * float(WIDEST_TANGENT));
  float cosine = (sqrt(1.0 - sine2) - sqrt(sine2 * view.centre.w)) / sqrt(1.0 + view.centre.w);
  return v.z < distance * (cosine - 1e-4);
}

// Returns the conic of a wide splat at v, with limited width; w has the sign of v.z. Computes it in the tangent plane:
// terms would cancel in the picture's plane, which may be nearly parallel to the direction.
vec4 wide_conic(View view, vec3 v, float distance, mat3 axes, out float kept) {
  precise vec3 n = v / distance;
  vec3 least = abs(n.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  precise vec3 aside = least.yzx * n.zxy - least.zxy * n.yzx;  // cross products
  precise vec3 first = aside / sqrt(dot_precise(aside, aside));
  precise vec3 second = n.yzx * first.zxy - n.zxy * first.yzx;
  precise float focal = sqrt(view.lens.x * view.lens.y);
  precise float gain = focal / distance;
  precise vec3 along = gain * (first.x * view.row_x.xyz + first.y * view.row_y.xyz + first.z * view.row_z.xyz);
  precise vec3 down = gain * (second.x * view.row_x.xyz + second.y * view.row_y.xyz + second.z * view.row_z.xyz);
  vec4 q = conic_of(onto_axes(along, axes), onto_axes(down, axes), LowPass(vec2(0.0), vec2(1.0)), free_of(view), kept);
  if (q.w == 0.0) return q;
  // Limits the width to WIDEST_TANGENT by adding the same number to both eigenvalues of the conic.
  precise float half_difference = 0.5 * (q.x - q.z);
  precise float most = 0.5 * (q.x + q.z) + sqrt(half_difference * half_difference + q.y * q.y);
  precise float det = 1.0 / (q.w * q.w);
  precise float more = max(0.0, 1.0 / (float(WIDEST_TANGENT * WIDEST_TANGENT) * focal * focal) - det / most);
  precise float grown = det + more * (q.x + q.z + more);
  // The conic is the sum of the squares of two rows, which are transformed to the picture.
  precise float root = sqrt(q.x + more);
  precise vec2 scale = focal / view.lens.xy;
  precise vec2 upper = scale * (root * first.xy + q.y / root * second.xy);
  precise vec2 lower = scale * (sqrt(grown) / root * second.xy);
  precise vec4 conic = vec4(upper.x * upper.x + lower.x * lower.x, upper.x * upper.y + lower.x * lower.y,
                            upper.y * upper.y + lower.y * lower.y, inversesqrt(grown) / n.z);
  return conic;
}

bool project(View view, Gaussian g, mat3 axes, out Splat splat) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
  vec3 v = to_eye(view, d);
  precise vec3 away = d - view.eye.xyz;
  precise float distance = view.eye.w * sqrt(dot_precise(away, away));
#if ORDER == ORDER_DISTANCE
  if (!(distance > view.anchor.w)) return false;
#else
  if (!(v.z > view.anchor.w)) return false;
#endif
  if (v.z < 0.0 && is_beside(view, v, distance, g.scale.xyz)) return false;
  if (abs(v.z) < RISE_MIN * distance) v.z = v.z < 0.0 ? -RISE_MIN * distance : RISE_MIN * distance;
  // Same as the affine projection without clamped slopes, with the distance instead of the depth.
  precise vec2 slope = v.xy / v.z;
  precise vec2 gain = view.lens.xy / distance;
  vec3 across;
  vec3 down;
  axes_on_picture(view, slope, gain, axes, across, down);
  precise float stretch = sqrt(view.lens.x / view.lens.y);
  float kept;
  splat.conic = conic_of(across, down, LowPass(slope, vec2(stretch, 1.0 / stretch)), free_of(view), kept);
  if (splat.conic.w == 0.0) return false;
  splat.depth = distance;
  // Wide: an eigenvalue of Q, in slopes of the picture, is at most WIDE_LEVEL.
  precise vec2 q = view.lens.xy * view.lens.xy * splat.conic.xz;
  precise float root = view.lens.x * view.lens.y / splat.conic.w;
  precise float above = root * root - float(WIDE_LEVEL) * (q.x + q.y - float(WIDE_LEVEL));
  if (v.z < 0.0 || q.x <= float(WIDE_LEVEL) || above <= 0.0) {
    if (v.z > 0.0 && is_beside(view, v, distance, g.scale.xyz)) return false;
    splat.conic = wide_conic(view, v, distance, axes, kept);
    if (splat.conic.w == 0.0) return false;
    splat.depth = -distance;
  }
  precise vec2 mean = view.lens.xy * slope + view.lens.zw - 0.5;
  splat.mean = mean;
  finish(view, g, kept, splat);
  return true;
}

// The size that a threshold rule uses: sqrt(det C2), in px^2 at the middle of the picture.
float size_of(View view, Splat splat) {
  vec2 slope = slope_at(view, splat.mean);
  precise float size = abs(splat.conic.w) / sqrt(1.0 + dot_precise(slope, slope));
  return size;
}
