#pragma once
// A model whose parts come and go while it is drawn.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "scene/model.h"
#include "shared/types.h"

namespace binosplat {

/// Which Gaussians of a model are which part. A part lies in blocks of Gaussians anywhere in the model, and
/// stays there until it is replaced; what is left of its last block, and blocks of no part, have an opacity
/// of 0, so that they are never drawn.
class ModelParts {
 public:
  static constexpr std::size_t block = 64;  // Gaussians

  /// Of a model without Gaussians.
  explicit ModelParts(std::size_t parts) : blocks_(parts), counts_(parts) {}

  std::size_t size() const { return counts_.size(); }
  /// Gaussians of all parts.
  std::size_t gaussians() const { return gaussians_; }
  /// Of a Gaussian of a part.
  std::size_t part_of(std::size_t gaussian) const { return owners_[gaussian / block]; }
  /// By block; of those of no part it says nothing.
  const std::vector<std::uint32_t>& owners() const { return owners_; }
  /// In which blocks a part lies, in the order of its Gaussians.
  const std::vector<std::size_t>& blocks(std::size_t part) const { return blocks_[part]; }

  /// The Gaussians of a part.
  Model part(const Model& model, std::size_t part) const;

  /// Puts `by`, of the model's degree, in the place of a part. The model, which is the same in every call,
  /// grows where there is no place left, and its `room` by an eighth where that is full.
  void replace(Model& model, std::size_t part, const Model& by);
  /// The same for several, each another part, side by side.
  struct Replacement {
    std::size_t part = 0;
    const Model* by = nullptr;
  };
  void replace(Model& model, std::span<const Replacement> all);

  struct Range {
    std::size_t first = 0, count = 0;  // Gaussians of the model
  };
  /// Places that are others than before; those that were never filled are not among them.
  struct Changes {
    std::vector<Range> filled, emptied;  // in order and apart
    bool empty() const { return filled.empty() && emptied.empty(); }
  };
  /// What has changed since the last call.
  Changes take_changes();

 private:
  enum class Change : std::uint8_t { none, filled, emptied };
  std::vector<std::size_t> give_back(std::size_t part);
  void take_place(Model& model, std::size_t part, const Model& by);
  std::size_t take_block(Model& model, const glm::vec3& where);
  void set_free(std::size_t b);
  void note(std::size_t b, Change change);

  std::vector<std::vector<std::size_t>> blocks_;  // by part
  std::vector<std::size_t> counts_;               // by part
  std::vector<std::uint32_t> owners_;             // by block
  std::vector<std::uint64_t> free_;               // a bit by block
  std::size_t none_before_ = 0;                   // of its words has any
  std::vector<Change> changes_;                   // by block, since the last take_changes()
  std::vector<std::size_t> changed_;              // blocks
  std::size_t gaussians_ = 0;
};

/// Tries out what a picture gains by other parts: uploads what has changed of the model, and then keeps the
/// picture of a view, or finds how far that of the same view is from the one that was kept, squared and
/// meaned over pixels and channels.
struct PartsTrial {
  std::function<void(const ModelParts::Changes& changes)> upload;
  std::function<void(const shared::View& view)> keep;
  std::function<double(const shared::View& view)> differs;
};

/// What a view shows of a part: alpha T^2, summed over its Gaussians and the view's pixels, and how far away
/// that is, world units. T once for the light that comes from it, and once since an error behind others is
/// seen less. A little where all of it is hidden; 0 only where none of its Gaussians is in the picture.
struct SeenPart {
  double area = 0.0;  // px
  double distance = 0.0;
};

/// Columns of a picture, from its left, as shares of its width: what lies at the horizon, which is most of a
/// large scene, is in all bands side by side.
struct Band {
  double begin = 0.0, end = 1.0;
  bool is_all() const { return begin <= 0.0 && end >= 1.0; }
};

}  // namespace binosplat
