// --precision half: what a frame keeps of Gaussians and splats in 32 bytes each, most of it in fp16. Both are computed with in
// fp32. C++ packs the same in render/halves.h. `precise` because several programs pack, and a last bit can turn a half.

// Position, and the largest scale; the scales as shares of it, opacity, rotation.
Gaussian unpack_gaussian(uvec4 low, uvec4 high) {
  vec2 xy = unpackHalf2x16(high.x), z_opacity = unpackHalf2x16(high.y);
  vec4 place = uintBitsToFloat(low);
  vec4 rotation = vec4(unpackHalf2x16(high.z), unpackHalf2x16(high.w));
  return Gaussian(vec4(place.xyz, z_opacity.y), rotation, vec4(place.w * vec3(xy, z_opacity.x), 0.0));
}

uvec4 packed_place(Gaussian g) {
  return floatBitsToUint(vec4(g.position.xyz, max(g.scale.x, max(g.scale.y, g.scale.z))));
}

uvec4 packed_shape(Gaussian g) {
  precise vec3 shares = g.scale.xyz / max(max(g.scale.x, max(g.scale.y, g.scale.z)), 1e-37);
  return uvec4(packHalf2x16(shares.xy), packHalf2x16(vec2(shares.z, g.position.w)), packHalf2x16(g.rotation.xy),
               packHalf2x16(g.rotation.zw));
}

// Mean, depth and rho in fp32. Of the conic Q = L L^T the factor L, whose rounding cannot turn an ellipse inside out, times a
// power of two: fp16 then holds splats from 1/255 to four million px.
#define HALF_FACTOR 256.0
#define HALF_LEAST 6.1035156e-05
#define HALF_MOST 65504.0

Splat unpack_splat(uvec4 low, uvec4 high) {
  vec2 xx_yx = unpackHalf2x16(high.x) / HALF_FACTOR, yy_opacity = unpackHalf2x16(high.y), b = unpackHalf2x16(high.z);
  precise float xx = xx_yx.x;
  precise float yx = xx_yx.y;
  precise float yy = yy_opacity.x / HALF_FACTOR;
  precise vec4 conic = vec4(xx * xx, xx * yx, yx * yx + yy * yy, 1.0 / (xx * yy));
  vec2 rg = unpackHalf2x16(low.w);
  Splat splat;
  splat.mean = uintBitsToFloat(low.xy);
  splat.depth = uintBitsToFloat(low.z);
  splat.opacity = yy_opacity.y;
  splat.conic = conic;
  splat.colour = vec4(rg, b.x, uintBitsToFloat(high.w));
  return splat;
}

uvec4 packed_place(Splat splat) {
  return uvec4(floatBitsToUint(vec3(splat.mean, splat.depth)), packHalf2x16(min(splat.colour.rg, HALF_MOST)));
}

uvec4 packed_shape(Splat splat) {
  // Roots and quotients differ by compilers' choices, this does not.
  precise float inverse = inversesqrt(splat.conic.x);
  precise float xx = splat.conic.x * inverse;
  precise float yx = splat.conic.y * inverse;
  precise float yy = inversesqrt(splat.conic.w * splat.conic.w * splat.conic.x);
  precise vec3 factor =
      clamp(HALF_FACTOR * vec3(xx, yx, yy), vec3(HALF_LEAST, -HALF_MOST, HALF_LEAST), vec3(HALF_MOST));
  return uvec4(packHalf2x16(factor.xy), packHalf2x16(vec2(factor.z, splat.opacity)),
               packHalf2x16(vec2(min(splat.colour.b, HALF_MOST), 0.0)), floatBitsToUint(splat.colour.w));
}

// What is left of a splat that was written.
Splat rounded(Splat splat) { return unpack_splat(packed_place(splat), packed_shape(splat)); }
