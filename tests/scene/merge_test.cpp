#include "scene/merge.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <vector>

#include "support/compare_moved.h"
#include "support/models.h"

namespace binosplat {
namespace {

using Indices = std::vector<std::uint32_t>;

constexpr double pi = std::numbers::pi;

Indices all_of(const Model& model) {
  Indices all(model.count());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Model merged(const Model& model, double pixel = 0.0) {
  Model one;
  one.degree = model.degree;
  append_merged(one, model, all_of(model), pixel);
  return one;
}

Model reduced(const Model& model, std::size_t target, double pixel = 0.0) {
  Merger merger(model, pixel);
  merger.merge_to(target);
  return merger.result(pixel);
}

/// Returns the area of an ellipsoid's shadow, averaged over all directions: along d it is pi sqrt(det C d^T
/// C^-1 d).
double shadow(const glm::dmat3& c) {
  constexpr int steps = 100;
  const glm::dmat3 inverse = glm::inverse(c);
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double z = (2.0 * i + 1.0) / steps - 1.0, r = std::sqrt(1.0 - z * z);
    for (int k = 0; k < steps; ++k) {
      const double angle = 2.0 * pi * k / steps;
      const glm::dvec3 d(r * std::cos(angle), r * std::sin(angle), z);
      sum += pi * std::sqrt(glm::determinant(c) * glm::dot(d, inverse * d));
    }
  }
  return sum / (steps * steps);
}

/// The expected result of merging all into one Gaussian, by the formulas of merge.h.
struct Expected {
  glm::dvec3 mean{0.0};
  glm::dmat3 covariance{0.0};  // before the Gaussian grows
  std::vector<double> sh;
  double covered = 0.0;  // covered area over the Gaussian's area
};

Expected expected(const Model& model, double added = 0.0, bool weighted = true) {
  const std::size_t values = model.sh.size() / model.count();
  Expected e{.sh = std::vector<double>(values)};
  double total = 0.0, depth = 0.0;
  std::vector<double> weights;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const double area = shadow(test::covariance_of(model, i) + glm::dmat3(added));
    weights.push_back(weighted ? model.opacity[i] * area : 1.0);
    total += weights[i];
    depth -= std::log(1.0 - model.opacity[i]) * area;
    e.mean += weights[i] * glm::dvec3(model.position[i]);
    for (std::size_t k = 0; k < values; ++k) e.sh[k] += weights[i] * model.sh[i * values + k];
  }
  e.mean /= total;
  for (double& value : e.sh) value /= total;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::dvec3 apart = glm::dvec3(model.position[i]) - e.mean;
    e.covariance += weights[i] / total * (test::covariance_of(model, i) + glm::outerProduct(apart, apart));
  }
  const double area = shadow(e.covariance + glm::dmat3(added)), square = 6.0 / pi * area;
  e.covered = std::min(total, square * (1.0 - std::exp(-depth / square))) / area;
  return e;
}

/// Returns the largest relative difference between a Gaussian and the expected one.
double difference(const Model& one, const Expected& e) {
  const double grown = std::max(1.0, e.covered / 0.999);
  const glm::dmat3 c = test::covariance_of(one, 0);
  double size = 0.0, most = 0.0;
  for (int k = 0; k < 3; ++k) size += e.covariance[k][k];
  for (int k = 0; k < 3; ++k) {
    most = std::max(most, glm::length(c[k] - grown * e.covariance[k]) / size);
    most = std::max(most, std::abs(one.position[0][k] - e.mean[k]) / std::sqrt(size));
  }
  for (std::size_t k = 0; k < e.sh.size(); ++k) most = std::max(most, std::abs(one.sh[k] - e.sh[k]));
  return std::max(most, std::abs(one.opacity[0] - std::min(0.999, e.covered)));
}

/// Returns Gaussians of unequal sizes, shapes and opacities.
Model random_gaussians(std::uint32_t seed, std::size_t count, double max_opacity) {
  test::Uniform uniform(seed);
  Model model;
  model.degree = 2;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [&](double low, double high) { return static_cast<float>(uniform(low, high)); };
    const glm::vec3 scale(number(0.02, 0.1), number(0.02, 0.4), number(0.1, 0.4));
    test::add(model, {number(-1, 1), number(-1, 1), number(-1, 1)}, scale, number(0.01, max_opacity),
              glm::vec3(1), {number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)});
  }
  for (float& value : model.sh) value = static_cast<float>(uniform(-1, 1));
  return model;
}

// Thomsen's formula is within 1.1 % of the area.
constexpr double near_enough = 0.015;

TEST(Merge, KeepsMomentsOfMixture) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Model model = random_gaussians(seed, 2 + seed % 5, seed % 2 == 0 ? 0.2 : 0.99);
    EXPECT_LT(difference(merged(model), expected(model)), near_enough) << seed;
    // Injected: members have equal weights, whatever they cover.
    EXPECT_GT(difference(merged(model), expected(model, 0.0, false)), 2.0 * near_enough) << seed;
  }
}

TEST(Merge, IncludesLowPassOfPixel) {
  constexpr double pixel = 0.5, low_pass = KERNEL_PX2 * pixel * pixel;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Model model = random_gaussians(seed, 6, 0.3);
    EXPECT_LT(difference(merged(model, pixel), expected(model, low_pass)), near_enough) << seed;
    // Injected: without the low-pass, which enlarges thin Gaussians more than large ones.
    EXPECT_GT(difference(merged(model), expected(model, low_pass)), 2.0 * near_enough) << seed;
    model.antialiased = true;  // covers the same at any pixel size
    EXPECT_EQ(merged(model, pixel).opacity, merged(model).opacity) << seed;
  }
}

TEST(Merge, GrowsAtOpacityLimit) {
  Model model;
  for (const float x : {-1.0f, 1.0f}) test::add(model, {x, 0, 0}, {0.7f, 0.7f, 0.01f}, 0.99f);
  const Model one = merged(model);
  EXPECT_EQ(one.opacity[0], 0.999f);
  const double moments = std::sqrt(0.7 * 0.7 + 1.0);
  EXPECT_GT(one.scale[0].z, 1.05 * moments);
  EXPECT_LT(one.scale[0].z, std::sqrt(6.0 / pi) * moments) << "no more than an even square";
}

TEST(Merge, KeepsSingleGaussian) {
  Model model = random_gaussians(3, 1, 0.5);
  model.opacity[0] = 1.0f;
  for (const Model& one : {merged(model, 2.0), reduced(model, 1, 2.0), reduced(model, 5)}) {
    EXPECT_EQ(one.position, model.position);
    EXPECT_EQ(one.scale, model.scale);
    EXPECT_EQ(one.rotation, model.rotation);
    EXPECT_EQ(one.opacity, model.opacity);
    EXPECT_EQ(one.sh, model.sh);
  }
}

TEST(Merger, ReachesRequestedCount) {
  const Model model = test::random_model(5, 300, 1);
  Merger merger(model, 0.01);
  for (const std::size_t target : {500, 300, 299, 150, 149, 38, 2, 1, 0}) {
    merger.merge_to(target);
    const Model fewer = merger.result(0.01);
    EXPECT_EQ(fewer.count(), std::clamp<std::size_t>(target, 1, 300));
    EXPECT_EQ(fewer.sh.size(), fewer.count() * 12);
    // In steps or at once, the result is equal bit for bit.
    const Model at_once = reduced(model, target, 0.01);
    EXPECT_EQ(fewer.position, at_once.position);
    EXPECT_EQ(fewer.sh, at_once.sh);
  }
}

// Pairs side by side. Of four in a row, the two of one colour merge.
TEST(Merger, MergesSimilarGaussians) {
  Model model;
  for (int i = 0; i < 20; ++i) {
    for (const float x : {-0.1f, 0.1f})
      test::add(model, {static_cast<float>(i) + x, 0, 0}, glm::vec3(0.1f), 0.5f, glm::vec3(0.05 * i));
  }
  const Model pairs = reduced(model, 20);
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(pairs.position[static_cast<std::size_t>(i)].x, i, 1e-6);
  Model row;
  for (const int red : {0, 1, 1, 0})
    test::add(row, {0.2f * static_cast<float>(row.count()), 0, 0}, glm::vec3(0.1f), 0.5f, {red, 0, 0});
  const Model three = reduced(row, 3);
  EXPECT_NEAR(three.position[1].x, 0.3, 1e-6);
}

void expect_sound(const Model& model) {
  const auto finite = [](const auto& v) { return !glm::any(glm::isnan(v)) && !glm::any(glm::isinf(v)); };
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_TRUE(finite(model.position[i]) && finite(model.scale[i])) << i;
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(model.scale[i], glm::vec3(0)))) << i;
    EXPECT_NEAR(glm::length(model.rotation[i]), 1.0, 1e-6) << i;
    EXPECT_TRUE(model.opacity[i] >= 0.0f && model.opacity[i] <= 1.0f) << model.opacity[i];
  }
  for (const float value : model.sh) EXPECT_TRUE(std::isfinite(value));
}

TEST(Merger, AcceptsDegenerateGaussians) {
  using Change = std::function<void(Model&, std::size_t)>;
  const std::vector<Change> changes = {
      [](Model& m, std::size_t i) { m.position[i] = glm::vec3(7); },
      [](Model& m, std::size_t i) { m.position[i] *= 1e30f; },
      [](Model& m, std::size_t i) { m.scale[i] = glm::vec3(0); },
      [](Model& m, std::size_t i) {
        m.scale[i] = {1e-30f, 1e-9f, 1e4f};
      },
      [](Model& m, std::size_t i) { m.scale[i] = glm::vec3(1e30f); },
      [](Model& m, std::size_t i) { m.opacity[i] = 0; },
      [](Model& m, std::size_t i) { m.opacity[i] = 1; },
      [](Model& m, std::size_t i) { m.opacity[i] = static_cast<float>(i % 2); },
      [](Model& m, std::size_t i) {
        m.position[i] = glm::vec3(7), m.scale[i] = glm::vec3(0), m.opacity[i] = 0;
      },
  };
  for (std::size_t c = 0; c < changes.size(); ++c) {
    Model model = test::random_model(7, 100, 1);
    for (std::size_t i = 0; i < model.count(); ++i) changes[c](model, i);
    for (const std::size_t target : {50, 3, 1}) {
      SCOPED_TRACE(fmt::format("change {}, target {}", c, target));
      const Model fewer = reduced(model, target, 0.01);
      EXPECT_EQ(fewer.count(), target);
      expect_sound(fewer);
    }
  }
}

}  // namespace
}  // namespace binosplat
