// The depth of a pixel that a blend computes, DEPTH (shared/limits.h). Part of blending.glsl.
#if DISCS
layout(std430, binding = 11) readonly buffer Discs { vec4 discs[]; };  // by splat: project_discs.glsl
shared vec4 batch_disc[BATCH];
shared vec2 batch_mean[BATCH];  // from the middle of the cell
void stage_disc(uint at, uint splat, vec2 mean) {
  batch_disc[at] = discs[splat];
  batch_mean[at] = mean - middle;
}

void stage_no_disc(uint at) { batch_disc[at] = vec4(0.0); }

// The depth of a splat of the batch in a pixel: of a flat Gaussian where the ray meets its plane, of others `centre`.
float depth_in(uint p, uint at, float centre) {
  vec4 disc = batch_disc[at];
  precise vec2 d = vec2(column, row[p]) - batch_mean[at];
  precise float inverse = fma(disc.x, d.x, fma(disc.y, d.y, 1.0 / disc.z));
  precise float z = clamp(inverse > 0.0 ? 1.0 / inverse : 3e38, disc.z - disc.w, disc.z + disc.w);
  return disc.z == 0.0 ? centre : from_view_z(p, z);
}
#else
#define stage_disc(at, splat, mean)
#define stage_no_disc(at)
#define depth_in(p, at, centre) centre
#endif

// Whether a pixel gets a median depth: the depth of the splat at which T falls below a half.
#define HAS_MEDIAN(p) (DEPTH == DEPTH_MEDIAN || DEPTH == DEPTH_MEDIAN_OF_TWO_ROWS && p % 2u == 0u)
const float half_left = 1.0 - float(COVERAGE_FOR_DEPTH);

// The depth of the first splat of `at` after which T is below a half. There must be such a splat.
float median_depth(uint p, uint at[AHEAD], float weights[AHEAD], float before) {
  for (uint k = 0u; k < AHEAD; ++k) {
    precise float left = before - weights[k];
    if (left < half_left) return depth_in(p, at[k], depth_of(at[k]));
    before = left;
  }
  return depth_in(p, at[AHEAD - 1u], depth_of(at[AHEAD - 1u]));
}

void add_depth(uint p, float weight, float depth) {
  if (DEPTH == DEPTH_MEAN) {
    precise float z = fma(weight, depth, z_sum[p]);
    z_sum[p] = z;
  }
  if (DEPTH == DEPTH_VISIBILITY) z_sum[p] += weight * transmittance[p];
}

// Writes the depth of a pixel, of which the transmittance `left` remains. The caller's images get depths, or the
// mesh's where the pixel is mostly transparent; other pictures get sums.
#if DEPTH == DEPTH_NONE
void write_depth(uint to, uint p, float left) {}
#else
layout(std430, binding = 5) writeonly buffer ZSums { float z_sums[]; };

void write_depth(uint to, uint p, float left) {
  float z = DEPTH == DEPTH_VISIBILITY ? z_sum[p] : view_z_of(p, z_sum[p]);
  if (CANVASES == 1 || MESH_DEPTH == 1) {
    float behind = view_z_of(p, mesh_behind(p));
    if (left >= half_left) z = behind;
    else if (DEPTH == DEPTH_MEAN) z /= 1.0 - left;
  } else if (DEPTH == DEPTH_MEDIAN) {
    precise float sum = z * (1.0 - left);
    z = sum;
  }
  if (DEPTH != DEPTH_MEDIAN_OF_TWO_ROWS || p % 2u == 0u) z_sums[to] = z;
}
#endif
