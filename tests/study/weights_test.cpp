#include "study/weights.h"

#include <gtest/gtest.h>

#include "scene/axes.h"
#include "study/calibrate.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::study {
namespace {

std::vector<Camera> cameras() {
  std::vector<Camera> all(2, test::front_camera(64, 48, 60));
  all[1].position = {0.3, 0.0, -1.0};
  return all;
}

TEST(StudyWeights, AddUpOverViewsWhateverTheAxes) {
  const Model model = test::random_model(61, 500, 2);
  const Weights both = weigh(test::gl_context(), model, cameras(), near_default);
  const Weights one = weigh(test::gl_context(), model, {cameras()[0]}, near_default);
  const Weights other = weigh(test::gl_context(), model, {cameras()[1]}, near_default);
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const Weights there = weigh(test::gl_context(), turned, cameras(), near_default);
  EXPECT_EQ(both.views, 2u);
  EXPECT_GT(both.unseen(), 0u);
  EXPECT_LT(both.unseen(), one.unseen());
  double sum = 0.0;
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_EQ(both.weight[i], one.weight[i] + other.weight[i]);
    EXPECT_NEAR(there.weight[i], both.weight[i], 1e-3 + 1e-3 * both.weight[i]);
    EXPECT_LE(both.change(i, 0), both.lowered[i][0].square);
    sum += both.weight[i];
  }
  EXPECT_LE(sum, 2.0 * 64 * 48);
  EXPECT_GT(sum, 64 * 48);
}

// One Gaussian straight ahead, whose harmonics along z are known; then from behind, too.
TEST(StudyWeights, ChangeIsWhatABaseColourCannotMakeUpFor) {
  Model model;
  model.degree = 2;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.5f, glm::vec3(0.5f));
  model.sh[3 * 2] = 0.4f;                                          // red of the degree that z has
  for (std::size_t c = 0; c < 3; ++c) model.sh[3 * 6 + c] = 0.2f;  // all of 2 zz - xx - yy
  std::vector<Camera> around(2, cameras()[0]);
  const Weights one = weigh(test::gl_context(), model, {around[0]}, near_default);
  const double w = one.weight[0], red = 0.4 * 0.4886025119, grey = 0.2 * 2 * 0.31539156525;
  EXPECT_GT(w, 1.0);
  EXPECT_NEAR(one.lowered[0][0].square, w * ((red + grey) * (red + grey) + 2 * grey * grey) / 3, 1e-5 * w);
  EXPECT_NEAR(one.lowered[0][1].square, w * grey * grey, 1e-5 * w);
  EXPECT_EQ(one.lowered[0][2].square, 0.0);
  EXPECT_NEAR(one.shift(0, 0).r, red + grey, 1e-6);
  EXPECT_NEAR(one.shift(0, 0).g, grey, 1e-6);
  EXPECT_NEAR(one.change(0, 0), 0.0, 1e-9) << "from one side the base colour can be what is seen";
  around[1].position = {0, 0, 6};
  around[1].rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1);
  const Weights both = weigh(test::gl_context(), model, around, near_default);
  EXPECT_NEAR(both.weight[0], 2 * w, 1e-3);
  EXPECT_NEAR(both.shift(0, 0).r, grey, 1e-4);
  EXPECT_NEAR(both.change(0, 0), 2 * w * red * red / 3, 1e-3 * w);
  EXPECT_NEAR(both.change(0, 1), 0.0, 1e-9);
}

// Cameras are of the world: a model in other axes is seen as it would be in the world's.
TEST(Calibrator, SeesModelsOfAllAxes) {
  const Model model = test::random_model(62, 500, 0);
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const std::vector<CalibrationView> views = {{cameras()[1], {}}};
  const auto pairs = [&](const Model& of) {
    Calibrator calibrator(test::gl_context(), of, views, near_default, CalibrationTarget::Kind::quality);
    EXPECT_EQ(calibrator.cost(of).mean_db, equal_db);
    EXPECT_LT(calibrator.cost(test::random_model(63, 500, 0)).mean_db, 40.0) << "any model is as good";
    return calibrator.cost(of).pairs;
  };
  EXPECT_GT(pairs(model), 100.0);
  EXPECT_NEAR(pairs(turned), pairs(model), 2.0);
}

}  // namespace
}  // namespace binosplat::study
