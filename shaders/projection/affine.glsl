// The affine projection of 3D-GS (Kerbl 2023): the perspective is made linear where the Gaussian lies.

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

// Everything but the colour and the level of Th. False where this view does not draw it.
bool project(View view, Gaussian g, mat3 axes, out Splat splat) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
  vec3 v = to_eye(view, d);
  if (!(v.z > view.anchor.w)) return false;
  vec3 across;
  vec3 down;
  axes_on_picture(view, v, axes, across, down);
  float kept;
  splat.conic = conic_of(across, down, LowPass(vec2(0.0), vec2(1.0)), kept);
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

bool is_wide(Splat splat) { return false; }

// sqrt(det C2), px^2: what a threshold goes by.
float size_of(View view, Splat splat) { return splat.conic.w; }
