// The largest T of a pixel in which the splat counts (docs/method.md 5).
layout(std430, binding = 7) buffer Measured { uint measured[]; };  // by splat: the bits of a float
shared uint batch_measured[BATCH];

void clear_measured(uint at) { batch_measured[at] = 0u; }
void begin_measuring(View view, uint p, bool inside) {}

// A splat counts in a pixel if its alpha reaches ALPHA_MIN, even if the approximate blend drops it.
#if APPROXIMATE
bool is_marked[COLUMN][AHEAD];
#define MARK(p, k, alpha) is_marked[p][k] = alpha >= float(ALPHA_MIN)
#define IS_MARKED(p, k, weight) is_marked[p][k]
#else
#define MARK(p, k, alpha)
#define IS_MARKED(p, k, weight) (weight > 0.0)
#endif

void measure(uint at, uint p, uint k, float weight) {
  if (IS_MARKED(p, k, weight)) atomicMax(batch_measured[at], floatBitsToUint(transmittance[p]));
}

void end_measuring_splat(uint at) {}

void pass_on(uint splat, uint batch_at) {
  uint most = batch_measured[batch_at];
  if (most != 0u) atomicMax(measured[splat], most);
}
