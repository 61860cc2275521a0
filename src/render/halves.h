#pragma once
// Packs for `--precision half` on the CPU: Gaussians and splats in 32 bytes, SH coefficients in fp16;
// half_precision.glsl unpacks them. Numbers beyond fp16's range become its largest number.

#include <array>
#include <cstdint>
#include <span>

#include "shared/choices.h"
#include "shared/types.h"

namespace binosplat::render {

using Halves = std::array<std::uint32_t, 8>;

/// Position and largest scale are in fp32. Opacity and the scales, as shares of the largest, are in fp16. The
/// rotation has 62 bits.
Halves pack(const shared::Gaussian& gaussian);

/// Mean, depth and rho are in fp32. The lower Cholesky factor L of the conic, opacity and colour are in fp16,
/// with L.yx as the sum of two numbers.
Halves pack(const shared::Splat& splat);

/// Packs two numbers per word, the first in the low half. `packed` has room for all of them; the rest becomes
/// zero.
void pack(std::span<const float> numbers, std::span<std::uint32_t> packed);

/// Bytes of one object in a PRECISION_ of shared/choices.h. harmonic_bytes() counts one Gaussian's harmonics,
/// with the padding of vec4s.
constexpr std::int64_t gaussian_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Gaussian);
}
constexpr std::int64_t splat_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Splat);
}
std::int64_t harmonic_bytes(int degree, int precision);

}  // namespace binosplat::render
