#include "scene/reduce.h"

#include <gtest/gtest.h>

#include "support/models.h"

namespace binosplat {
namespace {

Model numbered(int degree, std::size_t count) {
  Model model;
  model.degree = degree;
  for (std::size_t i = 0; i < count; ++i) test::add(model, glm::vec3(static_cast<float>(i)), glm::vec3(1), 1);
  for (std::size_t k = 0; k < model.sh.size(); ++k) model.sh[k] = static_cast<float>(k + 1);
  return model;
}

TEST(Reduce, KeepsGaussiansInOrder) {
  Model model = numbered(1, 4);
  model.left_out = 7;
  const Model fewer = with_gaussians(model, {1, 0, 0, 1});
  ASSERT_EQ(fewer.count(), 2u);
  EXPECT_EQ(fewer.left_out, 7u);
  EXPECT_EQ(fewer.position[1], glm::vec3(3));
  EXPECT_EQ(fewer.sh[12], model.sh[3 * 12]);
}

TEST(Reduce, ReordersGaussians) {
  Model model = numbered(1, 4);
  model.antialiased = true;
  const std::vector<std::uint32_t> order = {3, 0, 3};
  const Model ordered = with_order(model, order);
  ASSERT_EQ(ordered.count(), 3u);
  EXPECT_TRUE(ordered.antialiased);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(ordered.position[k], model.position[order[k]]);
    for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(ordered.sh[12 * k + v], model.sh[12 * order[k] + v]);
  }
  ASSERT_EQ(ordered.sh.size(), 3u * 12);
}

TEST(Reduce, GaussiansHaveOwnDegrees) {
  const Model model = numbered(3, 3);
  const Model lower = with_degrees(model, {0, 2, 1});
  ASSERT_EQ(lower.degree, 2);  // the highest in use
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t kept = i == 0 ? 3 : i == 1 ? 27 : 12;
    for (std::size_t k = 0; k < 27; ++k)
      EXPECT_EQ(lower.sh[27 * i + k], k < kept ? model.sh[48 * i + k] : 0.0f) << i << ' ' << k;
  }
  EXPECT_EQ(with_degrees(model, {0, 3, 1}).degree, 3);
  Model empty = model;  // has a degree that no Gaussian uses
  for (std::size_t k = 0; k < empty.sh.size(); ++k) empty.sh[k] = k % 48 < 12 ? 1.0f : 0.0f;
  EXPECT_EQ(with_degrees(empty, {3, 3, 3}).degree, 1);
}

}  // namespace
}  // namespace binosplat
