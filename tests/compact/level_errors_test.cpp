// The errors of levels of detail, measured in pictures.
#include "compact/level_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/faulty_shaders.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::compact {
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

/// Returns the expected visible area of a ball: the sum of alpha over pixels of a width.
double shown(const LevelErrors& errors, double scale, double opacity, std::size_t width) {
  const double deviation = scale / errors.pixels[width];
  return 2.0 * opacity * std::numbers::pi * (deviation * deviation + KERNEL_PX2);
}

/// Returns a white ball and a black one. Over their mean colour, grey, the missing part of a ball is visible.
std::vector<Model> part(double scale, double opacity, double less) {
  std::vector<Model> levels;
  for (const double o : {opacity, opacity - less, opacity}) {
    const auto s = static_cast<float>(scale);
    Model& level = levels.emplace_back(ball(s, static_cast<float>(o), {1.0f, 2.0f, 3.0f}));
    const auto add = [&](const Model& other) {
      level.position.push_back(other.position[0]);
      level.scale.push_back(other.scale[0]);
      level.rotation.push_back(other.rotation[0]);
      level.opacity.push_back(other.opacity[0]);
    };
    const glm::vec3 aside(12.0f * s);
    add(ball(s, static_cast<float>(opacity), glm::vec3(1.0f, 2.0f, 3.0f) + aside));  // black
    // More Gaussians give finer pixels.
    for (int k = 0; k < 300; ++k) add(ball(s, 0.0f, glm::vec3(1.0f, 2.0f, 3.0f) + aside));
    level.sh.resize(3 * level.count(), static_cast<float>(-0.5 / sh_c0));
  }
  return levels;
}

TEST(LevelErrors, IntegrateSquaredDifference) {
  // One of the three chunks has no error.
  const std::vector<std::vector<Model>> parts = {part(1.0, 0.8, 0.0), part(2.0, 0.8, 0.4),
                                                 part(200.0, 0.9, 0.3)};
  const auto errors = level_errors(test::gl_context(), parts);
  ASSERT_EQ(errors.size(), 3u);
  // The finest level is drawn by another program than the rest: a GPU may round otherwise.
  const double rounding = test::gl_context().software() ? 0.0 : 1e-12;
  for (std::size_t width = 0; width < 2; ++width) {
    EXPECT_NEAR(errors[1].pixels[width], 2.0 * errors[0].pixels[width], 1e-5 * errors[1].pixels[width]);
    for (std::size_t d = 0; d < detail_directions; ++d) {
      EXPECT_LE(errors[0].of_level[1][d][width], rounding) << "nothing of its neighbours";
      for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(errors[i].of_level[0][d][width], 0.0);
      // The squared difference of white from the mean grey is 0.25. The variance of black and white adds
      // 0.25.
      const auto expected = [&](double scale, double less, const LevelErrors& of) {
        const double deviation = scale / of.pixels[width];
        return (0.25 + 0.25) * less * less * std::numbers::pi * (deviation * deviation + KERNEL_PX2);
      };
      const double second = expected(2.0, 0.4, errors[1]), third = expected(200.0, 0.3, errors[2]);
      // Wide pixels sample balls that are as narrow as a pixel.
      EXPECT_NEAR(errors[1].of_level[1][d][width], second, 0.15 * second) << width;
      EXPECT_NEAR(errors[2].of_level[1][d][width], third, 0.15 * third) << width;
      EXPECT_GT(std::abs(errors[1].of_level[1][d][width] - expected(2.0, 0.3, errors[1])), 0.2 * second);
      EXPECT_LE(errors[1].of_level[2][d][width], rounding) << "as the finest";
      // Both balls count with alpha, because T is 1 where they do not overlap.
      EXPECT_NEAR(errors[1].seen[d][width], 2.0 * shown(errors[1], 2.0, 0.8, width),
                  0.2 * errors[1].seen[d][width]);
    }
  }
}

TEST(LevelErrors, CountLostCoverage) {
  const double less = 0.4;
  std::vector<Model> levels = part(2.0, 0.8, less);
  for (Model& level : levels) level.sh.assign(level.sh.size(), static_cast<float>(0.5 / sh_c0));  // all white
  const std::vector<std::vector<Model>> parts = {levels};
  const auto errors = level_errors(test::gl_context(), parts);
  // White over white differs by nothing, but at least a deviation of an eighth is assumed.
  const double deviation = 2.0 / errors[0].pixels[0];
  const double expected =
      0.125 * 0.125 * less * less * std::numbers::pi * (deviation * deviation + KERNEL_PX2);
  for (std::size_t d = 0; d < detail_directions; ++d)
    EXPECT_NEAR(errors[0].of_level[1][d][0], expected, 0.15 * expected);
  const test::FaultyShaders faulty("level_errors.comp", "min_contrast = 0.125", "min_contrast = 0.0");
  EXPECT_LT(level_errors(test::gl_context(), parts)[0].of_level[1][0][0], 0.01 * expected);
}

TEST(LevelErrors, DoNotDependOnOtherParts) {
  std::vector<std::vector<Model>> parts;
  for (unsigned seed = 0; seed < 30; ++seed)
    parts.push_back({test::random_model(seed, 400, 1), test::random_model(seed + 100, 50, 1)});
  const auto all = level_errors(test::gl_context(), parts);
  for (const std::size_t i : {0u, 7u, 29u}) {
    const auto alone = level_errors(test::gl_context(), std::span(parts).subspan(i, 1));
    EXPECT_EQ(alone[0].pixels, all[i].pixels);
    for (std::size_t d = 0; d < detail_directions; ++d) {
      // The directions differ by up to 5 degrees and by rounding.
      for (std::size_t width = 0; width < 2; ++width) {
        EXPECT_NEAR(alone[0].of_level[1][d][width], all[i].of_level[1][d][width],
                    0.1 * alone[0].of_level[1][d][width]);
        EXPECT_NEAR(alone[0].seen[d][width], all[i].seen[d][width], 0.05 * alone[0].seen[d][width]);
      }
    }
  }
}

TEST(LevelErrors, AcceptPartsWithoutExtent) {
  const std::vector<std::vector<Model>> parts = {{ball(0.0f, 0.5f, {0, 0, 0}), ball(0.0f, 0.25f, {0, 0, 0})}};
  const auto errors = level_errors(test::gl_context(), parts);
  EXPECT_EQ(errors[0].pixels.front(), 1.0);
  for (std::size_t d = 0; d < detail_directions; ++d)
    EXPECT_NEAR(errors[0].seen[d][0], shown(errors[0], 0.0, 0.5, 0), 0.1);
}

}  // namespace
}  // namespace binosplat::compact
