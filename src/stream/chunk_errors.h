#pragma once
// What views see of chunks, and what levels of detail lose of that, for choose_within().

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "stream/choice.h"

namespace binosplat {

/// What each view sees of all chunks, and what the sphere around them does, which comes last and sees the
/// chunks that no view sees.
class ChunkErrors {
 public:
  /// `chunks` and `visible` must outlive it.
  ChunkErrors(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
              const VisibleChunks& visible, bool heads_turn);

  /// Writes the squared error of each level of chunk `c`, summed over px; writes nothing where the view does
  /// not see the chunk or its errors are not known.
  void find_errors(std::size_t view, std::size_t c, double* errors) const;

  double longest_focal() const { return focal_.back(); }

 private:
  struct Seen : ChunkVisibility {
    double outside = 0.0;  // how far beside the picture the chunk lies, world units
  };
  double area(std::size_t view, std::size_t c, std::size_t level) const;

  const std::vector<LodChunk>& chunks_;
  std::span<const std::size_t> drawn_;
  std::vector<double> focal_;
  std::vector<glm::dvec3> eye_;
  std::vector<std::vector<Seen>> seen_;  // by view
};

}  // namespace binosplat
