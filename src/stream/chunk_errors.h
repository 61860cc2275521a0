#pragma once
// What views see of chunks, and what levels of detail lose of that: what choose_within() goes by.

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "stream/choice.h"

namespace binosplat {

/// What is seen of all chunks by each view, and by the sphere around them, which comes last and sees what
/// none of them does.
class ChunkErrors {
 public:
  /// Of chunks, and what was measured of them, which must outlive it.
  ChunkErrors(const std::vector<LodChunk>& chunks, const std::vector<DetailView>& views,
              const VisibleChunks& visible, bool heads_turn);

  /// Squared error of each level of a chunk, summed over px; left as it is where it is none.
  void find_errors(std::size_t view, std::size_t c, double* errors) const;

  double longest_focal() const { return focal_.back(); }

 private:
  struct Seen : ChunkVisibility {
    double outside = 0.0;  // how far beside the picture it lies, world units
  };
  double area(std::size_t view, std::size_t c, std::size_t level) const;

  const std::vector<LodChunk>& chunks_;
  std::span<const std::size_t> drawn_;
  std::vector<double> focal_;
  std::vector<glm::dvec3> eye_;
  std::vector<std::vector<Seen>> seen_;  // by view
};

}  // namespace binosplat
