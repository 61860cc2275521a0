#include "scene/repeat.h"

#include <gtest/gtest.h>

#include <set>

#include "scene/reduce.h"
#include "support/errors.h"
#include "support/models.h"
#include "support/scaffold.h"

namespace binosplat {
namespace {

using Places = std::multiset<std::pair<int, int>>;  // copies' indices along x and z

/// Returns the indices of the copies of a model with one Gaussian at (100, 5, 200), at a spacing of 10.
Places places_of(const Model& repeated) {
  Places places;
  for (const glm::vec3& p : repeated.position) {
    EXPECT_EQ(p.y, 5.0f);
    places.insert({static_cast<int>((p.x - 100.0f) / 10.0f), static_cast<int>((p.z - 200.0f) / 10.0f)});
  }
  return places;
}

Places places_from(int x_low, int x_high, int z_low, int z_high) {
  Places places;
  for (int i = x_low; i <= x_high; ++i) {
    for (int j = z_low; j <= z_high; ++j) places.insert({i, j});
  }
  return places;
}

Model one() {
  Model model;
  model.degree = 1;
  test::add(model, {100, 5, 200}, {1, 2, 3}, 0.5f, {0.2f, 0.4f, 0.6f});
  return model;
}

TEST(Repeat, PlacesCopiesOnCentredGrid) {
  EXPECT_EQ(places_of(repeat(one(), 8, 4, 10.0)), places_from(-3, 4, -1, 2));
  EXPECT_EQ(places_of(repeat(one(), 2, 8, 10.0)), places_from(0, 1, -3, 4));
  EXPECT_EQ(places_of(repeat(one(), 3, 1, 10.0)), places_from(-1, 1, 0, 0));
  EXPECT_NE(places_of(repeat(one(), 8, 4, 10.0)), places_from(-4, 3, -2, 1)) << "shifted by one";
  EXPECT_NE(places_of(repeat(one(), 8, 4, 10.0)), places_from(-1, 2, -3, 4)) << "x and z swapped";
}

TEST(Repeat, CopiesAnchorsWithNetworks) {
  const Model model = test::scaffold_model(1, {.anchors = 5, .offsets = 4});
  const Model many = repeat(model, 2, 1, 10.0);
  ASSERT_EQ(many.count(), 40u);
  const Scaffold &one = *model.scaffold, &two = *many.scaffold;
  EXPECT_EQ(one.anchor_count(), 5u) << "the model itself is left alone";
  for (std::size_t id = 0; id < 20; ++id) {
    EXPECT_EQ(two.mean(id), one.mean(id));
    EXPECT_LT(glm::length(two.mean(20 + id) - one.mean(id) - glm::vec3(10, 0, 0)), 1e-5f);
    EXPECT_EQ(many.position[id], two.mean(id));
    EXPECT_EQ(two.offset[20 + id], one.offset[id]);
  }
  EXPECT_EQ(two.feature.size(), 2 * one.feature.size());
  EXPECT_EQ(two.feature[5 * 32 + 7], one.feature[7]);
  EXPECT_EQ(two.scale[9], one.scale[4]);
  EXPECT_EQ(two.colour.second, one.colour.second);
}

TEST(Repeat, CopiesAllProperties) {
  Model model = test::random_model(3, 500, 2);
  model.left_out = 7;
  const Model once = repeat(model, 1, 1, 4.0);
  EXPECT_EQ(once.position, model.position);
  const Model many = repeat(model, 2, 3, 4.0);
  Model all = model;
  for (int copies = 1; copies < 6; ++copies) append(all, model, 0, model.count());
  EXPECT_EQ(many.left_out, 7u);
  EXPECT_EQ(many.degree, 2);
  EXPECT_EQ(many.name, model.name);
  EXPECT_EQ(many.scale, all.scale);
  EXPECT_EQ(many.rotation, all.rotation);
  EXPECT_EQ(many.opacity, all.opacity);
  EXPECT_EQ(many.sh, all.sh);
  EXPECT_EQ(many.sh.capacity(), many.sh.size());
  EXPECT_EQ(many.rotation.capacity(), 3000u);
}

// A copy near the camera keeps its digits, however far it is from the others.
TEST(Repeat, FarCopiesAreExactNearCamera) {
  Camera camera;
  camera.position = {4e8, 0, 0};
  for (const Model& model : {test::random_model(3, 50, 1), test::scaffold_model(1, {.anchors = 5})}) {
    const std::size_t n = model.count();
    const auto error_of = [&](const Model& many) {
      double most = 0.0;
      for (std::size_t k = 0; k < n; ++k)
        most = std::max(most, glm::distance(many.axes.origin + glm::dvec3(many.position[n + k]),
                                            glm::dvec3(model.position[k]) + glm::dvec3(4e8, 0, 0)));
      return most;
    };
    const Model many = repeat(model, 2, 1, 4e8, {&camera, 1});
    ASSERT_EQ(many.count(), 2 * n);
    EXPECT_LT(error_of(many), 1e-5);
    EXPECT_GT(error_of(repeat(model, 2, 1, 4e8)), 1.0) << "injected: no camera";
    if (model.scaffold) {
      EXPECT_EQ(many.position[n], many.scaffold->mean(n));
    }
  }
}

// The origin moves only if floats round visibly, and then to the first camera, in the model's axes.
TEST(Repeat, MovesOriginOnlyIfNeeded) {
  Camera camera;
  camera.position = {4e6, 5, 6};
  ModelAxes axes = {"RUB", {1, 2, 3}};
  EXPECT_EQ(move_near({&camera, 1}, 1000.0, axes), glm::dvec3(0.0));
  EXPECT_EQ(move_near({}, 1e9, axes), glm::dvec3(0.0));
  EXPECT_EQ(axes.origin, glm::dvec3(1, 2, 3));
  EXPECT_EQ(move_near({&camera, 1}, 1e4, axes), glm::dvec3(4e6 - 1, -5 - 2, -6 - 3));
  EXPECT_EQ(axes.origin, glm::dvec3(4e6, -5, -6));
}

TEST(Repeat, RejectsExcessiveCounts) {
  EXPECT_ERROR(repeat(one(), 0, 2, 1.0), "`repeat` 0x2");
  EXPECT_ERROR(repeat(one(), 2, -1, 1.0), "`repeat` 2x-1");
  EXPECT_ERROR(repeat(one(), 65536, 65536, 1.0), "more than 2^31");
  EXPECT_ERROR(repeat(one(), 2147483647, 2147483647, 1.0), "more than 2^31");
  EXPECT_ERROR(repeat(one(), 2, 2, 1e39), "`spacing` 1e+39");
  EXPECT_ERROR(repeat(one(), 2, 2, std::nan("")), "`spacing` nan");
}

}  // namespace
}  // namespace binosplat
