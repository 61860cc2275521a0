// The sum of alpha T^2, because an error of the colour has the weight alpha T, and an error of alpha the weight T.
// By splat: two words, for the low VISIBILITY_LOW_BITS bits of each tile's sum and for the bits above. They have no
// carry: with a carry the second atomic would wait for the first. The words have room for 2^26 px and 2^18 tiles, enough
// for a visibility pass, which has at most half the size of a drawn picture.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
shared int batch_measured[BATCH];
int visible = 0;  // the current splat's visibility in this invocation's pixels

void clear_measured(uint at) { batch_measured[at] = 0; }
void begin_measuring(View view, uint p, bool inside) {}
#define MARK(p, k, alpha)

void measure(uint at, uint p, uint k, float weight) {
  float counted = transmittance[p] >= float(VISIBILITY_MIN) ? weight * transmittance[p] : 0.0;
  visible += int(floor(counted * float(VISIBILITY_SCALE) + 0.5));
}

void end_measuring_splat(uint at) {
  if (visible != 0) atomicAdd(batch_measured[at], visible);
  visible = 0;
}

void pass_on(uint splat, uint batch_at) {
  int sum = batch_measured[batch_at];
  uint low = uint(sum) & ((1u << VISIBILITY_LOW_BITS) - 1u), high = uint(sum) >> VISIBILITY_LOW_BITS;
  if (low != 0u) atomicAdd(measured[2u * splat], low);
  if (high != 0u) atomicAdd(measured[2u * splat + 1u], high);
}
