// The projection of a Gaussian into a view (docs/method.md 2), without its colour. `precise`, because several programs
// compute it and must get the same bits.
//   ORDER        ORDER_ of shared/choices.h
//   PROJECTION   PROJECTION_ of shared/choices.h; its file is projection/NAME.glsl
#include "shared/choices.h"
#include "shared/types.h"
#ifndef REGIONS
#define REGIONS 0
#endif

// M of docs/method.md 2. Columns: the Gaussian's axes in the world, with the standard deviations as lengths.
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

float dot_precise(vec2 a, vec2 b) {
  precise float d = fma(a.x, b.x, a.y * b.y);
  return d;
}

// Transforms a point relative to the anchor into the eye's axes.
vec3 to_eye(View view, vec3 d) {
  precise float x = dot_precise(view.row_x.xyz, d) + view.row_x.w;
  precise float y = dot_precise(view.row_y.xyz, d) + view.row_y.w;
  precise float z = dot_precise(view.row_z.xyz, d) + view.row_z.w;
  return vec3(x, y, z);
}

// The low-pass: a variance of KERNEL_PX2 along x and y. With the tangent projection, `slope` is the slope of the ray,
// against which the picture's plane leans. `scale` stretches the axes; the product of its components is 1.
struct LowPass {
  vec2 slope;
  vec2 scale;
};

// Adds a low-pass to a determinant. `width` and `height`: the axes on the picture, scaled as the low-pass is.
float with_low_pass(float det, float low_pass, vec3 width, vec3 height, vec2 slope) {
  precise float sum = det + low_pass * (dot_precise(width, width) + dot_precise(height, height) + low_pass);
#if PROJECTION == PROJECTION_TANGENT
  precise vec3 lean = slope.x * height - slope.y * width;
  sum += low_pass * (dot_precise(lean, lean) + low_pass * dot_precise(slope, slope));
#endif
  return sum;
}

// Returns (Q.xx, Q.xy, Q.yy, sqrt(det C2)); w is 0 if the Gaussian is not drawn. `kept` is the factor of opacity that
// keeps the Gaussian's mass under the low-pass: sqrt(det P / det C2) (Mip-Splatting, Yu 2024). P is C2 without the
// low-pass, or with the share `free` of the low-pass. With s L the low-pass, det P = |across x down|^2 and det C2 = det
// P + s (L.yy |across|^2 - 2 L.xy across . down + L.xx |down|^2) + s^2 det L. The bracket is also a sum of squares, so
// all terms are positive. xx yy - xy^2 would cancel and lose the width of long thin splats.
vec4 conic_of(vec3 across, vec3 down, LowPass low, float free, out float kept) {
  const float s = float(KERNEL_PX2);
  precise float xx = dot_precise(across, across) + s * (low.scale.x * low.scale.x * (1.0 + low.slope.x * low.slope.x));
  precise float xy = dot_precise(across, down) + s * (low.slope.x * low.slope.y);
  precise float yy = dot_precise(down, down) + s * (low.scale.y * low.scale.y * (1.0 + low.slope.y * low.slope.y));
  kept = 0.0;
  // Scales by a power of two, so that no product overflows.
  int exponent = int(floatBitsToUint(max(xx, yy)) >> 23);
  if (exponent == 0 || exponent >= 254) return vec4(0.0);
  int size = (exponent - 127) >> 1;
  float unit = uintBitsToFloat(uint(127 - size) << 23);
  precise vec3 a = unit * across;
  precise vec3 d = unit * down;
  precise float low_pass = unit * s * unit;
  precise vec3 n = vec3(a.y * d.z - a.z * d.y, a.z * d.x - a.x * d.z, a.x * d.y - a.y * d.x);
  precise float det_p = dot_precise(n, n);
  precise vec3 width = low.scale.y * a;
  precise vec3 height = low.scale.x * d;
  precise float det = with_low_pass(det_p, low_pass, width, height, low.slope);
  if (!(det > 0.0)) return vec4(0.0);
#if REGIONS && !ANTIALIASED
  precise float free_pass = free * low_pass;
  det_p = with_low_pass(det_p, free_pass, width, height, low.slope);
#endif
  precise vec3 q = unit * vec3(yy, -xy, xx) * unit / det * unit * unit;
  precise float root = sqrt(det);
  precise float share = sqrt(det_p) / root;
  kept = free == 1.0 ? 1.0 : min(share, 1.0);
  precise float root_det = root / unit / unit;
  return vec4(q, root_det);
}

// The sort key, above 0 for a drawn Gaussian. Distances are computed in the world, so that their rounding does not
// depend on the head's rotation.
float order_depth(View view, Gaussian g) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
#if ORDER == ORDER_DISTANCE
  precise vec3 away = d - view.centre.xyz;
  precise float distance = view.eye.w * sqrt(dot_precise(away, away));
  return distance;
#else
  return to_eye(view, d).z;
#endif
}

vec3 onto_axes(vec3 direction, mat3 axes) {
  return vec3(dot_precise(direction, axes[0]), dot_precise(direction, axes[1]), dot_precise(direction, axes[2]));
}

// Projects the scaled axes to the picture, in px. `slope` is the slope of the ray, against which the picture's plane
// leans. `gain` is px per world unit.
void axes_on_picture(View view, vec2 slope, vec2 gain, mat3 axes, out vec3 across, out vec3 down) {
  precise vec3 jx = gain.x * (view.row_x.xyz - slope.x * view.row_z.xyz);
  precise vec3 jy = gain.y * (view.row_y.xyz - slope.y * view.row_z.xyz);
  across = onto_axes(jx, axes);
  down = onto_axes(jy, axes);
}

// The share of the low-pass that does not reduce opacity: 0 in anti-aliased models, otherwise 1, as trained. In a
// context, which has fewer pixels, the share is that of the full picture's low-pass, so that thin Gaussians are equally
// bright in context and inset.
float free_of(View view) {
#if ANTIALIASED
  return 0.0;
#elif REGIONS
  return view.low_pass_share;
#else
  return 1.0;
#endif
}

// Sets the opacity of a splat, and clears its colour. `kept` comes from conic_of().
void finish(View view, Gaussian g, float kept, inout Splat splat) {
  splat.opacity = view.opacity * g.position.w;
#if ANTIALIASED || REGIONS
  splat.opacity *= kept;
#endif
  splat.colour = vec4(0.0);
}

#include "projection/{PROJECTION_NAME}.glsl"
