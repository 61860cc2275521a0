#pragma once
// Merges Gaussians for views from afar: near neighbours become one, cheapest pair first.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <queue>
#include <span>
#include <tuple>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Appends to `merged`, a model of equal degree, one Gaussian in place of `members` of `model`, for views in
/// which a pixel covers `pixel` world units. A is the area of an ellipsoid's shadow, averaged over all
/// directions: a quarter of its surface (Cauchy; Thomsen's formula), including the low-pass of such a pixel.
/// With the weight w = opacity A:
/// - mean and covariance are the moments of the members' mixture, weighted by w (moment matching);
/// - harmonics are means weighted by w;
/// - the covered area is sum(w), as if no members overlapped, or a second area if that is smaller: members at
///   random places in an evenly filled square with the mixture's moments cover S (1 - exp(-sum(tau A) / S)),
///   tau = -ln(1 - opacity), S = 6 / pi A (Beer and Lambert);
/// - opacity is the covered area over A; above 0.999 the Gaussian grows instead.
/// A single member is appended unchanged.
void append_merged(Model& merged, const Model& model, std::span<const std::uint32_t> members, double pixel);

struct Cluster {
  glm::dvec3 mean{0.0};
  glm::dmat3 covariance{0.0};
  double weight = 0.0;     // opacity times area
  glm::dvec3 colour{0.0};  // harmonics of degree 0
};

/// Merges a model step by step, always the cheapest pair of near neighbours. The cost has two terms:
/// Runnalls' bound of the mixture's loss of shape (Runnalls 2007, equation 16), and the squared difference of
/// colours times wa wb / (wa + wb), where wa and wb are the clusters' weights.
class Merger {
 public:
  /// The model must outlive this object and have at least one Gaussian. A pixel covers `pixel` world units.
  Merger(const Model& model, double pixel);

  /// Merges until at most `target` clusters are left, or one.
  void merge_to(std::size_t target);

  /// Returns one Gaussian for each cluster, computed from all of its members (append_merged), in the order of
  /// their first members.
  Model result(double pixel) const;

 private:
  /// The cheapest merge of cluster `a`. A cluster has the number of its first member.
  struct MergeCandidate {
    double cost;
    std::uint32_t a, b;
    std::uint32_t age_a, age_b;  // merge_counts_ of `a` and `b` when `cost` was computed
    bool operator<(const MergeCandidate& other) const {  // the cheapest on top
      return std::tie(other.cost, other.a, other.b) < std::tie(cost, a, b);
    }
  };

  std::vector<std::uint32_t> living() const;
  /// Finds the neighbours of all clusters. Called at first, and again when no candidate is left.
  void find_neighbours();
  void add_candidate(std::uint32_t a);
  void merge(std::uint32_t a, std::uint32_t b);
  std::uint32_t cluster_of(std::uint32_t k);

  const Model& model_;
  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> next_, last_;   // members of each cluster, linked from its first
  std::vector<std::uint32_t> parent_;        // the cluster into which each was merged, or itself
  std::vector<std::uint32_t> merge_counts_;  // number of merges of each cluster so far
  std::vector<std::vector<std::uint32_t>> near_;
  std::priority_queue<MergeCandidate> cheapest_;
  std::size_t left_;
};

}  // namespace binosplat
