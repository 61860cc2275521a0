#pragma once
// What a file may unpack to, asked before memory is taken for it: a kilobyte of zeros unpacks to gigabytes.

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace binosplat {

/// Gaussians that are taken of any file, whatever its size: who trusts a file says so (--max-memory).
inline std::atomic<std::uint64_t> gaussians_allowed{0};

/// The most Gaussians that readers take of a file of `bytes` bytes on the disk: one a byte, while real models
/// have three bytes and more for each however they are packed, and a million besides, which made-up models of
/// equal values need.
inline std::uint64_t most_gaussians_in(std::uint64_t bytes) {
  return std::max(bytes + (std::uint64_t{1} << 20), gaussians_allowed.load());
}

/// How an error says so.
constexpr const char* more_may_be_allowed = "; if it is right, --max-memory MB allows more";

}  // namespace binosplat
