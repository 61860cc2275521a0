// The value that a blend measures of each splat (MEASURE of shared/limits.h): a maximum or a sum over the pixels that
// the splat reaches. A tile accumulates the value in shared memory, and updates the buffer once per splat, to save
// time. Sums are integers, so the order of additions does not matter. Part of blending.glsl.
#define SUMS_PICTURES (MEASURE == MEASURE_TRANSPOSED || MEASURE == MEASURE_CHANGES)
#if MEASURE == MEASURE_TRANSMITTANCE
#define MEASURED uint
#elif MEASURE == MEASURE_VISIBILITY
#define MEASURED int
#else
#define MEASURED ivec4
#endif

#if MEASURE != MEASURE_NONE
// By splat. Transmittance: the bits of a float. Sums over pictures: 64 bits per channel, low word first. Visibility:
// two words, for the low VISIBILITY_LOW_BITS bits of each tile's sum and for the bits above.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
shared MEASURED batch_measured[BATCH];
#endif
#if MEASURE == MEASURE_TRANSPOSED
uniform uint scale;  // bits of a float
#endif
#if SUMS_PICTURES
vec4 picture[COLUMN];  // pixels of the stored picture; transposed: times `scale`
uint place_of(View view, uint p);
#endif

void clear_measured(uint at) {
#if MEASURE != MEASURE_NONE
  batch_measured[at] = MEASURED(0);
#endif
}

void begin_measuring(View view, uint p, bool inside) {
#if SUMS_PICTURES
  picture[p] = inside ? colours[place_of(view, p)] : vec4(0.0);
#endif
#if MEASURE == MEASURE_TRANSPOSED
  picture[p] *= uintBitsToFloat(scale);
#endif
}

// Whether a splat counts in a pixel: its alpha reaches ALPHA_MIN, even if the approximate blend drops it.
#if MEASURE == MEASURE_TRANSMITTANCE && APPROXIMATE
bool is_marked[COLUMN][AHEAD];
#define MARK(p, k, alpha) is_marked[p][k] = alpha >= float(ALPHA_MIN)
#define IS_MARKED(p, k, weight) is_marked[p][k]
#else
#define MARK(p, k, alpha)
#define IS_MARKED(p, k, weight) (weight > 0.0)
#endif

int visible = 0;  // the current splat's visibility in this invocation's pixels

// Adds a pixel to a splat's value. Transmittance: the largest T of a pixel in which the splat counts (docs/method.md
// 5). Visibility: alpha T^2, because an error of the colour has the weight alpha T, and an error of alpha the weight T.
// Transposed: the picture times alpha T. Changes: the squared change of the pixel without the splat. The colour behind
// it then appears: the rest of the picture, divided by T (1 - alpha).
void measure(uint at, uint p, uint k, float weight) {
#if MEASURE == MEASURE_VISIBILITY
  float counted = transmittance[p] >= float(VISIBILITY_LEAST) ? weight * transmittance[p] : 0.0;
  visible += int(floor(counted * float(VISIBILITY_SCALE) + 0.5));
#elif MEASURE != MEASURE_NONE
  if (!IS_MARKED(p, k, weight)) return;
#endif
#if MEASURE == MEASURE_TRANSMITTANCE
  atomicMax(batch_measured[at], floatBitsToUint(transmittance[p]));
#elif MEASURE == MEASURE_TRANSPOSED
  ivec4 steps = ivec4(floor(weight * picture[p] + 0.5));
#elif MEASURE == MEASURE_CHANGES
  vec3 own = batch_colour[at].rgb;
  vec3 behind = (picture[p].rgb - colour[p] - weight * own) / (transmittance[p] - weight);
  vec3 change = weight * (behind - own);
  ivec4 steps = ivec4(min(dot(change, change), float(CHANGE_MOST)) * float(CHANGE_SCALE) + 0.5, 0.0, 0.0, 0.0);
#endif
#if SUMS_PICTURES
  for (int c = 0; c < 4; ++c) {
    if (steps[c] != 0) atomicAdd(batch_measured[at][c], steps[c]);
  }
#endif
}

// Call it after measure() of all pixels of a splat.
void end_measuring_splat(uint at) {
#if MEASURE == MEASURE_VISIBILITY
  if (visible != 0) atomicAdd(batch_measured[at], visible);
#endif
  visible = 0;
}

// Ends a pixel once its T is too small for visibility.
void end_where_nothing_is_measured(uint p) {
#if MEASURE == MEASURE_VISIBILITY
  if (transmittance[p] < float(VISIBILITY_LEAST) && !is_done(p)) {
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
#endif
}

// Updates the buffer by a tile's value of a splat. Visibility has two words without a carry: with a carry the second
// atomic would wait for the first. The words have room for 2^26 px and 2^18 tiles, enough for a visibility pass, which
// has at most half the size of a drawn picture.
void pass_on(uint splat, uint batch_at) {
#if MEASURE == MEASURE_TRANSMITTANCE
  uint most = batch_measured[batch_at];
  if (most != 0u) atomicMax(measured[splat], most);
#elif MEASURE == MEASURE_VISIBILITY
  int sum = batch_measured[batch_at];
  uint low = uint(sum) & ((1u << VISIBILITY_LOW_BITS) - 1u), high = uint(sum) >> VISIBILITY_LOW_BITS;
  if (low != 0u) atomicAdd(measured[2u * splat], low);
  if (high != 0u) atomicAdd(measured[2u * splat + 1u], high);
#elif SUMS_PICTURES
  for (uint c = 0u; c < 4u; ++c) {
    int sum = batch_measured[batch_at][c];
    if (sum == 0) continue;
    uint at = 2u * (4u * splat + c);
    uint before = atomicAdd(measured[at], uint(sum));
    uint above = (sum < 0 ? 0xffffffffu : 0u) + (before + uint(sum) < before ? 1u : 0u);
    if (above != 0u) atomicAdd(measured[at + 1u], above);
  }
#endif
}
