#include "compact/refit.h"

#include <gtest/gtest.h>

#include "measure/metrics.h"
#include "render/faulty_shaders.h"
#include "render/frame.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::compact {
namespace {

std::vector<Camera> cameras_to_fit() {
  std::vector<Camera> all(5, test::front_camera(64, 48, 60));
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k].position = {0.4 * static_cast<double>(k) - 0.8, 0.1 * static_cast<double>(k % 2), -0.5};
  return all;
}

/// Returns a model in which no colour is clamped at 0, from any direction.
Model truth() {
  Model model = test::random_model(31, 300, 1);
  for (std::size_t k = 0; k < model.sh.size(); ++k) model.sh[k] *= k % 12 < 3 ? 0.5f : 0.1f;
  return model;
}

Model changed(Model model) {
  test::Uniform uniform(3);
  for (float& c : model.sh) c += static_cast<float>(uniform(-0.1, 0.1));
  return model;
}

Image drawn(const Model& model, const Camera& camera) {
  render::Frame frame(test::gl_context(), model);
  const shared::View view = make_view(camera);
  frame.draw(std::span(&view, 1));
  return composite(frame.read_pictures().front(), glm::vec3(0.0f));
}

/// Returns a loss: the negated PSNR to `right`, in a view that is not fitted.
ValidationLoss validation_loss_of(const Model& right) {
  Camera between = cameras_to_fit()[2];
  between.position.x = 0.2;
  return [between, wanted = drawn(right, between)](const Model& model) {
    return -measure::psnr(drawn(model, between), wanted);
  };
}

Refitted fitted(const Model& start, const Model& right, RefitSettings settings) {
  const RefitTargets targets{right, cameras_to_fit(), {}, near_default};
  return refit(test::gl_context(), start, targets, settings, validation_loss_of(right));
}

TEST(Refit, ReducesLoss) {
  const Model right = truth(), start = changed(right);
  const RefitSettings settings{.rounds = 40, .rounds_linear = 40, .damping = 0.0},
      few{.rounds = 8, .rounds_linear = 8, .damping = 0.0};
  const Refitted found = fitted(start, right, settings);
  const double best = found.losses[static_cast<std::size_t>(found.best_round)];
  EXPECT_LT(best, found.losses[0] - 25.0);
  EXPECT_EQ(best, *std::min_element(found.losses.begin(), found.losses.end()));
  Model after = start;
  after.sh = found.sh;
  EXPECT_EQ(validation_loss_of(right)(after), best);
  const Refitted once = fitted(start, right, few);
  EXPECT_EQ(once.sh, fitted(start, right, few).sh) << "not the same bits twice";
  EXPECT_LT(once.losses[static_cast<std::size_t>(once.best_round)], once.losses[0] - 10.0);

  const test::FaultyShaders faulty("measure/sums.glsl", "sum < 0 ? 0xffffffffu", "false ? 0xffffffffu");
  const Refitted wrong = fitted(start, right, few);
  EXPECT_GT(wrong.losses[static_cast<std::size_t>(wrong.best_round)], found.losses[0] - 5.0);
}

// Pictures in one order and projection are fitted for another. Some colours are clamped at 0.
TEST(Refit, FitsOtherOrderAndProjection) {
  const Model right = test::random_model(32, 300, 0);
  Model start = right;
  start.perspective = {Order::distance, Projection::tangent};
  const Refitted found = fitted(start, right, {});
  EXPECT_LT(found.losses[static_cast<std::size_t>(found.best_round)], found.losses[0] - 1.5);
}

// From one side a colour is clamped at 0 before and after. That view must have no influence. Otherwise the
// first step, which is all that the other view needs, would be too short.
TEST(Refit, IgnoresClampedColours) {
  const auto of = [](float along_z) {
    Model model;
    model.degree = 1;
    test::add(model, {0, 0, 3}, glm::vec3(0.3f), 0.5f, glm::vec3(0.5f));
    for (std::size_t c = 0; c < 3; ++c) {
      model.sh[3 * 2 + c] = along_z;
      model.sh[3 * 3 + c] = 1.5f;  // of the coefficient for x: adds -0.23 along x
    }
    return model;
  };
  const Model start = of(-1.2f), right = of(-1.6f);
  std::vector<Camera> around(2, test::front_camera(64, 48, 60));
  around[0].position = {-3, 0, 3};
  around[0].rotation = glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
  around[1].position = {0, 0, 6};
  around[1].rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1);
  const auto error = [&](const Model& model) {
    return -measure::psnr(drawn(model, around[1]), drawn(right, around[1]));
  };
  const RefitTargets targets{right, around, {}, near_default};
  const Refitted found = refit(test::gl_context(), start, targets, {.rounds = 1, .damping = 0.0}, error);
  EXPECT_GT(found.losses[0], -45.0);
  EXPECT_LT(found.losses[1], -90.0);
}

TEST(Refit, PrefersPhotosAndKeepsUnseen) {
  const Model right = truth();
  Model start = changed(right);
  test::add(start, {0, 0, -4}, glm::vec3(0.1f), 0.9f);  // behind all cameras
  for (std::size_t k = 12; k < 24; ++k) start.sh[k] = k < 15 ? 0.3f : 0.0f;
  std::size_t asked = 0;
  const PhotoOf photo = [&](const Camera& camera) {
    ++asked;
    return std::optional(drawn(right, camera));
  };
  const Model black = [&] {
    Model none = start;
    for (float& opacity : none.opacity) opacity = 0.0f;
    return none;
  }();
  const RefitTargets targets{black, cameras_to_fit(), photo, near_default};
  const Refitted found = refit(test::gl_context(), start, targets, {.rounds = 7, .keep_zeros = true}, {});
  EXPECT_EQ(asked, 2 * cameras_to_fit().size()) << "linearised twice";
  EXPECT_EQ(found.best_round, 7);
  EXPECT_TRUE(found.losses.empty());
  Model after = start;
  after.sh = found.sh;
  EXPECT_LT(validation_loss_of(right)(after), validation_loss_of(right)(start) - 6.0)
      << "the original is no target";
  const std::size_t unseen = start.sh.size() - 12;
  EXPECT_TRUE(std::equal(start.sh.begin() + static_cast<std::ptrdiff_t>(unseen), start.sh.end(),
                         found.sh.begin() + static_cast<std::ptrdiff_t>(unseen)));
  EXPECT_NE(start.sh[12], found.sh[12]);
  for (std::size_t k = 15; k < 24; ++k) EXPECT_EQ(found.sh[k], 0.0f);
}

TEST(Refit, KeepsBestRoundAndStopsEarly) {
  const Model right = truth(), start = changed(right);
  const RefitTargets targets{right, cameras_to_fit(), {}, near_default};
  const auto best_of = [&](std::vector<double> told) {
    std::size_t asked = 0;
    return refit(test::gl_context(), start, targets, {.rounds = 9},
                 [&](const Model&) { return told.at(asked++); });
  };
  const Refitted third = best_of({5, 6, 6, 4, 4, 6, 6});
  EXPECT_EQ(third.best_round, 3);
  EXPECT_EQ(third.losses.size(), 7u);
  const Refitted none = best_of({5, 6, 6, 6});
  EXPECT_EQ(none.best_round, 0);
  EXPECT_EQ(none.sh, start.sh);
}

TEST(Refit, CorrectModelStays) {
  const Model right = truth();
  const Refitted found = fitted(right, right, {.rounds = 5});
  EXPECT_EQ(found.best_round, 0);
  EXPECT_EQ(found.sh, right.sh);
}

}  // namespace
}  // namespace binosplat::compact
