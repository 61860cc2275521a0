#include "lab/perspectives.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

// A wall of Gaussians side by side, which no order changes, with some before it.
Model wall_of_squares(bool with_more) {
  test::Uniform uniform(6);
  Model model;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 30; ++x)
      test::add(model, {0.2f * static_cast<float>(x - 15), 0.2f * static_cast<float>(y - 15), 4.0f},
                {0.15f, 0.15f, 0.001f}, 0.99f,
                glm::vec3(uniform(0.4, 0.6), uniform(0.4, 0.6), uniform(0.4, 0.6)));
  }
  for (int i = 0; i < (with_more ? 200 : 0); ++i)
    test::add(model, {uniform(-2, 2), uniform(-2, 2), uniform(3.5, 3.9)}, glm::vec3(0.2f, 0.2f, 0.05f), 0.6f,
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)),
              {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
  return model;
}

PerspectiveViews perspective_views() {
  PerspectiveViews views;
  Camera camera = test::front_camera(96, 64, 60);
  const stereo::EyePair rig = stereo::make_rig(camera, {.ipd = 0.2});
  views.eyes = {rig.views.begin(), rig.views.end()};
  for (int n = 0; n < 9; ++n) {
    views.path.push_back(make_view(camera));
    camera.position.x += 0.02;
  }
  return views;
}

TEST(Perspectives, AreMeasuredAgainstPhotosForTwoEyesAndInMotion) {
  const Model model = wall_of_squares(true);
  render::Frame frame(test::gl_context(), model);
  PerspectiveViews of = perspective_views();
  Image photo(96, 64, 3);
  frame.draw(std::span(&of.path[0], 1), {.order = ORDER_DISTANCE, .projection = PROJECTION_TANGENT});
  photo = composite(frame.read_pictures().front(), glm::vec3(0.0f));
  glm::mat4x3 exposure(0.8f);
  exposure[0][1] = 0.1f;
  of.photos.push_back({of.path[0], exposed(photo, exposure), exposure});
  std::size_t steps = 0;
  const auto numbers = measure_perspectives(frame, of, [&] { ++steps; });
  EXPECT_EQ(steps, perspective_steps(of));
  ASSERT_EQ(numbers.size(), 4u);
  for (const PerspectiveNumbers& one : numbers) {
    const bool is_last = one.seen == perspectives.back();
    EXPECT_EQ(std::isinf(*one.photos_db), is_last) << "the photo is of the last";
    EXPECT_EQ(one.eyes_db.has_value(), !is_last);
    if (!is_last) {
      EXPECT_LT(*one.eyes_db, 80.0);
    }
    ASSERT_EQ(one.popping.size(), 2u);
    EXPECT_EQ(one.popping[0].apart, 1);
    EXPECT_EQ(one.popping[1].apart, 7);
    EXPECT_LT(one.popping[0].mse, one.popping[1].mse);
    EXPECT_GT(one.popping[0].flip, 0.0);
    EXPECT_GT(one.popping[0].counted, 0.8);
  }
  const Table table = perspectives_table(numbers);
  ASSERT_EQ(table.rows.size(), 4u);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  EXPECT_EQ(to_json(std::span(numbers))[3]["popping"].size(), 2u);
}

// Sideways along a wall nothing pops: what is left is of the warp.
TEST(Perspectives, PoppingIsOfTheOrder) {
  const auto popping = [](const Model& model) {
    render::Frame frame(test::gl_context(), model);
    PerspectiveViews of = perspective_views();
    of.eyes.clear();
    return measure_perspectives(frame, of, [] {}).back().popping[0].mse;
  };
  EXPECT_LT(2.0 * popping(wall_of_squares(false)), popping(wall_of_squares(true)));
}

}  // namespace
}  // namespace binosplat::lab
