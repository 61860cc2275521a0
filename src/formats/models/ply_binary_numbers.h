#pragma once
// Numbers of binary ply files.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "formats/containers/bytes.h"
#include "formats/models/ply_header.h"

namespace binosplat {

template <typename T>
T load_ply_as(const std::byte* at, bool swapped) {
  if (!swapped) return load_number<T>(at);
  std::array<std::byte, sizeof(T)> bytes;
  std::reverse_copy(at, at + sizeof(T), bytes.begin());
  return std::bit_cast<T>(bytes);
}

/// Returns a stored number, which a double represents exactly for every type. The caller has checked that its
/// bytes exist. `swapped` means that the file's byte order differs from this machine's.
inline double load_ply_number(PlyType type, const std::byte* at, bool swapped) {
  switch (type) {
    case PlyType::int8:
      return load_ply_as<std::int8_t>(at, swapped);
    case PlyType::uint8:
      return load_ply_as<std::uint8_t>(at, swapped);
    case PlyType::int16:
      return load_ply_as<std::int16_t>(at, swapped);
    case PlyType::uint16:
      return load_ply_as<std::uint16_t>(at, swapped);
    case PlyType::int32:
      return load_ply_as<std::int32_t>(at, swapped);
    case PlyType::uint32:
      return load_ply_as<std::uint32_t>(at, swapped);
    case PlyType::float16:
      return half_of(load_ply_as<std::uint16_t>(at, swapped));
    case PlyType::float32:
      return load_ply_as<float>(at, swapped);
    case PlyType::float64:
      break;
  }
  return load_ply_as<double>(at, swapped);
}

/// Returns whether a binary file's byte order differs from this machine's.
constexpr bool is_swapped(PlyFormat format) {
  return (format == PlyFormat::big_endian) != (std::endian::native == std::endian::big);
}

}  // namespace binosplat
