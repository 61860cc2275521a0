// What a blend tells of each pixel in the place of its picture, DEBUG_VIEW, which is SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of
// shared/axes.h. Without it nothing of this is there. Part of blending.glsl.
#if DEBUG_VIEW != SHOW_PICTURE
layout(std430, binding = 8) writeonly buffer DebugView { float debug_values[]; };  // below 0: nothing to tell
float debug_value[COLUMN];
#endif
#if DEBUG_VIEW == SHOW_LIGHT
layout(std430, binding = 7) readonly buffer Measured { uint measured[]; };  // by a blend that measured the transmittance before
shared float batch_transmittance[BATCH];
#endif

void begin_debug_view(uint p) {
#if DEBUG_VIEW != SHOW_PICTURE
  debug_value[p] = DEBUG_VIEW == SHOW_MEDIAN_DEPTH ? -1.0 : 0.0;
#endif
}

void debug_stage(uint at, uint splat) {
#if DEBUG_VIEW == SHOW_LIGHT
  batch_transmittance[at] = uintBitsToFloat(measured[splat]);
#endif
}

// Alphas are counted up to the splat that a pixel stops before.
float alphas_from(uint first) { return float(min(uint(AHEAD), size - min(first, size))); }

void debug_evaluated(uint first, uint p) {
#if DEBUG_VIEW == SHOW_ALPHAS
  if (!is_done(p)) debug_value[p] += alphas_from(first);
#endif
}

void debug_kept(uint p, bool is_kept) {
#if DEBUG_VIEW == SHOW_ALPHAS
  debug_value[p] += float(is_kept);
#endif
}

void debug_stopped(uint first, uint p) {
#if DEBUG_VIEW == SHOW_ALPHAS
  debug_value[p] -= alphas_from(first) - 1.0;
#endif
}

void debug_blended(uint at, uint p, float weight) {
#if DEBUG_VIEW == SHOW_VISIBLE
  if (weight > 0.0) debug_value[p] += 1.0;
#elif DEBUG_VIEW == SHOW_LIGHT
  debug_value[p] += weight * batch_transmittance[at];
#elif DEBUG_VIEW == SHOW_MEDIAN_DEPTH
  if (debug_value[p] < 0.0 && weight > 0.0 && transmittance[p] < 1.0 - float(COVERAGE_FOR_DEPTH))
    debug_value[p] = depth_of(at);
#endif
}

// A block ended dark, and what it has stands for what is behind, too.
void debug_scale(uint p, float scale) {
#if DEBUG_VIEW == SHOW_LIGHT
  debug_value[p] *= scale;
#endif
}

void write_debug_view(uint to, uint p, float left, uint list) {
#if DEBUG_VIEW == SHOW_PAIRS
  debug_value[p] = float(list);
#elif DEBUG_VIEW == SHOW_LIGHT
  debug_value[p] = left < 1.0 ? debug_value[p] / (1.0 - left) : -1.0;
#elif DEBUG_VIEW == SHOW_MEDIAN_DEPTH && PROJECTION == PROJECTION_TANGENT
  debug_value[p] *= sqrt(nearness[p]);  // of a distance
#endif
#if DEBUG_VIEW != SHOW_PICTURE
  debug_values[to] = debug_value[p];
#endif
}
