#pragma once
// Numbers in the bytes of a file, little-endian unless a name says otherwise.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace binosplat {

static_assert(std::endian::native == std::endian::little, "readers take numbers from files as they are");

/// Returns the number at `at`, aligned or not. The caller has checked that its bytes exist.
template <typename T>
T load_number(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

template <typename T>
void store_number(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(T));
}

constexpr std::uint32_t bit_field(std::uint32_t word, int low, int bits) {
  return (word >> low) & ((1u << bits) - 1u);
}

/// Returns the lowest `bytes` bytes of a number, the highest first.
inline std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string out;
  while (bytes-- > 0) out += static_cast<char>(value >> (8 * bytes) & 255U);
  return out;
}

/// Returns the half float (IEEE 754 binary16) with these bits as a float, which represents it exactly.
inline float half_of(std::uint16_t h) {
  const std::uint32_t sign = (h & 0x8000u) << 16, exponent = (h >> 10) & 31u, fraction = h & 1023u;
  if (exponent == 0) {
    const float small = static_cast<float>(fraction) * 0x1p-24f;
    return sign != 0 ? -small : small;
  }
  const std::uint32_t wide = exponent == 31 ? 255u : exponent + 112u;
  return std::bit_cast<float>(sign | (wide << 23) | (fraction << 13));
}

inline float load_half(const std::byte* at) { return half_of(load_number<std::uint16_t>(at)); }

}  // namespace binosplat
