#include "scene/transform.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "support/compare_moved.h"
#include "support/models.h"

namespace binosplat {
namespace {

bool transform(Model& model, const glm::dmat4& map) {
  std::vector<glm::dvec3> places;
  return binosplat::transform(model, map, places);
}

using test::apart;
using test::follows;

glm::dmat3 turn_by(double angle, const glm::dvec3& axis) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, axis));
}

glm::dmat3 diagonal(const glm::dvec3& d) { return {d.x, 0, 0, 0, d.y, 0, 0, 0, d.z}; }

glm::dmat4 with(const glm::dmat3& linear, const glm::dvec3& translation) {
  glm::dmat4 map(linear);
  map[3] = glm::dvec4(translation, 1.0);
  return map;
}

const glm::dmat3 q = turn_by(0.7, {1, 2, -0.5}), axes = turn_by(1.9, {0.3, -1, 0.8});
const glm::dmat3 mirror = diagonal({1, -1, 1});

struct Case {
  const char* name;
  glm::dmat3 orthogonal, stretch;  // the polar factors
};

// The matrix is the product of polar factors, which the code must find.
TEST(Transform, AppliesAnyLinearMap) {
  const Model model = test::random_model(5, 300, 3);
  const glm::dmat3 stretch = axes * diagonal({0.4, 1.0, 2.5}) * glm::transpose(axes);
  const Case cases[] = {
      {"nothing", glm::dmat3(1.0), glm::dmat3(1.0)},
      {"turn", q, glm::dmat3(1.0)},
      {"half turn", diagonal({-1, -1, 1}), glm::dmat3(1.0)},
      {"even scale", q, diagonal({3, 3, 3})},
      {"uneven scale", q, diagonal({0.2, 1.5, 4.0})},
      {"shear", q, stretch},
      {"mirror", mirror, glm::dmat3(1.0)},
      {"turned mirror", q * mirror, diagonal({2, 2, 2})},
      {"sheared mirror", q * mirror, stretch},
      {"through a point", -q, stretch},
      {"nearly flat", q, diagonal({1, 1e-4, 1})},
  };
  for (const Case& c : cases) {
    const glm::dmat4 map = with(c.orthogonal * c.stretch, {0.5, -0.25, 2});
    Model moved = model;
    ASSERT_TRUE(transform(moved, map)) << c.name;
    EXPECT_TRUE(follows(apart(model, moved, map, c.orthogonal))) << c.name;
    for (const glm::vec4& rotation : moved.rotation)
      ASSERT_NEAR(glm::length(rotation), 1.0f, 1e-6f) << c.name;
    // Injected faults: harmonics that are not rotated, harmonics without the reflection, and shapes of the
    // old size.
    if (c.orthogonal != glm::dmat3(1.0)) {
      Model faulty = moved;
      faulty.sh = model.sh;
      EXPECT_FALSE(follows(apart(model, faulty, map, c.orthogonal))) << c.name;
      EXPECT_FALSE(follows(apart(model, moved, map, c.orthogonal * mirror))) << c.name;
    }
    if (c.stretch != glm::dmat3(1.0)) {
      Model faulty = moved;
      faulty.scale = model.scale;
      EXPECT_FALSE(follows(apart(model, faulty, map, c.orthogonal))) << c.name;
    }
  }
}

// A flattening matrix leaves Gaussians flat. It has no handedness.
TEST(Transform, HandlesSingularMaps) {
  const Model model = test::random_model(6, 50, 2);
  const glm::dmat4 map(q * diagonal({1, 0, 2}));
  Model moved = model;
  ASSERT_TRUE(transform(moved, map));
  EXPECT_TRUE(follows(apart(model, moved, map, q)));
  Model gone = model;
  ASSERT_TRUE(transform(gone, glm::dmat4(glm::dmat3(0.0))));
  for (const glm::vec3& s : gone.scale) EXPECT_EQ(s, glm::vec3(0.0f));
  EXPECT_EQ(gone.position[7], glm::vec3(0.0f));
}

// A detour by covariances would lose a scale that is a millionth of another.
TEST(Transform, KeepsThinGaussians) {
  Model model;
  test::add(model, {0, 0, 1}, {1.0f, 1e-6f, 1e-3f}, 1.0f, glm::vec3(1.0f), {0.3f, 0.4f, -0.8f, 0.1f});
  ASSERT_TRUE(transform(model, glm::dmat4(diagonal({1, 2, 1}))));
  const glm::dvec3 s(model.scale[0]);
  // The determinant is the product of the scales, whatever the axes are.
  EXPECT_NEAR(s.x * s.y * s.z / (2.0 * 1e-9), 1.0, 1e-4);
  EXPECT_LT(s.z, 2.1e-6);
}

TEST(Transform, RejectsOverflow) {
  for (const glm::dmat4& map : {with(glm::dmat3(1.0), {1e90, 0, 0}), with(diagonal({1e90, 1, 1}), {0, 0, 0}),
                                with(glm::dmat3(INFINITY), {0, 0, 0}), with(glm::dmat3(NAN), {0, 0, 0})}) {
    Model model = test::random_model(7, 3, 1);
    EXPECT_FALSE(transform(model, map));
  }
  // Scales end where those of files do.
  for (const double largest : {0.999e13, 1.001e13}) {
    Model model;
    test::add(model, {0, 0, 0}, {1, 2, 3}, 0.5f, glm::vec3(1.0f));
    EXPECT_EQ(transform(model, glm::dmat4(glm::dmat3(largest / 3.0))), largest < 1e13);
  }
}

}  // namespace
}  // namespace binosplat
