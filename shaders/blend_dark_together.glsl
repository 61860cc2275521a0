// The blocks of the approximate blend (docs/method.md 5.2), for blend.comp: there all blocks of a tile walk together.
shared uint bright;  // a bit for each block that is not dark
uint dark_bit;

void begin_own_block(uvec2 in_tile) {
  uvec2 block = in_tile / APPROXIMATE_BLOCK;
  own_bit = bit_of(block.y * BLOCKS_ACROSS + block.x);
  dark_bit = 1u << in_tile.y / APPROXIMATE_ROWS * BLOCKS_ACROSS + block.x;
}

void find_blocks(uint at, Splat splat) { reached[at] = blocks_reached(splat, splat.mean - corner); }
void clear_bright() { bright = 0u; }
void mark_bright() {
  if (!are_dark()) atomicOr(bright, dark_bit);
}

// Ends this invocation's block if it is dark. Returns whether the tile ends.
bool ends_dark(uint blended) {
  bool is_test_step = blended % APPROXIMATE_STEP == 0u;
  if (is_test_step && (bright & dark_bit) == 0u) end_dark();
  // Measurements of transmittance also need the splats behind dark blocks.
  return MEASURE != MEASURE_TRANSMITTANCE && is_test_step && bright == 0u;
}
