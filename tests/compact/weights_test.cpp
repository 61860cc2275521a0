#include "compact/weights.h"

#include <gtest/gtest.h>

#include "scene/axes.h"
#include "scene/harmonics.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::compact {
namespace {

std::vector<Camera> cameras_to_weigh() {
  std::vector<Camera> all(2, test::front_camera(64, 48, 60));
  all[1].position = {0.3, 0.0, -1.0};
  return all;
}

TEST(Weigh, AddUpOverViews) {
  const Model model = test::random_model(61, 500, 2);
  const Weights both = weigh(test::gl_context(), model, cameras_to_weigh(), near_default);
  const Weights one = weigh(test::gl_context(), model, {cameras_to_weigh()[0]}, near_default);
  const Weights other = weigh(test::gl_context(), model, {cameras_to_weigh()[1]}, near_default);
  Model turned = model;
  bring_into_axes(turned, "RUB");
  const Weights there = weigh(test::gl_context(), turned, cameras_to_weigh(), near_default);
  EXPECT_EQ(both.views, 2u);
  EXPECT_GT(both.unseen(), 0u);
  EXPECT_LT(both.unseen(), one.unseen());
  double sum = 0.0;
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_EQ(both.weight[i], one.weight[i] + other.weight[i]);
    EXPECT_NEAR(there.weight[i], both.weight[i], 1e-3 + 1e-3 * both.weight[i]);
    sum += both.weight[i];
  }
  EXPECT_LE(sum, 2.0 * 64 * 48);
  EXPECT_GT(sum, 64 * 48);
}

// One Gaussian straight ahead with known harmonics along z, seen first from one side, then also from behind.
TEST(Weigh, FitColoursWithLowerDegrees) {
  Model model;
  model.degree = 2;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.5f, glm::vec3(0.5f));
  model.sh[3 * 2] = 0.4f;                                          // the red coefficient of z
  for (std::size_t c = 0; c < 3; ++c) model.sh[3 * 6 + c] = 0.2f;  // the coefficients of 2 zz - xx - yy
  HarmonicsFit::Coefficients now{};
  now[2].r = 0.4;
  now[6] = glm::dvec3(0.2);
  std::vector<Camera> around(2, cameras_to_weigh()[0]);
  const Weights one = weigh(test::gl_context(), model, {around[0]}, near_default, true);
  const double w = one.weight[0], red = 0.4 * 0.4886025119, grey = 0.2 * 2 * 0.31539156525;
  EXPECT_GT(w, 1.0);
  // From one side the base colour can become the visible colour, apart from the regularisation.
  const glm::dvec3 base = test::sh_c0 * one.colours[0].fitted(0, now)[0];
  EXPECT_NEAR(base.r, red + grey, 0.01 * (red + grey));
  EXPECT_NEAR(base.g, grey, 0.01 * grey);
  EXPECT_LT(one.colours[0].change(0, now), 1e-3 * w * red * red);
  around[1].position = {0, 0, 6};
  around[1].rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1);
  const Weights both = weigh(test::gl_context(), model, around, near_default, true);
  EXPECT_NEAR(both.weight[0], 2 * w, 1e-3);
  EXPECT_NEAR(test::sh_c0 * both.colours[0].fitted(0, now)[0].r, grey, 0.01 * grey);
  EXPECT_NEAR(both.colours[0].change(0, now), 2 * w * red * red / 3, 0.01 * w * red * red);
  const auto linear = both.colours[0].fitted(1, now);
  EXPECT_NEAR(linear[2].r, 0.4, 0.01);
  EXPECT_EQ(linear[6], glm::dvec3(0.0));
  EXPECT_LT(both.colours[0].change(1, now), 1e-3 * w * red * red);
}

// Random colours in random directions: no other coefficients are closer, and unseen coefficients stay.
TEST(ColourFits, MinimizeError) {
  test::Uniform uniform(4);
  const auto number = [&] { return uniform(-1, 1); };
  const auto three = [&] { return glm::dvec3(number(), number(), number()); };
  struct Observation {
    std::array<double, 16> basis;
    glm::dvec3 colour;
    double weight;
  };
  std::vector<Observation> all;
  HarmonicsFit fit;
  for (int k = 0; k < 60; ++k) {
    const Observation& seen =
        all.emplace_back(Observation{sh_basis(glm::normalize(three())), 0.4 * three(), uniform(0, 9)});
    fit.add(seen.basis, seen.colour, seen.weight);
  }
  HarmonicsFit::Coefficients now{};
  for (glm::dvec3& c : now) c = 0.1 * three();
  for (const int degree : {0, 1, 2}) {
    const auto error = [&](const HarmonicsFit::Coefficients& x) {
      double sum = 0.0;
      for (const Observation& seen : all) {
        glm::dvec3 off = -seen.colour;
        for (std::size_t k = 0; k < x.size(); ++k) off += seen.basis[k] * x[k];
        sum += seen.weight * glm::dot(off, off) / 3.0;
      }
      return sum;
    };
    const auto best = fit.fitted(degree, now);
    EXPECT_NEAR(fit.change(degree, now), error(best), 1e-4 * error(best));
    // With the regularisation, no step of a single coefficient lowers the error.
    double held = 0.0;
    for (const Observation& seen : all) held += 0.01 * seen.weight * seen.basis[0] * seen.basis[0] / 3.0;
    const auto count = static_cast<std::size_t>(sh_count(degree));
    const auto held_error = [&](const HarmonicsFit::Coefficients& x) {
      double sum = error(x);
      for (std::size_t k = 0; k < count; ++k) sum += held * glm::dot(x[k] - now[k], x[k] - now[k]);
      return sum;
    };
    for (std::size_t k = 0; k < 3 * count; ++k) {
      for (const double step : {-1e-3, 1e-3}) {
        auto other = best;
        other[k / 3][static_cast<int>(k % 3)] += step;
        EXPECT_GT(held_error(other), held_error(best)) << degree << " " << k;
      }
    }
    const auto none = HarmonicsFit().fitted(degree, now);
    EXPECT_EQ(none[0], now[0]);
    EXPECT_EQ(none[8], degree == 2 ? now[8] : glm::dvec3(0.0));
  }
}

}  // namespace
}  // namespace binosplat::compact
