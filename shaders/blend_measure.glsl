// What a blend measures of each splat, MEASURE (shared/limits.h): a maximum or a sum over the pixels that it reaches. It is found
// in shared memory, and passed on to the buffer once a tile, which costs little beside the blend. Sums are of whole numbers, so
// that the order of the additions does not matter. With MEASURE_NONE all of this is empty. Part of blending.glsl.
#define SUMS_PICTURES (MEASURE == MEASURE_TRANSPOSED || MEASURE == MEASURE_CHANGES)
#if MEASURE == MEASURE_TRANSMITTANCE
#define MEASURED uint
#elif MEASURE == MEASURE_VISIBILITY
#define MEASURED int
#else
#define MEASURED ivec4
#endif

#if MEASURE != MEASURE_NONE
// Transmittance: by splat, bits of floats. Sums: by splat and channel, 64 bits, low first. Visibility: by splat,
// VISIBILITY_LOW_BITS and those above.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
shared MEASURED batch_measured[BATCH];
#endif
#if MEASURE == MEASURE_TRANSPOSED
uniform uint scale;  // bits of a float
#endif
#if SUMS_PICTURES
vec4 picture[COLUMN];  // transposed: scaled
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

// A splat is met where its alpha counts, in a block that the approximate blend leaves it out of, too.
#if MEASURE == MEASURE_TRANSMITTANCE && APPROXIMATE
bool is_met[COLUMN][AHEAD];
#define MEET(p, k, alpha) is_met[p][k] = alpha >= float(ALPHA_MIN)
#define IS_MET(p, k, weight) is_met[p][k]
#else
#define MEET(p, k, alpha)
#define IS_MET(p, k, weight) (weight > 0.0)
#endif

int visible = 0;  // of the splat at hand, in this invocation's pixels

// Transmittance: the most that a splat's alpha counts for in any pixel, T (docs/method.md 5). Visibility: what an error of its
// colour would count for, alpha T, times the T that an error of its alpha would. The transposed blend: the picture, by what the
// splat counts for. Changes: without the splat alone, what lies behind it, of which it leaves the share 1 - alpha, is in its
// place.
void measure(uint at, uint p, uint k, float weight) {
#if MEASURE == MEASURE_VISIBILITY
  float counted = transmittance[p] >= float(VISIBILITY_LEAST) ? weight * transmittance[p] : 0.0;
  visible += int(floor(counted * float(VISIBILITY_SCALE) + 0.5));
#elif MEASURE != MEASURE_NONE
  if (!IS_MET(p, k, weight)) return;
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

// A splat's pixels are done.
void end_measuring_splat(uint at) {
#if MEASURE == MEASURE_VISIBILITY
  if (visible != 0) atomicAdd(batch_measured[at], visible);
#endif
  visible = 0;
}

// A pixel shows nothing more whose visibility would be counted.
void end_where_nothing_is_measured(uint p) {
#if MEASURE == MEASURE_VISIBILITY
  if (transmittance[p] < float(VISIBILITY_LEAST) && !is_done(p)) {
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
#endif
}

// What a tile measured of a splat, to the buffer. Visibility in two parts without a carry, for which one would wait: there is room
// for 2^26 px, and for 2^18 tiles, in a picture that is half as large as those that are drawn, or less.
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
