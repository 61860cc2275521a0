// The affine projection of 3D-GS (Kerbl 2023): linearises the perspective at the Gaussian's position.

// Computes all members of the splat except the colour and rho. Returns false if the view does not draw the Gaussian.
bool project(View view, Gaussian g, mat3 axes, out Splat splat) {
  precise vec3 d = g.position.xyz - view.anchor.xyz;
  vec3 v = to_eye(view, d);
  if (!(v.z > view.anchor.w)) return false;
  vec3 across;
  vec3 down;
  // J uses clamped slopes, because the linearisation grows without limit far outside the picture.
  precise vec2 slope = clamp(v.xy / v.z, view.slopes.xy, view.slopes.zw);
  precise vec2 gain = view.lens.xy / v.z;
  axes_on_picture(view, slope, gain, axes, across, down);
  float kept;
  splat.conic = conic_of(across, down, LowPass(vec2(0.0), vec2(1.0)), free_of(view), kept);
  if (splat.conic.w == 0.0) return false;
  precise vec2 mean = view.lens.xy * (v.xy / v.z) + view.lens.zw - 0.5;
  splat.mean = mean;
  splat.depth = v.z;
  finish(view, g, kept, splat);
  return true;
}

bool is_wide(Splat splat) { return false; }

// The size that a threshold rule uses: sqrt(det C2), px^2.
float size_of(View view, Splat splat) { return splat.conic.w; }
