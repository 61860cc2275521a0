#pragma once
// Divides a frame's copying among threads.

#include <cstddef>
#include <functional>

namespace binosplat {

/// Covers [0, count) by calls of body(begin, end), each of at most `chunk` indices, on this thread and on new
/// ones: together a quarter of the cores. parallel_chunks() does not suit frames: its threads may be busy for
/// some ms, and keep a low priority after background work. `body` must not throw.
void parallel_in_frame(std::size_t count, std::size_t chunk,
                       const std::function<void(std::size_t begin, std::size_t end)>& body);

/// The `chunk` of parallel_in_frame() for copying 4-byte numbers. Copying this many numbers takes about 20
/// us.
inline constexpr std::size_t numbers_a_chunk = std::size_t{1} << 15;

}  // namespace binosplat
