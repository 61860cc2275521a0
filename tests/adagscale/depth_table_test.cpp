// AdaGScale's table of transmittance by depth, in a scene with known transmittances.

#include "adagscale/depth_table.h"

#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::adagscale {
namespace {

// Returns curtains over the whole picture at depths 1.5, 3.5 and 8.5, which transmit 0.5, 0.2 and 0.1 of the
// light everywhere.
Model curtains() {
  Model model;
  for (const auto& [z, opacity] : {std::pair{1.5f, 0.5f}, {3.5f, 0.8f}, {8.5f, 0.9f}})
    test::add(model, {0, 0, z}, glm::vec3(1000.0f, 1000.0f, 0.001f), opacity);
  return model;
}

std::vector<shared::View> views() { return {make_view(test::front_camera(48, 32, 48))}; }

TEST(DepthTable, MeasuresTransmittanceByDepth) {
  const Model model = curtains();
  render::Frame frame(test::gl_context(), model);
  const auto table = measure_depth_table(frame, views(), {.bins = 10, .far = 10.0f});
  ASSERT_EQ(table.bounds.size(), 10u);
  EXPECT_EQ(table.far, 10.0f);
  const float expected[] = {0, 1, 0, 0.5f, 0, 0, 0, 0, 0.1f, 0};
  for (std::size_t bin = 0; bin < 10; ++bin) EXPECT_NEAR(table.bounds[bin], expected[bin], 1e-3) << bin;

  // Another view, which does not see the first curtain, raises the bounds.
  auto two = views();
  two.push_back(two[0]);
  two[1].anchor.w = 2.0f;  // near plane
  const auto larger = measure_depth_table(frame, two, {.bins = 10, .far = 10.0f});
  EXPECT_NEAR(larger.bounds[3], 1.0f, 1e-3);
  EXPECT_NEAR(larger.bounds[8], 0.2f, 1e-3);
}

TEST(DepthTable, FitsSceneByDefault) {
  const Model model = test::random_model(61, 2000, 0);
  render::Frame frame(test::gl_context(), model);
  const auto table = measure_depth_table(frame, views());
  EXPECT_EQ(table.bounds.size(), 20u);
  EXPECT_GT(table.far, 4.0f);  // depths go from 0.2 to 6
  EXPECT_LT(table.far, 6.0f);
  EXPECT_FLOAT_EQ(*std::max_element(table.bounds.begin(), table.bounds.end()), 1.0f);
}

TEST(DepthTable, EmptyViewGivesEmptyTable) {
  const Model model = curtains();
  render::Frame frame(test::gl_context(), model);
  auto away = views();
  away[0].anchor.w = 100.0f;
  const auto table = measure_depth_table(frame, away);
  EXPECT_EQ(table.bounds, std::vector<float>(20, 0.0f));
  EXPECT_GT(table.far, 0.0f);
}

TEST(DepthTable, RejectsInvalidBins) {
  const Model model = curtains();
  render::Frame frame(test::gl_context(), model);
  EXPECT_ERROR(measure_depth_table(frame, views(), {.bins = 0}), "0 bins");
  EXPECT_ERROR(measure_depth_table(frame, views(), {.far = -1.0f}), "-1");
}

}  // namespace
}  // namespace binosplat::adagscale
