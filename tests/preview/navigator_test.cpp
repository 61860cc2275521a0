#include "preview/navigator.h"

#include <gtest/gtest.h>

#include <cmath>

namespace binosplat::preview {
namespace {

const glm::dvec3 up(0, -1, 0);

Navigator at_origin() { return {look_at({0, 0, 0}, {0, 0, 1}, up, 60, 80, 60), up, 4.0}; }

double off(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b); }

TEST(Navigator, OrbitKeepsTargetAndDistance) {
  Navigator head = at_origin();
  head.orbit(glm::radians(90.0), 0.0);
  EXPECT_LT(off(head.target(), {0, 0, 4}), 1e-12);
  // The world turns under the mouse: the head moves around the target, to one side, and keeps looking at it.
  EXPECT_NEAR(std::abs(head.camera().position.x), 4.0, 1e-12);
  EXPECT_NEAR(head.camera().position.z, 4.0, 1e-12);
  EXPECT_LT(off(head.camera().rotation[2] * 4.0 + head.camera().position, head.target()), 1e-12);
  head.orbit(0.3, 0.4);
  EXPECT_NEAR(head.distance(), 4.0, 1e-12);
  EXPECT_LT(std::abs(glm::dot(head.camera().rotation[0], up)), 1e-12) << "the horizon tilts";
}

TEST(Navigator, StaysBelowZenith) {
  Navigator head = at_origin();
  for (int k = 0; k < 100; ++k) head.orbit(0.01, 0.1);
  EXPECT_NEAR(glm::degrees(std::asin(glm::dot(head.camera().rotation[2], up))), 89.0, 1e-6);
  for (int k = 0; k < 300; ++k) head.look(0.0, -0.1);
  EXPECT_NEAR(glm::degrees(std::asin(glm::dot(head.camera().rotation[2], up))), -89.0, 1e-6);
  EXPECT_NEAR(glm::determinant(head.camera().rotation), 1.0, 1e-9);
}

TEST(Navigator, LookTurnsInNamedDirection) {
  Navigator head = at_origin();
  head.look(0.2, 0.0);
  EXPECT_GT(head.camera().rotation[2].x, 0.19) << "right is not right";
  head.look(0.0, 0.2);
  EXPECT_GT(glm::dot(head.camera().rotation[2], up), 0.19) << "up is not up";
  EXPECT_LT(off(head.camera().position, {0, 0, 0}), 1e-12);
}

TEST(Navigator, MovesAlongAxesOrGround) {
  Navigator head = at_origin();
  head.look(0.0, -0.5);
  Navigator walker = head;
  head.move(1, 0, 2);
  EXPECT_GT(head.camera().position.y, 0.9) << "flying goes where the head looks: down, along y";
  walker.move(1, 0, 2, true);
  EXPECT_LT(off(walker.camera().position, {1, 0, 2}), 1e-12);
  EXPECT_NEAR(walker.distance(), 4.0, 1e-12);
}

TEST(Navigator, FocusCentresPoint) {
  Navigator head = at_origin();
  const glm::dvec3 point(-0.7, 0.2, 2.5);
  head.focus(point);
  EXPECT_LT(off(head.target(), point), 1e-12);
  EXPECT_LT(off(head.camera().position, {0, 0, 0}), 1e-12);
  EXPECT_LT(off(glm::normalize(point), head.camera().rotation[2]), 1e-9) << "it does not look there";
  head.dolly(0.5);
  EXPECT_NEAR(head.distance(), 0.5 * glm::length(point), 1e-12);
  EXPECT_LT(off(head.target(), point), 1e-12);
  const glm::dvec3 before = head.camera().position;
  head.orbit(0.7, -0.2);
  EXPECT_GT(off(head.camera().position, before), 0.1);
  EXPECT_LT(off(head.target(), point), 1e-12) << "it goes around another point";
  EXPECT_LT(off(head.camera().position + head.distance() * head.camera().rotation[2], point), 1e-9);
}

}  // namespace
}  // namespace binosplat::preview
