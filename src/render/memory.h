#pragma once
// The memory of a frame: its first size, its growth, and its total before allocation.

#include <cstdint>

#include "render/debug_options.h"
#include "render/frame_plan.h"

namespace binosplat::render {

/// Returns the slots of a first frame: all Gaussians of a small model, or a part of a large model, which is
/// rarely all in view. If a frame needs more, its buffers grow.
std::uint32_t starting_slots(std::uint32_t gaussians);

/// The bytes of the model on the GPU, and the further bytes of a first frame.
struct MemoryNeeds {
  std::int64_t model = 0;
  std::int64_t frame = 0;
};
MemoryNeeds memory_needs(const FramePlan& plan);

/// The sizes of the buffers of successive frames.
struct Capacity {
  std::int64_t slots = 0;        // Gaussians of an order group
  std::int64_t pairs = 0;        // Gaussian-supertile pairs: entries
  std::int64_t large_pairs = 0;  // the same for Gaussians in many supertiles, whose entries are stored apart
  std::int64_t tile_pairs = 0;   // Gaussian-tile pairs
  std::int64_t rounds = 0;       // rounds that split lists too long to sort at once
  bool told = false;             // grow() has logged that it enlarges buffers

  /// Starts with at least the sizes for a frame of this plan, or exactly the sizes that `debug` sets.
  void start(const FramePlan& plan, const DebugOptions& debug);

  /// Enlarges each overflowed buffer to the size that it needed plus an eighth, and logs the first time.
  /// Throws Error(out_of_memory) for more pairs than can be counted.
  void grow(const FramePlan& plan, const shared::Counters& counters);
};

}  // namespace binosplat::render
