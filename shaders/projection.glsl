// A Gaussian as a view sees it (docs/method.md 2), all but its colour. `precise` because several programs compute it and
// must get the same bits.
// Columns: the Gaussian's axes in the world, each as long as its standard deviation. M of docs/method.md 2.
mat3 scaled_axes(Gaussian g) {
  precise float w = g.rotation.x;
  precise float x = g.rotation.y;
  precise float y = g.rotation.z;
  precise float z = g.rotation.w;
  precise vec3 a = g.scale.x * vec3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
  precise vec3 b = g.scale.y * vec3(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x));
  precise vec3 c = g.scale.z * vec3(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
  return mat3(a, b, c);
}

float dot_precise(vec3 a, vec3 b) {
  precise float d = fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
  return d;
}

// The point relative to the anchor in the eye's axes.
vec3 to_eye(View view, vec3 d) {
  precise float x = dot_precise(view.row_x.xyz, d) + view.row_x.w;
  precise float y = dot_precise(view.row_y.xyz, d) + view.row_y.w;
  precise float z = dot_precise(view.row_z.xyz, d) + view.row_z.w;
  return vec3(x, y, z);
}

// Rows of J R^T M: the scaled axes as they fall on the picture, px. J is taken at v with its slopes clamped, because the
// linearisation blows up far outside the picture.
void axes_on_picture(View view, vec3 v, mat3 axes, out vec3 across, out vec3 down) {
  vec2 focal = view.lens.xy;
  precise vec2 slope = clamp(v.xy / v.z, view.slopes.xy, view.slopes.zw);
  precise vec2 gain = focal / v.z;
  precise vec3 jx = gain.x * (view.row_x.xyz - slope.x * view.row_z.xyz);
  precise vec3 jy = gain.y * (view.row_y.xyz - slope.y * view.row_z.xyz);
  across = vec3(dot_precise(jx, axes[0]), dot_precise(jx, axes[1]), dot_precise(jx, axes[2]));
  down = vec3(dot_precise(jy, axes[0]), dot_precise(jy, axes[1]), dot_precise(jy, axes[2]));
}

// (Q.xx, Q.xy, Q.yy, sqrt(det C2)), and the share of its mass that a Gaussian keeps under the low-pass: sqrt(det P / det C2), P
// being C2 without it (Mip-Splatting, Yu 2024). With s the low-pass, det P = |across x down|^2 and
// det C2 = det P + s (|across|^2 + |down|^2) + s^2: all are positive, so that what is long and thin keeps
// its width, which xx yy - xy^2 would lose. What is not drawn is told by w = 0.
vec4 conic_of(vec3 across, vec3 down, out float kept) {
  const float s = float(KERNEL_PX2);
  precise float xx = dot_precise(across, across) + s;
  precise float xy = dot_precise(across, down);
  precise float yy = dot_precise(down, down) + s;
  kept = 0.0;
  // A power of two takes the size out, so that no product overflows.
  int exponent = int(floatBitsToUint(max(xx, yy)) >> 23);
  if (exponent == 0 || exponent >= 254) return vec4(0.0);
  int size = (exponent - 127) >> 1;
  float unit = uintBitsToFloat(uint(127 - size) << 23);
  precise vec3 a = unit * across;
  precise vec3 d = unit * down;
  precise float low_pass = unit * s * unit;
  precise vec3 n = vec3(a.y * d.z - a.z * d.y, a.z * d.x - a.x * d.z, a.x * d.y - a.y * d.x);
  precise float det_p = dot_precise(n, n);
  precise float det = det_p + low_pass * (dot_precise(a, a) + dot_precise(d, d) + low_pass);
  if (!(det > 0.0)) return vec4(0.0);
  precise vec3 q = unit * vec3(yy, -xy, xx) * unit / det * unit * unit;
  precise float root = sqrt(det);
  precise float share = sqrt(det_p) / root;
  kept = min(share, 1.0);
  precise float root_det = root / unit / unit;
  return vec4(q, root_det);
}

// Everything but the colour and the level of Th. False where this view does not draw it.
bool project(View view, Gaussian g, mat3 axes, out Splat splat) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
  vec3 v = to_eye(view, d);
  if (!(v.z > view.anchor.w)) return false;
  vec3 across;
  vec3 down;
  axes_on_picture(view, v, axes, across, down);
  float kept;
  splat.conic = conic_of(across, down, kept);
  if (splat.conic.w == 0.0) return false;
  precise vec2 mean = view.lens.xy * (v.xy / v.z) + view.lens.zw - 0.5;
  splat.mean = mean;
  splat.depth = v.z;
  splat.opacity = g.position.w;
#if ANTIALIASED
  splat.opacity *= kept;
#endif
  splat.colour = vec4(0.0);
  return true;
}
