// Spherical harmonics of 3D-GS (real, with Condon-Shortley signs), evaluated along a unit direction in world axes.
// SH_DEGREE is the model's. Coefficients are packed without gaps: coefficient k is floats 3k to 3k + 2.

//   HALF   1: eight coefficients in four words
#define SH_VEC4S ((3 * (SH_DEGREE + 1) * (SH_DEGREE + 1) + 3) / 4)

#if HALF
#define SH_UVEC4S ((SH_VEC4S + 1) / 2)
layout(std430, binding = 2) readonly buffer Harmonics { uvec4 harmonics[]; };
#else
layout(std430, binding = 2) readonly buffer Harmonics { vec4 harmonics[]; };
#endif

#define SH_FLOAT(i) coefficients[(i) / 4][(i) % 4]
#define SH(k) vec3(SH_FLOAT(3 * (k)), SH_FLOAT(3 * (k) + 1), SH_FLOAT(3 * (k) + 2))

vec3 sh_colour(uint gaussian, vec3 d) {
#if HALF
  vec4 coefficients[2 * SH_UVEC4S];
  for (int i = 0; i < SH_UVEC4S; ++i) {
    uvec4 eight = harmonics[gaussian * uint(SH_UVEC4S) + uint(i)];
    coefficients[2 * i] = vec4(unpackHalf2x16(eight.x), unpackHalf2x16(eight.y));
    coefficients[2 * i + 1] = vec4(unpackHalf2x16(eight.z), unpackHalf2x16(eight.w));
  }
#else
  vec4 coefficients[SH_VEC4S];
  for (int i = 0; i < SH_VEC4S; ++i) coefficients[i] = harmonics[gaussian * uint(SH_VEC4S) + uint(i)];
#endif

  precise vec3 c = 0.28209479177387814 * SH(0) + 0.5;
#if SH_DEGREE >= 1
  precise float x = d.x;
  precise float y = d.y;
  precise float z = d.z;
  c += 0.4886025119029199 * (-y * SH(1) + z * SH(2) - x * SH(3));
#endif
#if SH_DEGREE >= 2
  precise float xx = x * x;
  precise float yy = y * y;
  precise float zz = z * z;
  c += (1.0925484305920792 * x * y) * SH(4);
  c += (-1.0925484305920792 * y * z) * SH(5);
  c += (0.31539156525252005 * (2.0 * zz - xx - yy)) * SH(6);
  c += (-1.0925484305920792 * x * z) * SH(7);
  c += (0.5462742152960396 * (xx - yy)) * SH(8);
#endif
#if SH_DEGREE >= 3
  c += (-0.5900435899266435 * y * (3.0 * xx - yy)) * SH(9);
  c += (2.890611442640554 * x * y * z) * SH(10);
  c += (-0.4570457994644658 * y * (4.0 * zz - xx - yy)) * SH(11);
  c += (0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy)) * SH(12);
  c += (-0.4570457994644658 * x * (4.0 * zz - xx - yy)) * SH(13);
  c += (1.445305721320277 * z * (xx - yy)) * SH(14);
  c += (-0.5900435899266435 * x * (xx - 3.0 * yy)) * SH(15);
#endif
  return max(c, 0.0);
}
