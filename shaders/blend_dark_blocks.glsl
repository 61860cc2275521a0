// The approximate blend of docs/method.md 5.2: blends a splat in the blocks of a tile in which its alpha reaches Th. A
// block ends once it is dark: T is small in all its pixels. Part of blending.glsl.
float dark_transmittance;  // a block is dark once no pixel's T exceeds this; 0: never
bool ended_dark = false;   // the block ended because it is dark

// Measurements of transmittance also need the splats behind dark blocks, so there the walk goes on, and the pixels of a
// dark block are kept.
#if MEASURE == MEASURE_TRANSMITTANCE
#define TAKES_NO_MORE false
vec4 dark_colour[COLUMN];  // final colour and Z
float dark_left[COLUMN];

void keep_dark(uint p) {
  dark_colour[p] = vec4(colour[p], z_sum[p]);
  dark_left[p] = is_done(p) ? transmittance_left(p) : 0.0;
}

float take_dark(uint p, float left) {
  colour[p] = dark_colour[p].rgb;
  z_sum[p] = dark_colour[p].a;
  return dark_left[p];
}
#else
#define TAKES_NO_MORE ended_dark
void keep_dark(uint p) {}
float take_dark(uint p, float left) { return is_done(p) ? left : 0.0; }
#endif

void begin_block(View view) {
  precise float tolerance = frame.tolerance * view.tolerance_share;
  dark_transmittance = min(float(DARK_TRANSMITTANCE_MAX), float(DARK_TRANSMITTANCE) * sqrt(tolerance));
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
    keep_dark(p);
  }
}

// Returns the final transmittance of a pixel, and sets its final colour and depth.
float finished(uint p) {
  float left = transmittance_left(p);
  return ended_dark ? take_dark(p, left) : left;
}
