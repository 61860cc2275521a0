// A tile is drawn in blocks of BLOCK_WIDTH x BLOCK_HEIGHT px, row by row. This file finds the blocks that a splat
// reaches. The approximate blend instead tests the blocks of docs/method.md 5.2. Include after blending.glsl.
#define BLOCKS_ACROSS (TILE_SIZE / BLOCK_WIDTH)
#define BLOCKS_DOWN (TILE_SIZE / BLOCK_HEIGHT)
#define BLOCKS (BLOCKS_ACROSS * BLOCKS_DOWN)
#if APPROXIMATE
#define REACH_HEIGHT APPROXIMATE_BLOCK
#else
#define REACH_HEIGHT BLOCK_HEIGHT
#endif

// The index of a block's bit in blocks_reached().
uint bit_of(uint block) {
  return block / BLOCKS_ACROSS * BLOCK_HEIGHT / REACH_HEIGHT * BLOCKS_ACROSS + block % BLOCKS_ACROSS;
}

// Returns a bit for each block with a pixel in which alpha reaches ALPHA_MIN, or Th in the approximate blend. Rounding
// may add blocks, but never loses one. `mean` is relative to the tile's first pixel.
uint blocks_reached(Splat splat, vec2 mean) {
  if (!(splat.opacity >= float(ALPHA_MIN))) return 0u;
#if APPROXIMATE
  float rho = 1.001 * max(0.0, splat.colour.w) + 1e-3;
#else
  float rho = 2.002 * log(splat.opacity / float(ALPHA_MIN)) + 1e-3;
#endif
#if PROJECTION == PROJECTION_TANGENT
  rho *= farthest;
#endif
  float root_det = abs(splat.conic.w);
  float tallest = root_det * sqrt(rho * splat.conic.x);            // half the height of the ellipse
  float widest = sqrt(rho / splat.conic.x);                        // half the width of its widest row
  float lean = -splat.conic.y / splat.conic.x;                     // slope of the line through its rows' middles
  float apex = -splat.conic.y * root_det * sqrt(rho / splat.conic.z);  // y of its rightmost point
  uint bits = 0u;
  for (uint row = 0u; row < TILE_SIZE / REACH_HEIGHT; ++row) {
    float low = float(row * REACH_HEIGHT) - mean.y;
    float high = low + float(REACH_HEIGHT - 1);
    if (low > tallest || high < -tallest) continue;
    vec2 y = clamp(vec2(-apex, apex), low, high);  // y of its leftmost and rightmost points in this row of blocks
    vec2 reach = widest * sqrt(max(vec2(0.0), 1.0 - y * y / (tallest * tallest)));
    vec2 x = lean * y + vec2(-reach.x, reach.y);
    float slack = 0.01 + 1e-5 * (abs(x.x) + abs(x.y));
    float first = max(0.0, ceil((mean.x + x.x - slack - float(BLOCK_WIDTH - 1)) / float(BLOCK_WIDTH)));
    float last = min(float(BLOCKS_ACROSS - 1), floor((mean.x + x.y + slack) / float(BLOCK_WIDTH)));
    if (first <= last) bits |= ((2u << uint(last)) - (1u << uint(first))) << (row * BLOCKS_ACROSS);
  }
  return bits;
}
