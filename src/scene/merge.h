#pragma once
// Fewer Gaussians that look alike from afar: near neighbours become one, pair by pair, where that changes
// least.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <queue>
#include <span>
#include <tuple>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Appends to `merged`, which has the model's degree, one Gaussian in place of `members` of a model, to be
/// seen where a pixel covers `pixel` world units. With A the mean area of an ellipsoid's shadow (Cauchy's
/// quarter of the surface; Thomsen's formula), the low-pass of such a pixel included, and w = opacity A:
/// - mean and covariance are those of the members' mixture, each with its w (moment matching);
/// - harmonics are their means by w;
/// - what it covers is sum(w), as if nothing overlapped, or, if that is less, what members at random places
///   cover of an even square with the mixture's moments: S (1 - exp(-sum(tau A) / S)), tau = -ln(1 -
///   opacity), S = 6 / pi A (Beer and Lambert);
/// - opacity is that over A; beyond 0.999 it is the area that grows.
/// A single member is appended as it is.
void append_merged(Model& merged, const Model& model, std::span<const std::uint32_t> members, double pixel);

/// One Gaussian or what some were merged into.
struct MergedPart {
  glm::dvec3 mean{0.0};
  glm::dmat3 covariance{0.0};
  double weight = 0.0;     // opacity times area
  glm::dvec3 colour{0.0};  // harmonics of degree 0
};

/// Merges a model step by step. Of all pairs of near neighbours the one is merged that changes least, again
/// and again: its Runnalls' bound of what the mixture's shape loses (Runnalls 2007, equation 16), and the
/// squared difference of the pair's colours, times the area that shows it.
class Merger {
 public:
  /// The model, which outlives this, has one Gaussian at least. Areas are seen where a pixel covers `pixel`
  /// world units.
  Merger(const Model& model, double pixel);

  /// Merges until no more than `target` are left, or one.
  void bring_to(std::size_t target);

  /// What is left, each merged at once from all of its members (append_merged), in the order of their first
  /// ones.
  Model result(double pixel) const;

 private:
  /// The best of those that `a` may be merged with. Clusters are named by their first members.
  struct Offer {
    double cost;
    std::uint32_t a, b;
    std::uint32_t age_a, age_b;                 // when it was made
    bool operator<(const Offer& other) const {  // the cheapest on top
      return std::tie(other.cost, other.a, other.b) < std::tie(cost, a, b);
    }
  };

  std::vector<std::uint32_t> living() const;
  /// Of all that are left: at first, and where islands have become one each.
  void find_neighbours();
  void make_offer(std::uint32_t a);
  void merge(std::uint32_t a, std::uint32_t b);
  std::uint32_t cluster_of(std::uint32_t k);

  const Model& model_;
  std::vector<MergedPart> parts_;
  std::vector<std::uint32_t> next_, last_;  // members of a cluster, from its first
  std::vector<std::uint32_t> into_;         // itself, or what it was merged into
  std::vector<std::uint32_t> ages_;         // merges so far
  std::vector<std::vector<std::uint32_t>> near_;
  std::priority_queue<Offer> cheapest_;
  std::size_t left_;
};

}  // namespace binosplat
