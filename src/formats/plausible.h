#pragma once
// What a file may unpack to, asked before memory is taken for it: a kilobyte of zeros unpacks to gigabytes.

#include <cstdint>

namespace binosplat {

/// The most Gaussians in a file of so many bytes as they lie on the disk: one a byte, while real models take
/// three and more however they are packed, and a million that need no reason, as made-up ones of equal values
/// need them.
constexpr std::uint64_t most_gaussians_in(std::uint64_t bytes) { return bytes + (std::uint64_t{1} << 20); }

}  // namespace binosplat
