#pragma once
// --precision half on the CPU's side: Gaussians and splats in 32 bytes as halves.glsl unpacks them, SH
// coefficients in fp16. Numbers beyond fp16 become its largest.

#include <array>
#include <cstdint>
#include <span>

#include "shared/axes.h"
#include "shared/types.h"

namespace binosplat::render {

using Halves = std::array<std::uint32_t, 8>;

/// Position and largest scale in fp32; the scales as shares of it and opacity in fp16, rotation in 62 bits.
Halves pack(const shared::Gaussian& gaussian);

/// Mean, depth and rho in fp32; the lower Cholesky factor L of the conic, opacity and colour in fp16, L.yx as
/// the sum of two.
Halves pack(const shared::Splat& splat);

/// Two to a word, the first in the low half; `packed` has room for all of them and zeros beyond.
void pack(std::span<const float> numbers, std::span<std::uint32_t> packed);

/// Bytes of one thing in a PRECISION_ of shared/axes.h; of one Gaussian's harmonics with the padding that
/// vec4s need.
constexpr std::int64_t gaussian_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Gaussian);
}
constexpr std::int64_t splat_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Splat);
}
std::int64_t harmonic_bytes(int degree, int precision);

}  // namespace binosplat::render
