// DEBUG_VIEW: writes a value for each pixel instead of the picture. `shown` selects the value: SHOW_ALPHAS to
// SHOW_MEDIAN_DEPTH. An invocation draws one pixel, and blends one splat at a time. Part of blending.glsl.
#if DEBUG_VIEW && !MEASURE
layout(std430, binding = 7) readonly buffer Measured { uint measured[]; };  // SHOW_TRANSMITTANCE: max(T) of each splat
#endif
#if DEBUG_VIEW
uniform uint shown;
layout(std430, binding = 8) writeonly buffer DebugView { float debug_values[]; };  // below 0: no value
shared float batch_transmittance[BATCH];
float debug_value;

void begin_debug_view() { debug_value = shown == SHOW_MEDIAN_DEPTH ? -1.0 : 0.0; }

void debug_stage(uint at, uint splat) {
  if (shown == SHOW_TRANSMITTANCE) batch_transmittance[at] = uintBitsToFloat(measured[splat]);
}

// Counts evaluated alphas, including the alpha of the splat before which the pixel stops.
void debug_evaluated(uint at) {
  if (shown == SHOW_ALPHAS && !is_done(0u) && at < size) debug_value += 1.0;
}

void debug_blended(uint at, float weight) {
  if (shown == SHOW_VISIBLE && weight > 0.0) debug_value += 1.0;
  if (shown == SHOW_TRANSMITTANCE) debug_value += weight * batch_transmittance[at];
  if (shown == SHOW_MEDIAN_DEPTH && debug_value < 0.0 && weight > 0.0 && transmittance[0] < 1.0 - float(COVERAGE_FOR_DEPTH))
    debug_value = depth_in(0u, at, depth_of(at));
}

// Scales the value as the colour is scaled when a block ends dark.
void debug_scale(float scale) {
  if (shown == SHOW_TRANSMITTANCE) debug_value *= scale;
}

void write_debug_view(uint to, float left, uint list) {
  if (shown == SHOW_PAIRS) debug_value = float(list);
  if (shown == SHOW_TRANSMITTANCE) debug_value = left < 1.0 ? debug_value / (1.0 - left) : -1.0;
  if (shown == SHOW_MEDIAN_DEPTH) debug_value = view_z_of(0u, debug_value);
  debug_values[to] = debug_value;
}
#else
void begin_debug_view() {}
void debug_stage(uint at, uint splat) {}
void debug_evaluated(uint at) {}
void debug_blended(uint at, float weight) {}
void debug_scale(float scale) {}
#endif
