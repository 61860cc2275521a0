#include "scene/axes.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "scene/framing.h"
#include "scene/harmonics.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

TEST(Axes, LettersAreDirections) {
  EXPECT_EQ(world_from_axes("RDF"), glm::dmat3(1.0));
  const glm::dvec3 p(1, 2, 3);
  EXPECT_EQ(world_from_axes("RUB") * p, glm::dvec3(1, -2, -3));
  EXPECT_EQ(world_from_axes("LUF") * p, glm::dvec3(-1, -2, 3));
  EXPECT_EQ(world_from_axes("RFU") * p, glm::dvec3(1, -3, 2));  // z up: the second number goes forward
  EXPECT_EQ(glm::determinant(world_from_axes("RUF")), -1.0);    // Unity's, a mirrored one
  for (const char* wrong : {"", "RD", "RDFF", "RLF", "RRF", "XYZ", "rdf"}) {
    EXPECT_TRUE(test::fails_saying([&] { world_from_axes(wrong); }, {"axes '", wrong, "RDF"})) << wrong;
  }
}

// A model and a camera, both brought into another frame, give the same picture: the same places in it, at the
// same depth.
TEST(Axes, CamerasSeeTheSame) {
  Camera camera = look_at({1, -2, 3}, {0.5, 0.25, -1}, {0.1, -1, 0.2}, 60, 640, 480);
  const glm::dvec3 p(0.3, -0.6, -0.9);
  const glm::dvec3 seen = glm::transpose(camera.rotation) * (p - camera.position);
  for (const char* letters : {"RDF", "RUB", "LUF", "RUF", "FRU", "BLD"}) {
    const glm::dvec3 stored = glm::transpose(world_from_axes(letters)) * p;
    const Camera entered = into_axes(camera, {letters});
    EXPECT_LT(glm::length(glm::transpose(entered.rotation) * (stored - entered.position) - seen), 1e-15)
        << letters;
    EXPECT_EQ(entered.width, 640);
  }
  // Planted fault: the camera left where it was.
  const glm::dvec3 stored = glm::transpose(world_from_axes("RUB")) * p;
  EXPECT_GT(glm::length(glm::transpose(camera.rotation) * (stored - camera.position) - seen), 0.1);
}

// However a model's numbers are turned, its camera in the world is the same.
TEST(Axes, FramesAreFoundInTheWorld) {
  const Model model = test::random_model(3, 501, 0);
  for (const char* letters : {"RUB", "LUF", "RUF", "RFU"}) {
    Model turned = model;
    turned.axes.letters = letters;
    for (glm::vec3& p : turned.position) p = glm::transpose(world_from_axes(letters)) * glm::dvec3(p);
    const Camera expected = frame_model(model, 640, 480), found = frame_model(turned, 640, 480);
    EXPECT_LT(glm::length(found.position - expected.position), 1e-6) << letters;
    EXPECT_LT(glm::length(found.rotation[0] - expected.rotation[0]), 1e-9) << letters;
    EXPECT_LT(glm::length(found.rotation[1] - expected.rotation[1]), 1e-9) << letters;
    turned.axes.letters = "RDF";  // planted fault
    EXPECT_GT(glm::length(frame_model(turned, 640, 480).position - expected.position), 0.01) << letters;
  }
}

/// R S S R^T.
glm::dmat3 covariance_of(const Model& model, std::size_t i) {
  const glm::vec4& q = model.rotation[i];
  const glm::dmat3 r = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
  const glm::dvec3 s(model.scale[i]);
  return r * glm::dmat3(s.x * s.x, 0, 0, 0, s.y * s.y, 0, 0, 0, s.z * s.z) * glm::transpose(r);
}

/// Red towards a direction, without the clamp.
double red(const Model& model, std::size_t i, const glm::dvec3& direction) {
  const auto basis = sh_basis(direction);
  double sum = 0.5;
  for (std::size_t k = 0; k < 16; ++k) sum += basis[k] * model.sh[i * 48 + 3 * k];
  return sum;
}

TEST(Axes, ModelsLookTheSameInEveryFrame) {
  const Model model = test::random_model(1, 20, 3);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -0.7, 0.5));
  int frames = 0;
  const auto same = [&](const Model& turned, std::size_t i) {
    const glm::dmat3 world = world_from_axes(turned.axes.letters);
    const glm::dmat3 there = world * covariance_of(turned, i) * glm::transpose(world);
    double apart = glm::length(world * glm::dvec3(turned.position[i]) - glm::dvec3(model.position[i])) +
                   std::abs(red(turned, i, glm::transpose(world) * direction) - red(model, i, direction));
    for (int c = 0; c < 3; ++c) apart += glm::length(there[c] - covariance_of(model, i)[c]);
    return apart < 1e-6;
  };
  for (const char x : std::string("RLUDFB")) {
    for (const char y : std::string("RLUDFB")) {
      for (const char z : std::string("RLUDFB")) {
        const std::string to = {x, y, z};
        Model turned = model;
        try {
          bring_into_axes(turned, to);
        } catch (const Error&) {
          continue;  // not three axes
        }
        ++frames;
        for (std::size_t i = 0; i < model.count(); ++i) EXPECT_TRUE(same(turned, i)) << to << " " << i;
        Model faulty = turned;  // as if only places had been turned
        faulty.sh = model.sh;
        EXPECT_EQ(same(faulty, 0), to == "RDF") << to;
        faulty = turned;
        faulty.rotation = model.rotation;
        // Mirrored through a point an ellipsoid stays what it is.
        EXPECT_EQ(same(faulty, 0), to == "RDF" || to == "LUB") << to;
        bring_into_axes(turned, "RDF");
        for (std::size_t i = 0; i < model.count(); ++i) EXPECT_TRUE(same(turned, i)) << to << " and back";
      }
    }
  }
  EXPECT_EQ(frames, 48);
}

// Flips change signs and nothing else: those that other programs' files show.
TEST(Axes, FlipsAreExact) {
  const Model model = test::random_model(2, 5, 3);
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const double signs[] = {1, -1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1};
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_EQ(turned.position[i], model.position[i] * glm::vec3(1, -1, -1));
    EXPECT_EQ(turned.scale[i], model.scale[i]);
    EXPECT_EQ(turned.rotation[i], model.rotation[i] * glm::vec4(1, 1, -1, -1));
    for (std::size_t k = 0; k < 48; ++k)
      EXPECT_EQ(turned.sh[48 * i + k], signs[k / 3] * model.sh[48 * i + k]) << k;
  }
}

}  // namespace
}  // namespace binosplat
