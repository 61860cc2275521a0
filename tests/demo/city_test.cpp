#include "demo/city.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "support/errors.h"

namespace binosplat {
namespace {

constexpr std::size_t small = 20'000;

const Demo& city() {
  static const Demo demo = demo_city({.count = small});
  return demo;
}

template <typename T>
void add_bits(std::uint64_t& hash, const std::vector<T>& values) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t i = 0; i < values.size() * sizeof(T); ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
}

/// FNV-1a of every bit of a model.
std::uint64_t hash_of(const Model& m) {
  std::uint64_t hash = 14695981039346656037ull;
  add_bits(hash, m.position);
  add_bits(hash, m.scale);
  add_bits(hash, m.rotation);
  add_bits(hash, m.opacity);
  add_bits(hash, m.sh);
  return hash;
}

TEST(DemoCity, IsTheSameEveryTimeOnAnyNumberOfThreads) {
  Model again = demo_city({.count = small}).model;
  EXPECT_EQ(hash_of(again), hash_of(city().model));
  {
    const auto alone = without_helpers();
    EXPECT_EQ(hash_of(demo_city({.count = small}).model), hash_of(city().model));
  }
  again.sh.back() = std::nextafter(again.sh.back(), 2.0f);
  EXPECT_NE(hash_of(again), hash_of(city().model)) << "a difference in the last bit goes unnoticed";
}

TEST(DemoCity, IsTheSameWithEveryCompiler) {
  // Of this very city: whoever changes it on purpose writes the new number here.
  EXPECT_EQ(hash_of(city().model), 5525769704278480675ull);
}

TEST(DemoCity, SeedsAreDifferentCities) {
  const Demo other = demo_city({.seed = 2, .count = small});
  EXPECT_EQ(other.model.count(), small);
  EXPECT_NE(hash_of(other.model), hash_of(city().model));
  std::size_t elsewhere = 0;
  for (std::size_t i = 0; i < small; ++i)
    elsewhere += glm::distance(other.model.position[i], city().model.position[i]) > 0.1f;
  EXPECT_GT(elsewhere, small / 2);
}

TEST(DemoCity, HasExactlyAsManyGaussiansAsAsked) {
  for (const std::size_t count : {city_count_min, std::size_t{23'457}, std::size_t{150'001}}) {
    const Model m = demo_city({.seed = count, .count = count}).model;
    EXPECT_EQ(m.name, "demo:city");
    EXPECT_EQ(m.degree, 1);
    EXPECT_EQ(m.left_out, 0u);
    EXPECT_EQ(m.count(), count);
    EXPECT_EQ(m.scale.size(), count);
    EXPECT_EQ(m.rotation.size(), count);
    EXPECT_EQ(m.opacity.size(), count);
    EXPECT_EQ(m.sh.size(), count * 12);
    // Tens of millions must not take twice their room.
    EXPECT_EQ(m.position.capacity(), count);
    EXPECT_EQ(m.sh.capacity(), count * 12);
  }
  EXPECT_TRUE(test::fails_saying([] { demo_city({.count = city_count_min - 1}); },
                                 {"--count 9999: demo:city is made of"}));
  EXPECT_TRUE(test::fails_saying([] { demo_city({.count = city_count_max + 1}); }, {"--count 100000001"}));
}

/// Whether every value may be drawn.
bool sound(const Model& m) {
  for (std::size_t i = 0; i < m.count(); ++i) {
    const glm::vec3 s = m.scale[i];
    if (!std::isfinite(glm::length(m.position[i]))) return false;
    if (!(std::min({s.x, s.y, s.z}) > 0.0f && std::max({s.x, s.y, s.z}) < 1000.0f)) return false;
    if (std::abs(glm::length(m.rotation[i]) - 1.0f) > 1e-5f) return false;
    if (!(m.opacity[i] > 0.9f && m.opacity[i] <= 0.99f)) return false;
  }
  return std::all_of(m.sh.begin(), m.sh.end(), [](float v) { return std::abs(v) < 5.0f; });
}

TEST(DemoCity, EveryValueIsSound) {
  Model m = city().model;
  EXPECT_TRUE(sound(m));
  m.scale[small - 1].y = 0.0f;
  EXPECT_FALSE(sound(m)) << "a Gaussian left empty goes unnoticed";
}

/// Gaussians in the picture of the camera, by depth.
std::vector<double> depths_seen(const Camera& camera, const Model& model) {
  std::vector<double> depths;
  for (const glm::vec3& p : model.position) {
    const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(p) - camera.position);
    const double x = camera.fx * v.x / v.z + camera.cx, y = camera.fy * v.y / v.z + camera.cy;
    if (v.z > near_default && x > 0 && y > 0 && x < camera.width && y < camera.height) depths.push_back(v.z);
  }
  std::sort(depths.begin(), depths.end());
  return depths;
}

TEST(DemoCity, ReachesFromTheViewersFeetToAThousandMetres) {
  ASSERT_EQ(city().cameras.size(), 3u);
  for (const Camera& camera : city().cameras) {
    const std::vector<double> depths = depths_seen(camera, city().model);
    ASSERT_GT(depths.size(), 1000u) << camera.name;
    EXPECT_LT(depths.front(), camera.name == "air" ? 30.0 : 4.0) << camera.name;
    EXPECT_GT(depths[depths.size() - 50], 1000.0) << camera.name;
  }
}

TEST(DemoCity, CamerasAreNamedHeads) {
  const std::vector<Camera> cameras = city_cameras();
  ASSERT_EQ(cameras.size(), city().cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    EXPECT_EQ(cameras[i].name, city().cameras[i].name);
    EXPECT_EQ(cameras[i].position, city().cameras[i].position);
    EXPECT_EQ(cameras[i].width, 1280);
    EXPECT_EQ(cameras[i].height, 720);
    EXPECT_NEAR(cameras[i].rotation[0].y, 0.0, 1e-12) << "upright";
  }
  // The first stands in the street and looks along it.
  EXPECT_NEAR(cameras[0].position.y, -1.6, 0.1);
  EXPECT_GT(cameras[0].rotation[2].z, 0.99);
}

}  // namespace
}  // namespace binosplat
