// --precision half: Gaussians and splats in 32 bytes each, mostly in fp16; computations are in fp32. C++ packs the same
// in render/halves.h. Values are `precise`, because several programs pack the same value, and a different last bit may
// round to a different half.

// A unit quaternion has 20 bits for each component except the largest, which follows from the others. With fp16's 11
// bits a needle that is thousands of pixels long would visibly point in a wrong direction.
#define ROTATION_STEPS 741454.0  // steps per unit: sqrt(1/2), the largest stored component, has 2^19 - 1

vec4 unpack_rotation(uvec2 bits) {
  uvec3 steps = uvec3(bits.x, bits.x >> 20 | bits.y << 12, bits.y >> 8) & 0xFFFFFu;
  precise vec3 q = (vec3(steps) - 524288.0) / ROTATION_STEPS;
  precise float rest = 1.0 - fma(q.x, q.x, fma(q.y, q.y, q.z * q.z));
  precise float largest = sqrt(max(0.0, rest));
  switch (bits.y >> 28) {
    case 0u: return vec4(largest, q);
    case 1u: return vec4(q.x, largest, q.yz);
    case 2u: return vec4(q.xy, largest, q.z);
    default: return vec4(q, largest);
  }
}

uvec2 packed_rotation(vec4 q) {
  vec4 size = abs(q);
  float most = max(max(size.x, size.y), max(size.z, size.w));
  uint largest = size.x == most ? 0u : size.y == most ? 1u : size.z == most ? 2u : 3u;
  vec3 others = largest == 0u ? q.yzw : largest == 1u ? q.xzw : largest == 2u ? q.xyw : q.xyz;
  uvec3 steps = uvec3(clamp(round(others * (q[largest] < 0.0 ? -ROTATION_STEPS : ROTATION_STEPS)) + 524288.0, 0.0, 1048575.0));
  return uvec2(steps.x | steps.y << 20, steps.y >> 12 | steps.z << 8 | largest << 28);
}

// `low` has position and largest scale. `high` has the scales divided by the largest scale, opacity and rotation.
Gaussian unpack_gaussian(uvec4 low, uvec4 high) {
  vec2 xy = unpackHalf2x16(high.x), z_opacity = unpackHalf2x16(high.y);
  vec4 place = uintBitsToFloat(low);
  return Gaussian(vec4(place.xyz, z_opacity.y), unpack_rotation(high.zw), vec4(place.w * vec3(xy, z_opacity.x), 0.0));
}

uvec4 packed_place(Gaussian g) {
  return floatBitsToUint(vec4(g.position.xyz, max(g.scale.x, max(g.scale.y, g.scale.z))));
}

uvec4 packed_shape(Gaussian g) {
  precise vec3 shares = g.scale.xyz / max(max(g.scale.x, max(g.scale.y, g.scale.z)), 1e-37);
  return uvec4(packHalf2x16(shares.xy), packHalf2x16(vec2(shares.z, g.position.w)), packed_rotation(g.rotation));
}

// Mean, depth and rho are in fp32. The conic Q = L L^T is stored as its factor L, whose rounding cannot turn an ellipse
// inside out. A power of two scales L, so that fp16 stores standard deviations from 1/255 to four million px. L.yx is
// stored as the sum of two halves, and computed for the rounded L.xx: the ratio L.yx / L.xx is a needle's direction.
#define HALF_FACTOR 256.0
#define HALF_MIN 6.1035156e-05
#define HALF_MAX 65504.0

Splat unpack_splat(uvec4 low, uvec4 high) {
  vec2 xx_yx = unpackHalf2x16(high.x) / HALF_FACTOR, yy_opacity = unpackHalf2x16(high.y), b_yx = unpackHalf2x16(high.z);
  precise float xx = xx_yx.x;
  precise float yx = xx_yx.y + b_yx.y / HALF_FACTOR;
  precise float yy = yy_opacity.x / HALF_FACTOR;
  precise vec4 conic = vec4(xx * xx, xx * yx, yx * yx + yy * yy, 1.0 / (xx * yy));
  vec2 rg = unpackHalf2x16(low.w);
  Splat splat;
  splat.mean = uintBitsToFloat(low.xy);
  splat.depth = uintBitsToFloat(low.z);
  splat.opacity = yy_opacity.y;
  splat.conic = conic;
  splat.colour = vec4(rg, b_yx.x, uintBitsToFloat(high.w));
  return splat;
}

uvec4 packed_place(Splat splat) {
  return uvec4(floatBitsToUint(vec3(splat.mean, splat.depth)), packHalf2x16(min(splat.colour.rg, HALF_MAX)));
}

uvec4 packed_shape(Splat splat) {
  // Compilers give different bits for roots and quotients, but equal bits for inversesqrt().
  precise float inverse = inversesqrt(splat.conic.x);
  precise float xx = splat.conic.x * inverse;
  precise float yx = splat.conic.y * inverse;
  precise float yy = inversesqrt(splat.conic.w * splat.conic.w * splat.conic.x);
  precise vec2 factor = clamp(HALF_FACTOR * vec2(xx, yy), vec2(HALF_MIN), vec2(HALF_MAX));
  if (splat.conic.w < 0.0) factor.y = -factor.y;  // unpack_splat() returns the sign (projection/tangent.glsl)
  precise float kept_xx = unpackHalf2x16(packHalf2x16(vec2(factor.x, 0.0))).x;
  precise float leaning = clamp(yx / xx * kept_xx, -HALF_MAX, HALF_MAX);
  precise float rest = leaning - unpackHalf2x16(packHalf2x16(vec2(leaning, 0.0))).x;
  return uvec4(packHalf2x16(vec2(factor.x, leaning)), packHalf2x16(vec2(factor.y, splat.opacity)),
               packHalf2x16(vec2(min(splat.colour.b, HALF_MAX), rest)), floatBitsToUint(splat.colour.w));
}

// The splat as unpack_splat() returns it after packing.
Splat rounded(Splat splat) { return unpack_splat(packed_place(splat), packed_shape(splat)); }
