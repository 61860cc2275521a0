// The depth of a pixel that a blend computes, DEPTH (shared/limits.h). Part of blending.glsl.
#if DEPTH != DEPTH_NONE
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };
#endif

// Whether a pixel gets a median depth: the depth of the splat at which T falls below a half.
#define HAS_MEDIAN(p) (DEPTH == DEPTH_MEDIAN || DEPTH == DEPTH_MEDIAN_OF_TWO_ROWS && p % 2u == 0u)
const float half_left = 1.0 - float(COVERAGE_FOR_DEPTH);

// The depth of the first splat of `at` after which T is below a half. There must be such a splat.
float median_depth(uint at[AHEAD], float weights[AHEAD], float before) {
  for (uint k = 0u; k < AHEAD; ++k) {
    precise float left = before - weights[k];
    if (left < half_left) return depth_of(at[k]);
    before = left;
  }
  return depth_of(at[AHEAD - 1u]);
}

void add_depth(uint p, float weight, float depth) {
#if DEPTH == DEPTH_MEAN
  precise float z = fma(weight, depth, z_sum[p]);
  z_sum[p] = z;
#elif DEPTH == DEPTH_VISIBILITY
  z_sum[p] += weight * transmittance[p];
#endif
}

// `left` is the pixel's remaining transmittance.
void write_depth(uint to, uint p, float left) {
#if DEPTH != DEPTH_NONE
  precise float behind = mesh_behind(p);
#if PROJECTION == PROJECTION_TANGENT && DEPTH != DEPTH_VISIBILITY
  precise float along = z_sum[p] * sqrt(nearness[p]);  // converts distances to view z
  z_sum[p] = along;
  behind *= sqrt(nearness[p]);
#endif
#if CANVASES || MESH_DEPTH
  if (left >= half_left) z_sum[p] = behind;
#if DEPTH == DEPTH_MEAN
  else z_sum[p] /= 1.0 - left;
#endif
#elif DEPTH == DEPTH_MEDIAN
  precise float cover = 1.0 - left;
  precise float z = z_sum[p] * cover;
  z_sum[p] = z;
#endif
  if (DEPTH != DEPTH_MEDIAN_OF_TWO_ROWS || p % 2u == 0u) z_sums[to] = z_sum[p];
#endif
}
