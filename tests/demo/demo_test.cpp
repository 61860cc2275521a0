// demo:room and demo:city.

#include "demo/demo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "support/errors.h"
#include "support/round_trip.h"

namespace binosplat {
namespace {

constexpr std::size_t small = 20'000;

const Demo& room() {
  static const Demo demo = demo_room();
  return demo;
}

const Demo& city() {
  static const Demo demo = demo_city({.count = small});
  return demo;
}

template <typename T>
void add_bits(std::uint64_t& hash, const std::vector<T>& values) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t i = 0; i < values.size() * sizeof(T); ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
}

/// Returns the FNV-1a hash of all bits of a model.
std::uint64_t hash_of(const Model& m) {
  std::uint64_t hash = 14695981039346656037ull;
  add_bits(hash, m.position);
  add_bits(hash, m.scale);
  add_bits(hash, m.rotation);
  add_bits(hash, m.opacity);
  add_bits(hash, m.sh);
  return hash;
}

TEST(Demo, IsDeterministic) {
  const Model &of_room = room().model, &of_city = city().model;
  const auto alone = without_helpers();
  Model again = demo_room().model;
  EXPECT_TRUE(test::same_bits(of_room, again));
  EXPECT_TRUE(test::same_bits(of_city, demo_city({.count = small}).model));
  again.sh.back() = std::nextafter(again.sh.back(), 1.0f);
  EXPECT_FALSE(test::same_bits(of_room, again)) << "a difference in the last bit goes unnoticed";
}

TEST(Demo, CityHasKnownHash) {
  // The hash of this city. If you change the city on purpose, update the number.
  EXPECT_EQ(hash_of(city().model), 15864830530030568793ull);
}

TEST(Demo, SeedsMakeDifferentCities) {
  const Demo other = demo_city({.seed = 2, .count = small});
  EXPECT_EQ(other.model.count(), small);
  std::size_t elsewhere = 0;
  for (std::size_t i = 0; i < small; ++i)
    elsewhere += glm::distance(other.model.position[i], city().model.position[i]) > 0.1f;
  EXPECT_GT(elsewhere, small / 2);
}

TEST(Demo, HasRequestedCount) {
  const Model& of_room = room().model;
  EXPECT_EQ(of_room.name, "demo:room");
  EXPECT_EQ(of_room.degree, 3);
  EXPECT_GE(of_room.count(), 60000u);
  EXPECT_LE(of_room.count(), 100000u);
  for (const std::size_t count : {city_count_min, std::size_t{23'457}, std::size_t{150'001}}) {
    const Model m = demo_city({.seed = count, .count = count}).model;
    EXPECT_EQ(m.name, "demo:city");
    EXPECT_EQ(m.degree, 1);
    EXPECT_EQ(m.count(), count);
    // Models of tens of millions of Gaussians must not reserve twice their memory.
    EXPECT_EQ(m.position.capacity(), count);
    EXPECT_EQ(m.sh.capacity(), count * 12);
  }
  EXPECT_ERROR(demo_city({.count = city_count_min - 1}), "`count` 9999: demo:city is made of");
  EXPECT_ERROR(demo_city({.count = city_count_max + 1}), "`count` 100000001");
}

/// Returns whether every value can be drawn.
bool sound(const Model& m, float largest, float min_opacity, float brightest) {
  if (m.left_out != 0 || m.scale.size() != m.count() || m.rotation.size() != m.count()) return false;
  if (m.opacity.size() != m.count() || m.sh.size() != m.count() * 3 * sh_count(m.degree)) return false;
  for (std::size_t i = 0; i < m.count(); ++i) {
    const glm::vec3 s = m.scale[i];
    if (!std::isfinite(glm::length(m.position[i]))) return false;
    if (!(std::min({s.x, s.y, s.z}) > 0.0f && std::max({s.x, s.y, s.z}) < largest)) return false;
    if (std::abs(glm::length(m.rotation[i]) - 1.0f) > 1e-5f) return false;
    if (!(m.opacity[i] > min_opacity && m.opacity[i] <= 0.99f)) return false;
  }
  return std::all_of(m.sh.begin(), m.sh.end(), [=](float v) { return std::abs(v) < brightest; });
}

TEST(Demo, ValuesAreValid) {
  EXPECT_TRUE(sound(room().model, 100.0f, 0.0f, 20.0f));
  Model m = city().model;
  EXPECT_TRUE(sound(m, 1000.0f, 0.9f, 5.0f));
  m.scale[small - 1].y = 0.0f;
  EXPECT_FALSE(sound(m, 1000.0f, 0.9f, 5.0f)) << "a Gaussian left empty goes unnoticed";
}

TEST(Demo, RoomHasThinTranslucentAndShinyGaussians) {
  const Model& m = room().model;
  std::size_t thin = 0, translucent = 0, view_dependent = 0;
  for (std::size_t i = 0; i < m.count(); ++i) {
    glm::vec3 s = m.scale[i];
    std::sort(&s.x, &s.x + 3);
    thin += s.z > 3.0f * s.y && s.y < 0.005f;
    translucent += m.opacity[i] < 0.3f;
    const auto begin = m.sh.begin() + static_cast<std::ptrdiff_t>(48 * i);
    view_dependent += std::any_of(begin + 12, begin + 48, [](float v) { return std::abs(v) > 0.01f; });
  }
  EXPECT_GT(thin, 1000u) << "wires";
  EXPECT_GT(translucent, 500u) << "glass";
  EXPECT_GT(view_dependent, 10000u) << "degree 2 and 3 in use";
}

/// Returns the positions of the Gaussians in a camera's picture, in the camera's space, sorted by depth.
std::vector<glm::dvec3> seen_by(const Camera& camera, const Model& model) {
  std::vector<glm::dvec3> seen;
  for (const glm::vec3& p : model.position) {
    const glm::dvec3 v = glm::transpose(camera.rotation) * (glm::dvec3(p) - camera.position);
    const double x = camera.fx * v.x / v.z + camera.cx, y = camera.fy * v.y / v.z + camera.cy;
    if (v.z > near_default && x > 0 && y > 0 && x < camera.width && y < camera.height) seen.push_back(v);
  }
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
  return seen;
}

TEST(Demo, SpansNearToFar) {
  const std::vector<glm::dvec3> in_room = seen_by(room().cameras.front(), room().model);
  double nearest = 1e9;
  for (const glm::dvec3& v : in_room) nearest = std::min(nearest, glm::length(v));
  EXPECT_GT(nearest, 0.3);
  EXPECT_LT(nearest, 0.6);
  EXPECT_GT(in_room.back().z, 100.0);
  for (const Camera& camera : city().cameras) {
    const std::vector<glm::dvec3> seen = seen_by(camera, city().model);
    ASSERT_GT(seen.size(), 1000u) << camera.name;
    EXPECT_LT(seen.front().z, camera.name == "air" ? 30.0 : 4.0) << camera.name;
    EXPECT_GT(seen[seen.size() - 50].z, 1000.0) << camera.name;
  }
}

TEST(Demo, CamerasAreNamedAndLevel) {
  const std::vector<Camera> of_city = city_cameras();
  for (const std::vector<Camera>& cameras : {room().cameras, of_city}) {
    ASSERT_EQ(cameras.size(), 3u);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      EXPECT_EQ(cameras[i].width, 1280);
      EXPECT_EQ(cameras[i].height, 720);
      EXPECT_FALSE(cameras[i].name.empty());
      for (std::size_t k = 0; k < i; ++k) EXPECT_NE(cameras[i].name, cameras[k].name);
      // Upright cameras: the picture's x axis is parallel to the floor.
      EXPECT_NEAR(cameras[i].rotation[0].y, 0.0, 1e-12);
      EXPECT_GT(cameras[i].rotation[1].y, 0.8);
      EXPECT_EQ(of_city[i].position, city().cameras[i].position);
    }
  }
  // The city's first camera stands in the street and looks along it.
  EXPECT_NEAR(of_city[0].position.y, -1.6, 0.1);
  EXPECT_GT(of_city[0].rotation[2].z, 0.99);
}

}  // namespace
}  // namespace binosplat
