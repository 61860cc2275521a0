#pragma once
// What views see of parts, and what levels of detail lose of that: what choose_levels_within goes by.

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "stream/detail.h"

namespace binosplat {

/// What is seen of all parts by each view, and by the sphere around them, which comes last and sees what
/// none of them does.
class Sights {
 public:
  /// Of parts, and what was seen of them, which must outlive it.
  Sights(const std::vector<DetailPart>& parts, const std::vector<DetailView>& views,
         const DetailSeen& looked_at, bool heads_turn);

  /// Squared error of each level of a part, summed over px; left as it is where it is none.
  void find_errors(std::size_t view, std::size_t p, double* errors) const;

  double longest_focal() const { return focal_.back(); }

 private:
  struct Seen : SeenPart {
    double outside = 0.0;  // how far beside the picture it lies, world units
  };
  double area(std::size_t view, std::size_t p, std::size_t level) const;

  const std::vector<DetailPart>& parts_;
  std::span<const std::size_t> drawn_;
  std::vector<double> focal_;
  std::vector<glm::dvec3> eye_;
  std::vector<std::vector<Seen>> seen_;  // by view
};

}  // namespace binosplat
