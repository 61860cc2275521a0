// The loss of levels in pictures of many chunks.
#include "compact/joint_loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "compact/level_errors.h"
#include "scene/reduce.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::compact {
namespace {

/// Returns chunks all around, which hide others behind them. Each level has every second Gaussian of the one
/// before.
std::vector<std::vector<Model>> chunks_around(int count) {
  std::vector<std::vector<Model>> chunks;
  for (int k = 0; k < count; ++k) {
    std::vector<Model>& levels = chunks.emplace_back();
    levels.push_back(test::random_model(static_cast<unsigned>(k) + 1, 64, 1));
    const double height = 2.0 * (k + 0.5) / count - 1.0, turn = 2.4 * k,
                 away = std::sqrt(1.0 - height * height);
    const glm::vec3 at(4.0 * away * std::cos(turn), 4.0 * away * std::sin(turn), 4.0 * height);
    for (glm::vec3& p : levels[0].position) p = 0.2f * (p - glm::vec3(0, 0, 3)) + at;
    for (glm::vec3& of_one : levels[0].scale) of_one = glm::vec3(0.3f);
    for (float& opacity : levels[0].opacity) opacity = 0.5f + 0.5f * opacity;
    for (int level = 1; level < 4; ++level) {
      std::vector<std::uint32_t> others;
      for (std::uint32_t i = 0; i < levels.back().count(); i += 2) others.push_back(i);
      levels.push_back(with_order(levels.back(), others));
    }
  }
  return chunks;
}

TEST(JointLoss, FollowsReportedErrorsAndDrawnLevels) {
  const std::vector<std::vector<Model>> chunks = chunks_around(24);
  std::vector<LevelErrors> errors = level_errors(test::gl_context(), chunks);
  const auto losses = joint_losses(test::gl_context(), chunks, errors, 2);
  ASSERT_EQ(losses.size(), 2u);
  const auto again = joint_losses(test::gl_context(), chunks, errors, 1);
  EXPECT_EQ(again.at(0).predicted, losses[0].predicted);
  EXPECT_EQ(again[0].measured, losses[0].measured);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_GT(losses[k].predicted, 0.0);
    EXPECT_LE(losses[k].predicted, 1.01e-4) << "40 dB";
    EXPECT_GT(losses[k].measured, 0.0);
  }

  // Injected: errors of a hundredth. Then pictures predicted to have 40 dB lose far more.
  for (LevelErrors& chunk : errors)
    for (auto& of_level : chunk.of_level)
      for (auto& of_direction : of_level)
        for (double& error : of_direction) error *= 0.01;
  const auto wrong = joint_losses(test::gl_context(), chunks, errors, 2);
  ASSERT_EQ(wrong.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_GT(wrong[k].measured / wrong[k].predicted, 4.0 * losses[k].measured / losses[k].predicted);
}

TEST(JointLoss, IsZeroForEqualLevels) {
  std::vector<std::vector<Model>> chunks = chunks_around(9);
  for (std::vector<Model>& levels : chunks) levels.assign(levels.size(), levels[0]);
  const auto errors = level_errors(test::gl_context(), chunks);
  const auto losses = joint_losses(test::gl_context(), chunks, errors, 2);
  ASSERT_FALSE(losses.empty());
  // The finest level is drawn by another program than the rest: a GPU may round otherwise.
  const double rounding = test::gl_context().software() ? 0.0 : 1e-12;
  for (const JointLoss& loss : losses) {
    EXPECT_LE(loss.predicted, rounding);
    EXPECT_EQ(loss.measured, 0.0);
  }
}

}  // namespace
}  // namespace binosplat::compact
