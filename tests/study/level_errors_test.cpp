// What levels of detail lose, from pictures.
#include "study/level_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/faulty_shaders.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::study {
namespace {

Model ball(float scale, float opacity, const glm::vec3& at) {
  Model model;
  model.resize(1);
  model.position[0] = at;
  model.scale[0] = glm::vec3(scale);
  model.rotation[0] = {1, 0, 0, 0};
  model.opacity[0] = opacity;
  model.sh.assign(3, static_cast<float>(0.5 / sh_c0));  // white
  return model;
}

/// A ball of so much less opacity: the integral of (o - p)^2 exp(-r^2 / s^2) over the plane, in pixels of so
/// many times the narrowest.
double expected(const LeafErrors& errors, double scale, double less, int width) {
  const double pixel = std::ldexp(errors.pixel, width), deviation = scale / pixel;
  return less * less * std::numbers::pi * (deviation * deviation + KERNEL_PX2);
}

TEST(LevelErrors, AreTheIntegralOfTheSquaredDifference) {
  // Two balls, so that the narrowest pixel is narrow beside them; one of three parts loses something.
  const auto part = [](float scale, float opacity, float less) {
    std::vector<Model> levels;
    for (const float o : {opacity, opacity - less, opacity}) {
      levels.push_back(ball(scale, o, {1.0f, 2.0f, 3.0f}));
      const Model far_away = ball(scale, o, glm::vec3(1.0f, 2.0f, 3.0f) + 12.0f * scale);
      for (int k = 0; k < 300; ++k) {  // faint ones make the picture finer
        levels.back().position.push_back(far_away.position[0]);
        levels.back().scale.push_back(far_away.scale[0]);
        levels.back().rotation.push_back(far_away.rotation[0]);
        levels.back().opacity.push_back(0.0f);
        levels.back().sh.insert(levels.back().sh.end(), 3, 0.0f);
      }
    }
    return levels;
  };
  const std::vector<std::vector<Model>> parts = {part(1.0f, 0.8f, 0.0f), part(2.0f, 0.8f, 0.4f),
                                                 part(200.0f, 0.9f, 0.3f)};
  const auto errors = level_errors(test::gl_context(), parts);
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_NEAR(errors[1].pixel, 2.0 * errors[0].pixel, 1e-5);
  for (std::size_t width = 0; width < 6; ++width) {
    const int w = static_cast<int>(width);
    EXPECT_EQ(errors[0].of_level[1][width], 0.0) << "nothing of its neighbours";
    for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(errors[i].of_level[0][width], 0.0);
    const double second = expected(errors[1], 2.0, 0.4, w), third = expected(errors[2], 200.0, 0.3, w);
    // Wide pixels sample what is as narrow as they are.
    EXPECT_NEAR(errors[1].of_level[1][width], second, 0.15 * second) << width;
    EXPECT_NEAR(errors[2].of_level[1][width], third, 0.15 * third) << width;
    EXPECT_GT(std::abs(errors[1].of_level[1][width] - expected(errors[1], 2.0, 0.3, w)), 0.15 * second);
    EXPECT_EQ(errors[1].of_level[2][width], 0.0) << "as the finest";
  }
}

TEST(LevelErrors, FaultsAreNoticed) {
  const std::vector<std::vector<Model>> parts = {
      {test::random_model(1, 300, 1), test::random_model(2, 150, 1)}};
  const auto right = level_errors(test::gl_context(), parts);
  EXPECT_EQ(level_errors(test::gl_context(), parts)[0].of_level, right[0].of_level) << "the same again";
  const test::FaultyShaders faulty("pixels.glsl", "inside ? float(TRANSMITTANCE_MIN)", "inside ? 0.05");
  EXPECT_NE(level_errors(test::gl_context(), parts)[0].of_level, right[0].of_level);
}

TEST(LevelErrors, OfManyPartsAreThoseOfEachAlone) {
  std::vector<std::vector<Model>> parts;
  for (unsigned seed = 0; seed < 30; ++seed)
    parts.push_back({test::random_model(seed, 400, 1), test::random_model(seed + 100, 50, 1)});
  const auto all = level_errors(test::gl_context(), parts);
  for (const std::size_t i : {0u, 7u, 29u}) {
    const auto alone = level_errors(test::gl_context(), std::span(parts).subspan(i, 1));
    EXPECT_EQ(alone[0].pixel, all[i].pixel);
    for (std::size_t width = 0; width < 6; ++width)  // directions differ by up to 5 degrees, and rounding
      EXPECT_NEAR(alone[0].of_level[1][width], all[i].of_level[1][width], 0.05 * alone[0].of_level[1][width]);
  }
}

TEST(LevelErrors, WhatHasNoExtentIsDrawn) {
  const std::vector<std::vector<Model>> parts = {{ball(0.0f, 0.5f, {0, 0, 0}), ball(0.0f, 0.25f, {0, 0, 0})}};
  const auto errors = level_errors(test::gl_context(), parts);
  EXPECT_EQ(errors[0].pixel, 1.0);
  for (const double error : errors[0].of_level[1])
    EXPECT_NEAR(error, expected(errors[0], 0.0, 0.25, 0), 0.015);
}

}  // namespace
}  // namespace binosplat::study
