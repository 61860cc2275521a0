// Views that see none of a model.

#include "lab/empty_views.h"

#include <gtest/gtest.h>

#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

TEST(Seeing, CamerasFacingAwaySeeNothing) {
  Model model;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.5f);
  std::vector<Camera> cameras(4, test::front_camera(64, 48, 60));
  cameras[1].rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1);
  cameras[2].position = {50, 0, 0};
  const auto sees = [&](double near_plane) {
    return which_see_model(test::gl_context(), model, cameras, near_plane);
  };
  EXPECT_EQ(sees(near_default), (std::vector<bool>{true, false, false, true}));
  EXPECT_EQ(sees(5.0), std::vector<bool>(4, false));
  Model faint = model;
  faint.opacity[0] = 0.003f;  // below 1/255
  EXPECT_EQ(which_see_model(test::gl_context(), faint, cameras, near_default), std::vector<bool>(4, false));
}

// The means are outside the picture or before the near plane. Some Gaussians extend into the picture, some do
// not.
TEST(Seeing, PartlyVisibleGaussiansAreSeen) {
  Model model;
  test::add(model, {3, 0, 3}, glm::vec3(1.0f), 0.9f);
  const std::vector<Camera> cameras = {test::front_camera(64, 48, 60)};
  EXPECT_TRUE(which_see_model(test::gl_context(), model, cameras, near_default)[0]);
  model.scale[0] = glm::vec3(0.01f);
  EXPECT_FALSE(which_see_model(test::gl_context(), model, cameras, near_default)[0]);
  model.position[0] = {0, 0, 0.1};
  EXPECT_FALSE(which_see_model(test::gl_context(), model, cameras, near_default)[0]);
}

// A speck that is invisible in a small picture is found in the large one.
TEST(Seeing, SpecksNeedFullSize) {
  Model model;
  model.antialiased = true;  // so that smaller pictures show fainter Gaussians
  test::add(model, {0, 0, 3}, glm::vec3(0.0002f), 0.9f);
  const Camera large = test::front_camera(1600, 1200, 1500), small = test::front_camera(160, 120, 150);
  EXPECT_EQ(which_see_model(test::gl_context(), model, std::vector{small, large}, near_default),
            (std::vector<bool>{false, true}));
}

}  // namespace
}  // namespace binosplat::lab
