// The blend of --precision half on GPUs that compute two halves at once (PACKED of blending.glsl): an invocation blends
// two pixels at a time. It blends each batch from T = 1, and adds the result in fp32, behind earlier batches. Halves
// alone would lose splats behind many others. The exponents of alphas are computed in fp32.
#define PIXEL_PAIRS (COLUMN / 2)
#define AT_ONCE (8 / COLUMN)  // splats per round of the loop; at most AHEAD

// Blends the first `count` splats of own_at(). It may read up to AHEAD more, which must be invisible.
void blend_batch(uint count) {
  const f16vec2 none = f16vec2(float16_t(0.0)), all = f16vec2(float16_t(1.0));
  f16vec2 red[PIXEL_PAIRS], green[PIXEL_PAIRS], blue[PIXEL_PAIRS], left[PIXEL_PAIRS];
  for (uint p = 0u; p < PIXEL_PAIRS; ++p) {
    red[p] = green[p] = blue[p] = none;
    left[p] = all;
  }
  vec2 z[PIXEL_PAIRS];
  for (uint p = 0u; p < PIXEL_PAIRS; ++p) z[p] = vec2(0.0);
  for (uint i = 0u; i < count; i += AT_ONCE) {
    f16vec2 alphas[PIXEL_PAIRS][AT_ONCE];
    uvec2 colours[AT_ONCE];
    float depths[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; ++k) {
      uint at = own_at(i + k);
      vec4 across = batch_across[at];
      vec4 down = batch_down[at];
      colours[k] = floatBitsToUint(down.zw);
      depths[k] = depth_of(at);
      float t = fma(across.x, column, across.y);
      float level = fma(t, t, across.w);
      float slope = fma(t, across.z, down.x);
      for (uint p = 0u; p < PIXEL_PAIRS; ++p) {
        vec2 rows = vec2(row[2u * p], row[2u * p + 1u]);
        f16vec2 exponent = f16vec2(-fma(rows, fma(rows, vec2(down.y), vec2(slope)), vec2(level)));
        // 1 if alpha is over 1/255, else 0. A saturated product of both halves is one instruction, a comparison four.
        f16vec2 is_seen = clamp(fma(exponent, f16vec2(float16_t(4096.0)), f16vec2(float16_t(32744.0))), none, all);
        alphas[p][k] = exp2(exponent) * is_seen;
      }
    }
    for (uint k = 0u; k < AT_ONCE; ++k) {
      f16vec2 rg = unpackFloat2x16(colours[k].x), b = unpackFloat2x16(colours[k].y);
      for (uint p = 0u; p < PIXEL_PAIRS; ++p) {
        f16vec2 weight = alphas[p][k] * left[p];
        red[p] = fma(weight, f16vec2(rg.x), red[p]);
        green[p] = fma(weight, f16vec2(rg.y), green[p]);
        blue[p] = fma(weight, f16vec2(b.x), blue[p]);
        if (DEPTH == DEPTH_MEAN) z[p] += vec2(weight) * depths[k];
        left[p] = clamp(fma(-alphas[p][k], left[p], left[p]), none, all);
      }
    }
  }
  for (uint p = 0u; p < COLUMN; ++p) {
    vec3 sum = vec3(float(red[p / 2u][p % 2u]), float(green[p / 2u][p % 2u]), float(blue[p / 2u][p % 2u]));
    float before = transmittance[p], after = before * float(left[p / 2u][p % 2u]);
    colour[p] += before * sum;
    z_sum[p] += before * z[p / 2u][p % 2u];
    if (after < least[p]) least[p] = -max(after, 1e-30);  // below 0: the pixel is done
    transmittance[p] = is_done(p) ? 0.0 : after;
  }
}
