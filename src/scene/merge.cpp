#include "scene/merge.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nanoflann.hpp>
#include <numbers>
#include <numeric>
#include <utility>

#include "scene/reduce.h"

namespace binosplat {

namespace {

constexpr std::size_t neighbours = 8;
// Cost of one nat of lost shape. A squared colour difference of 1 costs 1.
constexpr double shape_weight = 0.3;
// Adds thinnest^2 times the trace of the merged covariance to each squared deviation, because smaller
// deviations are invisible from afar.
constexpr double thinnest = 0.5;
constexpr double max_opacity = 0.999;
// Area of an evenly filled square, divided by the integral of the Gaussian with the same moments.
constexpr double square_to_gaussian_area = 6.0 / std::numbers::pi;

double shadow(const glm::dvec3& deviations) {
  constexpr double p = 1.6075;
  const glm::dvec3 d = glm::max(deviations, 1e-12);
  const double sum = std::pow(d.x * d.y, p) + std::pow(d.x * d.z, p) + std::pow(d.y * d.z, p);
  return std::numbers::pi * std::pow(sum / 3.0, 1.0 / p);
}

/// Area of the shadow in views in which a pixel covers `pixel` world units.
double seen_area(const Model& model, const glm::dvec3& deviations, double pixel) {
  const double low_pass = model.antialiased ? 0.0 : model.kernel_px2 * pixel * pixel;
  return shadow(glm::sqrt(deviations * deviations + low_pass));
}

double opacity_of(const Model& model, std::uint32_t i) {
  return std::clamp<double>(model.opacity[i], 1e-6, max_opacity);
}

/// `area` is the area of the Gaussian's shadow.
Cluster single_cluster(const Model& model, std::uint32_t i, double area) {
  const glm::vec4& q = model.rotation[i];
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
  const glm::dvec3 s(model.scale[i]);
  const glm::dmat3 scaled(turn[0] * s.x, turn[1] * s.y, turn[2] * s.z);
  Cluster cluster{.mean = model.position[i], .covariance = scaled * glm::transpose(scaled)};
  cluster.weight = opacity_of(model, i) * area;
  const std::size_t first = std::size_t{i} * 3 * static_cast<std::size_t>(sh_count(model.degree));
  for (int c = 0; c < 3; ++c) cluster.colour[c] = sh_c0 * model.sh[first + static_cast<std::size_t>(c)];
  return cluster;
}

Cluster sum_of(const Cluster& a, const Cluster& b) {
  Cluster sum{.weight = a.weight + b.weight};
  const double share = b.weight / sum.weight;
  const glm::dvec3 apart = b.mean - a.mean;
  sum.mean = a.mean + share * apart;
  sum.covariance = (1.0 - share) * a.covariance + share * b.covariance +
                   share * (1.0 - share) * glm::outerProduct(apart, apart);
  sum.colour = glm::mix(a.colour, b.colour, share);
  return sum;
}

double log_det(glm::dmat3 covariance, double least) {
  for (int k = 0; k < 3; ++k) covariance[k][k] += least;
  // Only rounding can make the determinant smaller than least^3.
  return std::log(std::max(glm::determinant(covariance), least * least * least));
}

double cost_of(const Cluster& a, const Cluster& b) {
  const Cluster sum = sum_of(a, b);
  const double trace = sum.covariance[0][0] + sum.covariance[1][1] + sum.covariance[2][2];
  const double least = std::max(thinnest * thinnest * trace, 1e-40);
  const double shape =
      0.5 * (sum.weight * log_det(sum.covariance, least) - a.weight * log_det(a.covariance, least) -
             b.weight * log_det(b.covariance, least));
  const glm::dvec3 difference = a.colour - b.colour;
  return shape_weight * shape + a.weight * b.weight / sum.weight * glm::dot(difference, difference);
}

struct Means {
  const std::vector<Cluster>& clusters;
  const std::vector<std::uint32_t>& chosen;

  std::size_t kdtree_get_point_count() const { return chosen.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return clusters[chosen[i]].mean[static_cast<glm::length_t>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Means>, Means, 3, std::uint32_t>;

}  // namespace

void append_merged(Model& merged, const Model& model, std::span<const std::uint32_t> members, double pixel) {
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  if (members.size() == 1) {
    append(merged, model, members.front(), 1);
    return;
  }
  Cluster sum;
  double depth = 0.0;  // sum of optical depth times area
  std::vector<double> sh(values);
  for (const std::uint32_t i : members) {
    const double area = seen_area(model, model.scale[i], pixel);
    const Cluster cluster = single_cluster(model, i, area);
    sum = i == members.front() ? cluster : sum_of(sum, cluster);
    depth -= std::log(1.0 - opacity_of(model, i)) * area;
    for (std::size_t k = 0; k < values; ++k) sh[k] += cluster.weight * model.sh[i * values + k];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      Eigen::Map<const Eigen::Matrix3d>(&sum.covariance[0][0]));
  const Eigen::Vector3d along = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const glm::dvec3 deviations(along[0], along[1], along[2]);
  glm::dmat3 axes = glm::make_mat3(solver.eigenvectors().data());
  if (glm::determinant(axes) < 0.0) axes[2] = -axes[2];
  const double area = seen_area(model, deviations, pixel), square = square_to_gaussian_area * area;
  const double opacity = std::min(sum.weight, square * (1.0 - std::exp(-depth / square))) / area;
  const glm::dquat turn = glm::normalize(glm::quat_cast(axes));
  merged.position.emplace_back(sum.mean);
  merged.scale.emplace_back(deviations * std::sqrt(std::max(1.0, opacity / max_opacity)));
  merged.rotation.emplace_back(turn.w, turn.x, turn.y, turn.z);
  merged.opacity.push_back(static_cast<float>(std::min(opacity, max_opacity)));
  for (const double value : sh) merged.sh.push_back(static_cast<float>(value / sum.weight));
}

Merger::Merger(const Model& model, double pixel)
    : model_(model),
      next_(model.count()),
      merge_counts_(model.count()),
      near_(model.count()),
      left_(model.count()) {
  std::iota(next_.begin(), next_.end(), 0u);
  last_ = parent_ = next_;
  for (const std::uint32_t i : next_)
    clusters_.push_back(single_cluster(model, i, seen_area(model, model.scale[i], pixel)));
}

void Merger::merge_to(std::size_t target) {
  while (left_ > std::max<std::size_t>(target, 1)) {
    if (cheapest_.empty()) find_neighbours();
    const MergeCandidate candidate = cheapest_.top();
    cheapest_.pop();
    if (parent_[candidate.a] != candidate.a || merge_counts_[candidate.a] != candidate.age_a) continue;
    if (parent_[candidate.b] != candidate.b || merge_counts_[candidate.b] != candidate.age_b) {
      add_candidate(candidate.a);
    } else {
      merge(std::min(candidate.a, candidate.b), std::max(candidate.a, candidate.b));
    }
  }
}

Model Merger::result(double pixel) const {
  Model merged = without_gaussians(model_);
  merged.reserve(left_);
  std::vector<std::uint32_t> members;
  for (const std::uint32_t i : living()) {
    members.assign(1, i);
    while (members.back() != last_[i]) members.push_back(next_[members.back()]);
    append_merged(merged, model_, members, pixel);
  }
  return merged;
}

std::vector<std::uint32_t> Merger::living() const {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < parent_.size(); ++i) {
    if (parent_[i] == i) all.push_back(i);
  }
  return all;
}

void Merger::find_neighbours() {
  const std::vector<std::uint32_t> all = living();
  const Means means{clusters_, all};
  const Tree tree(3, means, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::array<std::uint32_t, neighbours + 1> found{};
  std::array<double, neighbours + 1> distances{};
  for (const std::uint32_t i : all) {
    const std::size_t count =
        tree.knnSearch(&clusters_[i].mean[0], found.size(), found.data(), distances.data());
    for (std::size_t k = 0; k < count; ++k) {
      if (all[found[k]] != i) near_[i].push_back(all[found[k]]);
    }
  }
  for (const std::uint32_t i : all) {
    for (std::size_t k = 0; k < std::min(near_[i].size(), neighbours); ++k) {
      std::vector<std::uint32_t>& others = near_[near_[i][k]];
      if (std::find(others.begin(), others.end(), i) == others.end()) others.push_back(i);
    }
  }
  for (const std::uint32_t i : all) add_candidate(i);
}

void Merger::add_candidate(std::uint32_t a) {
  MergeCandidate best{INFINITY, a, a, merge_counts_[a], 0};
  for (std::uint32_t& k : near_[a]) {
    k = cluster_of(k);
    if (k == a) continue;
    const double cost = cost_of(clusters_[std::min(a, k)], clusters_[std::max(a, k)]);
    if (std::tie(cost, k) < std::tie(best.cost, best.b))
      best = {cost, a, k, merge_counts_[a], merge_counts_[k]};
  }
  if (best.b != a) cheapest_.push(best);
}

void Merger::merge(std::uint32_t a, std::uint32_t b) {
  clusters_[a] = sum_of(clusters_[a], clusters_[b]);
  ++merge_counts_[a];
  parent_[b] = a;
  next_[last_[a]] = b;
  last_[a] = last_[b];
  --left_;
  // Keep the nearest neighbours of the two clusters.
  std::vector<std::pair<double, std::uint32_t>> all;
  for (const std::uint32_t of : {a, b}) {
    for (const std::uint32_t k : near_[of]) {
      const std::uint32_t now = cluster_of(k);
      const glm::dvec3 apart = clusters_[now].mean - clusters_[a].mean;
      if (now != a) all.emplace_back(glm::dot(apart, apart), now);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  all.resize(std::min(all.size(), neighbours));
  near_[a].clear();
  for (const auto& [distance, k] : all) near_[a].push_back(k);
  near_[b] = {};
  add_candidate(a);
}

std::uint32_t Merger::cluster_of(std::uint32_t k) {
  while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
  return k;
}

}  // namespace binosplat
