#pragma once
// A model whose chunks come and go while it is drawn.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <span>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Which Gaussians of a model are which chunk. A chunk lies in blocks of Gaussians anywhere in the model, and
/// stays there until it is replaced; what is left of its last block, and blocks of no chunk, have an opacity
/// of 0, so that they are never drawn.
class ModelChunks {
 public:
  static constexpr std::size_t block = 64;  // Gaussians

  /// Begins with a model without Gaussians.
  explicit ModelChunks(std::size_t chunks) : blocks_(chunks), counts_(chunks) {}

  std::size_t size() const { return counts_.size(); }
  /// How many Gaussians all chunks have.
  std::size_t gaussians() const { return gaussians_; }
  /// The chunk of each block; for blocks of no chunk it has any number.
  const std::vector<std::uint32_t>& owners() const { return owners_; }
  /// The blocks in which a chunk lies, in the order of its Gaussians.
  const std::vector<std::size_t>& blocks(std::size_t chunk) const { return blocks_[chunk]; }

  /// The Gaussians of a chunk.
  Model chunk(const Model& model, std::size_t chunk) const;

  /// Puts `by`, of the model's degree, in the place of a chunk. The model must be the same in every call. It
  /// grows where it has no free block, and its `room` by an eighth where that is full.
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
  /// Places whose Gaussians have changed; places that were never filled are not among them.
  struct Changes {
    std::vector<Range> filled, emptied;  // each in order, and no two side by side
    bool empty() const { return filled.empty() && emptied.empty(); }
  };
  /// What has changed since the last call.
  Changes take_changes();

 private:
  enum class Change : std::uint8_t { none, filled, emptied };
  std::vector<std::size_t> give_back(std::size_t chunk);
  void take_place(Model& model, std::size_t chunk, const Model& by);
  std::size_t take_block(Model& model, const glm::vec3& where);
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
