// Moves uploaded records to their places. One invocation per word.
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Places { uint places[]; };    // by record
layout(std430, binding = 1) readonly buffer Records { uint records[]; };
layout(std430, binding = 2) writeonly buffer Scattered { uint scattered[]; };
uniform uint words;  // of a record
uniform uint word_count;

void main() {
  uint at = thread_index();
  if (at < word_count) scattered[places[at / words] * words + at % words] = records[at];
}
