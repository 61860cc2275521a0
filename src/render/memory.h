#pragma once
// The memory that a frame takes: what it starts with, how it grows, and what that comes to beforehand.

#include <cstdint>

#include "render/frame_plan.h"
#include "render/workings.h"

namespace binosplat::render {

/// How many Gaussians a first frame has room to draw: all of a small model, a part of a large one, which is
/// hardly ever all in view. A frame that needs more grows its buffers.
std::uint32_t starting_slots(std::uint32_t gaussians);

/// The bytes that the model takes on the GPU, and those that a first frame takes besides.
struct MemoryNeeds {
  std::int64_t model = 0;
  std::int64_t frame = 0;
};
MemoryNeeds memory_needs(const FramePlan& plan);

/// What the buffers of frames that follow one another have room for.
struct Capacity {
  std::int64_t slots = 0;        // Gaussians that an order group draws
  std::int64_t pairs = 0;        // Gaussian-supertile pairs: entries
  std::int64_t large_pairs = 0;  // those of Gaussians in many supertiles
  std::int64_t tile_pairs = 0;   // Gaussian-tile pairs
  std::int64_t rounds = 0;       // that part lists which are too long to be sorted at once

  /// At least what a frame of this plan starts with, or exactly what `asked` names.
  void start(const FramePlan& plan, const Workings& asked);

  /// What overflowed gets room for what it wanted, and some more; says so in the log. Throws
  /// Error(out_of_memory) for more pairs than can be counted.
  void grow(const FramePlan& plan, const shared::Counters& counters);
};

}  // namespace binosplat::render
