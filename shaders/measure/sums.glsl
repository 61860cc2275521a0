// Sums over a stored picture, in four channels. transposed.glsl and changes.glsl include this file, and define scaled()
// and steps_of(), a pixel's part of a splat's sums. By splat: 64 bits per channel, low word first.
layout(std430, binding = 7) buffer Measured { uint measured[]; };
shared ivec4 batch_measured[BATCH];
vec4 picture[COLUMN];  // scaled pixels of the stored picture
uint place_of(View view, uint p);
vec4 scaled(vec4 pixel);
ivec4 steps_of(uint at, uint p, float weight);

void clear_measured(uint at) { batch_measured[at] = ivec4(0); }

void begin_measuring(View view, uint p, bool inside) {
  picture[p] = scaled(inside ? colours[place_of(view, p)] : vec4(0.0));
}

#define MARK(p, k, alpha)

void measure(uint at, uint p, uint k, float weight) {
  if (!(weight > 0.0)) return;
  ivec4 steps = steps_of(at, p, weight);
  for (int c = 0; c < 4; ++c) {
    if (steps[c] != 0) atomicAdd(batch_measured[at][c], steps[c]);
  }
}

void end_measuring_splat(uint at) {}

void pass_on(uint splat, uint batch_at) {
  for (uint c = 0u; c < 4u; ++c) {
    int sum = batch_measured[batch_at][c];
    if (sum == 0) continue;
    uint at = 2u * (4u * splat + c);
    uint before = atomicAdd(measured[at], uint(sum));
    uint above = (sum < 0 ? 0xffffffffu : 0u) + (before + uint(sum) < before ? 1u : 0u);
    if (above != 0u) atomicAdd(measured[at + 1u], above);
  }
}
