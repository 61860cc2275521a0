// The planes of flat Gaussians (2D Gaussian Splatting), by which blend_depth.glsl finds the depths of pixels.
layout(std430, binding = 5) writeonly buffer Discs { vec4 discs[]; };  // by splat: disc_of()
uniform uint is_flat;  // 1: the model has flat Gaussians

// The plane of a flat Gaussian: 1/z is linear in the pixel, with slope xy, from 1/(.z) at the mean. w: the most by
// which z may differ from the mean's. 0 if the Gaussian is seen edge-on or is behind the eye.
vec4 disc_of(View view, Gaussian g, mat3 axes) {
  vec3 v = to_eye(view, g.position.xyz - view.anchor.xyz);
  mat3 eye = mat3(view.row_x.xyz, view.row_y.xyz, view.row_z.xyz) / view.eye.w;  // columns: the eye's axes
  vec3 n = scaled_axes(Gaussian(g.position, g.rotation, vec4(1.0)))[2] * eye;
  float facing = dot(n, v);
  if (is_flat == 0u || g.scale.z != 0.0 || v.z <= 0.0 || abs(facing) < float(EDGE_ON) * v.z) return vec4(0.0);
  return vec4(n.xy / (facing * view.lens.xy), v.z, 3.0 * length(onto_axes(view.row_z.xyz, axes)));
}

void write_disc(uint splat, View view, Gaussian g, mat3 axes) { discs[splat] = disc_of(view, g, axes); }
