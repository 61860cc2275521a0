#include "scene/detected_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/axes.h"
#include "support/models.h"

namespace binosplat {
namespace {

void add_flat(Model& model, const glm::vec3& place, const glm::vec3& scale) {
  test::add(model, place, scale, 0.95f);
}

/// Returns Gaussians around a point of the world.
Model cloud(const glm::vec3& middle) {
  Model model;
  test::Uniform uniform(4);
  const auto number = [&] { return static_cast<float>(uniform(-1, 1)); };
  for (int i = 0; i < 3000; ++i)
    add_flat(model, middle + glm::vec3(number(), number(), number()), glm::vec3(0.05f));
  return model;
}

/// Returns a floor around the world's origin, with a wall on one side.
Model bare_room() {
  Model model;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const float x = 0.05f * static_cast<float>(i) - 1.0f, z = 0.05f * static_cast<float>(j) - 1.0f;
      add_flat(model, {x, 0, z}, {0.025f, 0.0025f, 0.025f});
      if (j < 10) add_flat(model, {x, -0.05f * static_cast<float>(j), 1.0f}, {0.025f, 0.025f, 0.0025f});
    }
  }
  return model;
}

std::vector<Camera> ring_of_100(const glm::dvec3& middle) {
  std::vector<Camera> cameras;
  for (int k = 0; k < 100; ++k) {
    const double turn = glm::two_pi<double>() * k / 100;
    const glm::dvec3 eye = middle + glm::dvec3(5 * std::cos(turn), -1.5, 5 * std::sin(turn));
    cameras.push_back(look_at(eye, middle, {0, -1, 0}, 50, 64, 48));
  }
  return cameras;
}

/// Returns the model as if its file had numbers in these axes and were read as RUB.
Model stored(Model model, const std::string& axes) {
  bring_into_axes(model, axes);
  model.axes.letters = "RUB";
  return model;
}

TEST(DetectedAxes, UseCameraViews) {
  const glm::dvec3 middle(1, 2, 7);
  for (const std::string axes : {"RUB", "RDF"}) {
    for (const std::size_t count : {1u, 3u, 100u}) {
      const std::vector<Camera> all = ring_of_100(middle);
      const auto told = detect_axes(stored(cloud(middle), axes), "RDF", std::span(all).first(count));
      ASSERT_TRUE(told) << axes;
      EXPECT_EQ(told->axes, axes);
      EXPECT_FALSE(told->by_ground);
      EXPECT_GT(told->seen, 0.9);
      EXPECT_LT(told->seen_otherwise, 0.3);
    }
  }
}

// Cameras around the world's origin see the model in either frame.
TEST(DetectedAxes, FallBackToGround) {
  for (const std::string axes : {"RUB", "RDF"}) {
    const auto told = detect_axes(stored(bare_room(), axes), "RDF", ring_of_100(glm::dvec3(0)));
    ASSERT_TRUE(told) << axes;
    EXPECT_EQ(told->axes, axes);
    EXPECT_TRUE(told->by_ground);
    // Injected fault: cameras that are upside down.
    std::vector<Camera> turned = ring_of_100(glm::dvec3(0));
    for (Camera& camera : turned) {
      camera.rotation[0] = -camera.rotation[0];
      camera.rotation[1] = -camera.rotation[1];
    }
    EXPECT_NE(detect_axes(stored(bare_room(), axes), "RDF", turned)->axes, axes);
  }
}

TEST(DetectedAxes, AreNoneWithoutEvidence) {
  const glm::dvec3 origin(0);
  EXPECT_FALSE(detect_axes(stored(cloud(origin), "RDF"), "RDF", ring_of_100(origin)))
      << "round Gaussians have no ground";
  EXPECT_FALSE(detect_axes(stored(cloud({1, 2, 7}), "RDF"), "RDF", {}));
  EXPECT_FALSE(detect_axes(stored(cloud({1, 2, 7}), "RDF"), "RDF", ring_of_100({500, 0, 0})))
      << "nobody looks at it";
}

}  // namespace
}  // namespace binosplat
