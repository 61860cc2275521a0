#pragma once
// A model whose chunks are replaced while it is drawn.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <span>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Stores which Gaussians of a model belong to which chunk. A chunk occupies blocks of Gaussians anywhere in
/// the model, and keeps them until it is replaced. The unused rest of its last block and free blocks have
/// opacity 0, so they are never drawn.
class ModelChunks {
 public:
  static constexpr std::size_t block = 64;  // number of Gaussians

  /// The model starts without Gaussians.
  explicit ModelChunks(std::size_t chunks) : blocks_(chunks), counts_(chunks) {}

  std::size_t size() const { return counts_.size(); }
  std::size_t gaussians() const { return gaussians_; }
  /// The chunk of each block; arbitrary for free blocks.
  const std::vector<std::uint32_t>& owners() const { return owners_; }
  /// The blocks of a chunk, in the order of its Gaussians.
  const std::vector<std::size_t>& blocks(std::size_t chunk) const { return blocks_[chunk]; }

  Model chunk(const Model& model, std::size_t chunk) const;

  /// Replaces a chunk by the Gaussians of `by`, a model of equal degree. The model must be the same in every
  /// call. If the model has no free block, it grows; if its `capacity` is full, `capacity` grows by an
  /// eighth.
  void replace(Model& model, std::size_t chunk, const Model& by);
  /// The same for several chunks, on several cores.
  struct Replacement {
    std::size_t chunk = 0;
    const Model* by = nullptr;
  };
  void replace(Model& model, std::span<const Replacement> all);

  struct Range {
    std::size_t first = 0, count = 0;  // Gaussians of the model
  };
  /// Changed ranges of the model. They omit blocks that were never filled.
  struct Changes {
    std::vector<Range> filled, emptied;  // each sorted, adjacent ranges joined
    bool empty() const { return filled.empty() && emptied.empty(); }
  };
  /// Returns the changes since the last call.
  Changes take_changes();

 private:
  enum class Change : std::uint8_t { none, filled, emptied };
  std::vector<std::size_t> free_blocks(std::size_t chunk);
  void fill_blocks(Model& model, std::size_t chunk, const Model& by);
  std::size_t allocate_block(Model& model, const glm::vec3& where);
  void note(std::size_t b, Change change);

  std::vector<std::vector<std::size_t>> blocks_;  // by chunk
  std::vector<std::size_t> counts_;               // by chunk
  std::vector<std::uint32_t> owners_;             // by block
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>>
      free_;                          // blocks, the first on top
  std::vector<Change> changes_;       // by block, since the last take_changes()
  std::vector<std::size_t> changed_;  // blocks
  std::size_t gaussians_ = 0;
};

}  // namespace binosplat
