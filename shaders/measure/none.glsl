// The blend measures nothing.
void clear_measured(uint at) {}
void begin_measuring(View view, uint p, bool inside) {}
#define MARK(p, k, alpha)
void measure(uint at, uint p, uint k, float weight) {}
void end_measuring_splat(uint at) {}
void pass_on(uint splat, uint batch_at) {}
