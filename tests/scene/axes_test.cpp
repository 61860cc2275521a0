#include "scene/axes.h"

#include <gtest/gtest.h>

#include "scene/framing.h"
#include "support/compare_moved.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

TEST(Axes, LettersAreDirections) {
  EXPECT_EQ(world_from_axes("RDF"), glm::dmat3(1.0));
  const glm::dvec3 p(1, 2, 3);
  EXPECT_EQ(world_from_axes("RUB") * p, glm::dvec3(1, -2, -3));
  EXPECT_EQ(world_from_axes("LUF") * p, glm::dvec3(-1, -2, 3));
  EXPECT_EQ(world_from_axes("RFU") * p, glm::dvec3(1, -3, 2));  // z up: y points forward
  EXPECT_EQ(glm::determinant(world_from_axes("RUF")), -1.0);    // Unity's axes include a reflection
  for (const char* wrong : {"", "RD", "RDFF", "RLF", "RRF", "XYZ", "rdf"}) {
    EXPECT_ERROR(world_from_axes(wrong), "axes '", wrong, "RDF") << wrong;
  }
}

// Checks that a model and a camera in another frame give the same picture: the same positions at the same
// depth.
TEST(Axes, CamerasKeepView) {
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
  // Injected fault: the camera is not converted.
  const glm::dvec3 stored = glm::transpose(world_from_axes("RUB")) * p;
  EXPECT_GT(glm::length(glm::transpose(camera.rotation) * (stored - camera.position) - seen), 0.1);
}

// A model's frame of reference does not change its generated cameras in the world.
TEST(Axes, FramingDoesNotDependOnAxes) {
  const Model model = test::random_model(3, 501, 0);
  for (const char* letters : {"RUB", "LUF", "RUF", "RFU"}) {
    Model turned = model;
    bring_into_axes(turned, letters);
    const Camera expected = frame_model(model, 640, 480), found = frame_model(turned, 640, 480);
    EXPECT_LT(glm::length(found.position - expected.position), 1e-6) << letters;
    EXPECT_LT(glm::length(found.rotation[0] - expected.rotation[0]), 1e-9) << letters;
    EXPECT_LT(glm::length(found.rotation[1] - expected.rotation[1]), 1e-9) << letters;
    turned.axes.letters = "RDF";  // injected fault
    EXPECT_GT(glm::length(frame_model(turned, 640, 480).position - expected.position), 0.01) << letters;
  }
}

TEST(Axes, ModelsKeepAppearance) {
  const Model model = test::random_model(1, 20, 3);
  int frames = 0;
  for (const char x : std::string("RLUDFB")) {
    for (const char y : std::string("RLUDFB")) {
      for (const char z : std::string("RLUDFB")) {
        const std::string to = {x, y, z};
        Model turned = model;
        try {
          bring_into_axes(turned, to);
        } catch (const Error&) {
          continue;  // the letters name no three axes
        }
        ++frames;
        const glm::dmat3 map = glm::transpose(world_from_axes(to));
        const auto is_turned = [&](const Model& found) {
          return test::follows(test::apart(model, found, glm::dmat4(map), map));
        };
        EXPECT_TRUE(is_turned(turned)) << to;
        Model faulty = turned;  // injected fault: only positions are rotated
        faulty.sh = model.sh;
        EXPECT_EQ(is_turned(faulty), to == "RDF") << to;
        faulty = turned;
        faulty.rotation = model.rotation;
        // A reflection through a point changes no ellipsoid.
        EXPECT_EQ(is_turned(faulty), to == "RDF" || to == "LUB") << to;
        bring_into_axes(turned, "RDF");
        EXPECT_TRUE(test::follows(test::apart(model, turned, glm::dmat4(1.0), glm::dmat3(1.0)))) << to;
      }
    }
  }
  EXPECT_EQ(frames, 48);
}

// Flips only change signs. These are the signs in other programs' files.
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
