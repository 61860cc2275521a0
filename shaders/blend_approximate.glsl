// The approximate blend of docs/method.md 5.2: blends a splat in the blocks of a tile in which its alpha reaches Th. A
// block ends once it is dark: T is small in all its pixels. Part of blending.glsl.
#if !APPROXIMATE

#define are_dark are_done
#define TAKES_NO_MORE false
void begin_block(View view) {}
void end_dark() {}
float finished(uint p) { return transmittance_left(p); }

#else

float dark_transmittance;  // a block is dark once no pixel's T exceeds this; 0: never
bool ended_dark = false;   // the block ended because it is dark
#if MEASURE == MEASURE_TRANSMITTANCE
vec4 dark_colour[COLUMN];  // final colour and Z; the loop continues only to measure
float dark_left[COLUMN];
#endif
#define TAKES_NO_MORE (ended_dark && MEASURE != MEASURE_TRANSMITTANCE)

void begin_block(View view) {
  precise float tolerance = frame.tolerance * view.tolerance_share;
  dark_transmittance = min(float(DARK_TRANSMITTANCE_MOST), float(DARK_TRANSMITTANCE) * sqrt(tolerance));
}

bool are_dark() {
  bool all = true;
  for (uint p = 0u; p < COLUMN; ++p) all = all && transmittance[p] <= dark_transmittance;
  return all;
}

// Ends a dark block. In each pixel that is not done, assumes that the colour behind equals the blended colour.
void end_dark() {
  if (ended_dark || dark_transmittance <= 0.0) return;
  ended_dark = true;
  for (uint p = 0u; p < COLUMN; ++p) {
    precise float scale = is_done(p) ? 1.0 : 1.0 / (1.0 - transmittance[p]);
    colour[p] *= scale;
    z_sum[p] *= DEPTH == DEPTH_MEAN ? scale : 1.0;
    debug_scale(scale);
#if MEASURE == MEASURE_TRANSMITTANCE
    dark_colour[p] = vec4(colour[p], z_sum[p]);
    dark_left[p] = is_done(p) ? transmittance_left(p) : 0.0;
#endif
  }
}

// Returns the final transmittance of a pixel, and sets its final colour and depth.
float finished(uint p) {
  float left = transmittance_left(p);
  if (ended_dark) {
#if MEASURE == MEASURE_TRANSMITTANCE
    colour[p] = dark_colour[p].rgb;
    z_sum[p] = dark_colour[p].a;
    left = dark_left[p];
#else
    left = is_done(p) ? left : 0.0;
#endif
  }
  return left;
}

#endif
