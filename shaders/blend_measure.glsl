// What a blend measures of each splat, MEASURE (shared/limits.h): a maximum or a sum over the pixels that it reaches. It is found
// in shared memory, and passed on to the buffer once a tile, which costs little beside the blend. Sums are of whole numbers, so
// that the order of the additions does not matter. Without MEASURE nothing of this is there. Part of blending.glsl.
#if MEASURE == MEASURE_NONE

void clear_measured(uint at) {}
void begin_measuring(View view, uint p, bool inside) {}
void measure_alpha(uint p, uint k, float alpha) {}
void begin_measuring_splat() {}
void measure(uint at, uint p, uint k, float weight) {}
void end_measuring_splat(uint at) {}
void pass_on(uint splat, uint at) {}

#else

// Transmittance: by splat, bits of floats. Sums: by splat and channel, 64 bits, low first. Visibility: by splat,
// VISIBILITY_LOW_BITS and those above.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
#if MEASURE == MEASURE_TRANSMITTANCE
#define MEASURED uint
#elif MEASURE == MEASURE_VISIBILITY
#define MEASURED int
#else
#define MEASURED ivec4
#endif
shared MEASURED batch_measured[BATCH];

void clear_measured(uint at) { batch_measured[at] = MEASURED(0); }

#endif

#if MEASURE == MEASURE_TRANSMITTANCE

void begin_measuring(View view, uint p, bool inside) {}
void begin_measuring_splat() {}
void end_measuring_splat(uint at) {}

// A splat is met where its alpha counts, in a block that the approximate blend leaves it out of, too.
#if APPROXIMATE
bool is_met[COLUMN][AHEAD];
void measure_alpha(uint p, uint k, float alpha) { is_met[p][k] = alpha >= float(ALPHA_MIN); }
#define IS_MET(p, k, weight) is_met[p][k]
#else
void measure_alpha(uint p, uint k, float alpha) {}
#define IS_MET(p, k, weight) (weight > 0.0)
#endif

// The most that a splat's alpha counts for in any pixel: T (docs/method.md 5).
void measure(uint at, uint p, uint k, float weight) {
  if (IS_MET(p, k, weight)) atomicMax(batch_measured[at], floatBitsToUint(transmittance[p]));
}

void pass_on(uint splat, uint at) {
  uint most = batch_measured[at];
  if (most != 0u) atomicMax(measured[splat], most);
}

#elif MEASURE == MEASURE_VISIBILITY

int visible;  // of the splat at hand, in this invocation's pixels

void begin_measuring(View view, uint p, bool inside) {}
void measure_alpha(uint p, uint k, float alpha) {}
void begin_measuring_splat() { visible = 0; }

// What an error of the splat's colour would count for, alpha T, times the T that an error of its alpha would.
void measure(uint at, uint p, uint k, float weight) {
  float counted = transmittance[p] >= float(VISIBILITY_LEAST) ? weight * transmittance[p] : 0.0;
  visible += int(floor(counted * float(VISIBILITY_SCALE) + 0.5));
}

void end_measuring_splat(uint at) {
  if (visible != 0) atomicAdd(batch_measured[at], visible);
}

// In two parts without a carry, for which one would wait: there is room for 2^26 px, and for 2^18 tiles, in a picture that is
// half as large as those that are drawn, or less.
void pass_on(uint splat, uint at) {
  int sum = batch_measured[at];
  uint low = uint(sum) & ((1u << VISIBILITY_LOW_BITS) - 1u), high = uint(sum) >> VISIBILITY_LOW_BITS;
  if (low != 0u) atomicAdd(measured[2u * splat], low);
  if (high != 0u) atomicAdd(measured[2u * splat + 1u], high);
}

#elif MEASURE != MEASURE_NONE

#if MEASURE == MEASURE_TRANSPOSED
uniform uint scale;  // bits of a float
#endif
vec4 picture[COLUMN];  // transposed: scaled
uint place_of(View view, uint p);

void measure_alpha(uint p, uint k, float alpha) {}
void begin_measuring_splat() {}
void end_measuring_splat(uint at) {}

void begin_measuring(View view, uint p, bool inside) {
  picture[p] = inside ? colours[place_of(view, p)] : vec4(0.0);
#if MEASURE == MEASURE_TRANSPOSED
  picture[p] *= uintBitsToFloat(scale);
#endif
}

// The transposed blend: the picture, by what the splat counts for. Changes: without the splat alone, what lies behind it, of
// which it leaves the share 1 - alpha, is in its place.
void measure(uint at, uint p, uint k, float weight) {
  if (!(weight > 0.0)) return;
#if MEASURE == MEASURE_TRANSPOSED
  ivec4 steps = ivec4(floor(weight * picture[p] + 0.5));
#else
  vec3 own = batch_colour[at].rgb;
  vec3 behind = (picture[p].rgb - colour[p] - weight * own) / (transmittance[p] - weight);
  vec3 change = weight * (behind - own);
  ivec4 steps = ivec4(min(dot(change, change), float(CHANGE_MOST)) * float(CHANGE_SCALE) + 0.5, 0.0, 0.0, 0.0);
#endif
  for (int c = 0; c < 4; ++c) {
    if (steps[c] != 0) atomicAdd(batch_measured[at][c], steps[c]);
  }
}

void pass_on(uint splat, uint batch_at) {
  ivec4 sums = batch_measured[batch_at];
  for (uint c = 0u; c < 4u; ++c) {
    int sum = sums[c];
    if (sum == 0) continue;
    uint at = 2u * (4u * splat + c);
    uint before = atomicAdd(measured[at], uint(sum));
    uint above = (sum < 0 ? 0xffffffffu : 0u) + (before + uint(sum) < before ? 1u : 0u);
    if (above != 0u) atomicAdd(measured[at + 1u], above);
  }
}

#endif

// A pixel shows nothing more whose visibility would not be counted.
void end_where_nothing_is_measured(uint p) {
#if MEASURE == MEASURE_VISIBILITY
  if (transmittance[p] < float(VISIBILITY_LEAST) && !is_done(p)) {
    least[p] = -transmittance[p];
    transmittance[p] = 0.0;
  }
#endif
}
