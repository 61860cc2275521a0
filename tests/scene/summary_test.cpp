#include "scene/summary.h"

#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

/// Returns 100 Gaussians of opacity 0.55 and scale 0.02 in a box of 1 x 1 x 1.
Model plain_model(int degree = 0) {
  test::Uniform uniform(4);
  Model model;
  model.degree = degree;
  for (int i = 0; i < 100; ++i)
    test::add(model, {uniform(0, 1), uniform(0, 1), uniform(0, 1)}, glm::vec3(0.02f), 0.55f);
  return model;
}

TEST(Summary, PlainModelHasNoAnomalies) {
  const ModelSummary s = summarise(plain_model());
  EXPECT_EQ(s.opacity[5], 100u);
  EXPECT_EQ(s.scale, (std::map<int, std::size_t>{{-2, 100}}));
  EXPECT_NEAR(s.opacity_median, 0.55, 1e-6);
  EXPECT_NEAR(s.scale_median, 0.02, 1e-8);
  EXPECT_EQ(s.invisible + s.without_size + s.flat + s.needles + s.far + s.huge, 0u);
  EXPECT_EQ(s.degree[0], 100u);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LE(s.all.low[c], s.core.low[c]);
    EXPECT_GE(s.all.high[c], s.core.high[c]);
  }
}

TEST(Summary, CountsAnomalies) {
  Model model = plain_model(2);
  const auto fact = [&](std::size_t ModelSummary::*odd) { return summarise(model).*odd; };
  model.opacity[0] = 0.0039f;
  model.opacity[1] = 1.0f;
  EXPECT_EQ(fact(&ModelSummary::invisible), 1u);
  EXPECT_EQ(summarise(model).opacity[0], 1u);
  EXPECT_EQ(summarise(model).opacity[9], 1u);
  model.scale[0] = {0.01f, 0.00009f, 0.01f};
  EXPECT_EQ(fact(&ModelSummary::flat), 1u);
  model.scale[1] = {0.0001f, 0.011f, 0.0001f};
  EXPECT_EQ(fact(&ModelSummary::needles), 1u);
  EXPECT_EQ(fact(&ModelSummary::flat), 1u);
  model.scale[2] = {0, 0, 0};
  EXPECT_EQ(fact(&ModelSummary::without_size), 1u);
  model.scale[3] = {3, 3, 3};
  EXPECT_EQ(fact(&ModelSummary::huge), 1u);
  EXPECT_EQ(summarise(model).scale.at(0), 1u);
  model.position[4] = {0.5f, 20, 0.5f};
  EXPECT_EQ(fact(&ModelSummary::far), 1u);
  EXPECT_EQ(summarise(model).all.high.y, 20.0f);
  EXPECT_LT(summarise(model).core.high.y, 1.01f);
  model.sh[27 * 5 + 3] = 0.1f;   // one coefficient of degree 1
  model.sh[27 * 6 + 26] = 0.1f;  // the last one of degree 2
  EXPECT_EQ(summarise(model).degree, (std::array<std::size_t, 4>{98, 1, 1, 0}));
}

TEST(Summary, RejectsEmptyModel) { EXPECT_ERROR(summarise(Model{}), "no Gaussians"); }

}  // namespace
}  // namespace binosplat
