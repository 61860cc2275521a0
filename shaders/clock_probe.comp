// Takes a time that depends on the GPU's clock only: a chain of 40,000 multiplications and additions.
layout(local_size_x = 32) in;

layout(std430, binding = 0) buffer Chain { float chain[32]; };

void main() {
  uint self = gl_LocalInvocationIndex;
  float value = chain[self];
  for (uint n = 0u; n < 10000u; ++n) {
    for (uint k = 0u; k < 4u; ++k) value = fma(value, 0.999, 0.001);
  }
  chain[self] = value;
}
