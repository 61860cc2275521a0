#pragma once
// The visibility of chunks in views and the errors of their levels of detail, for choose_by_error().

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "stream/level_choice.h"

namespace binosplat {

/// The visibility of all chunks in each view. An additional last view is the sphere around the views, which
/// sees the chunks that no other view sees.
class ChunkErrors {
 public:
  /// `chunks` and `visible` must outlive this object.
  ChunkErrors(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
              const VisibleChunks& visible, bool heads_turn);

  /// Writes the squared error of each level of chunk `c`, summed over pixels. If the view does not see the
  /// chunk, or the chunk's errors are unknown, writes nothing.
  void find_errors(std::size_t view, std::size_t c, double* errors) const;

  double longest_focal() const { return focal_.back(); }

 private:
  struct ChunkInView : ChunkVisibility {
    double outside = 0.0;  // distance from the picture's sides if the chunk is outside, world units; else 0
  };
  double area(std::size_t view, std::size_t c, std::size_t level) const;

  const std::vector<LodChunk>& chunks_;
  std::span<const std::size_t> drawn_;
  std::vector<double> focal_;
  std::vector<glm::dvec3> eye_;
  std::vector<std::vector<ChunkInView>> seen_;  // by view, then chunk
};

}  // namespace binosplat
