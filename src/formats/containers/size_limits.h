#pragma once
// Limits on unpacked sizes, checked before memory is allocated, because a small file can unpack to gigabytes.

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace binosplat {

/// Readers accept this many Gaussians from a file of any size (`max_memory`, for trusted files).
inline std::atomic<std::uint64_t> gaussians_allowed{0};

/// Returns the maximum number of Gaussians that readers accept from a file of `bytes` bytes on disk: one for
/// each byte, plus a million. Real models take three bytes or more for each Gaussian in every format;
/// synthetic models of equal values need the million.
inline std::uint64_t max_gaussians_in(std::uint64_t bytes) {
  return std::max(bytes + (std::uint64_t{1} << 20), gaussians_allowed.load());
}

/// The end of the text of errors about these limits.
constexpr const char* more_may_be_allowed = "; if it is right, `max_memory` MB allows more";

}  // namespace binosplat
