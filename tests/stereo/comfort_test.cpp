#include "stereo/comfort.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/rig.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

constexpr int comfort_width = 100, comfort_height = 60;
constexpr double comfort_focal = 120.0, comfort_ipd = 0.063;

/// Returns the left eye's picture of a wall at 2 m above one at 8 m, and one floater very near.
Picture walls() {
  Picture picture(comfort_width, comfort_height);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    picture.colour[k] = glm::vec4(0.5f, 0.5f, 0.5f, 0.0f);
    picture.z_sum[k] = k < picture.colour.size() / 2 ? 2.0f : 8.0f;
  }
  picture.z_sum[7] = 0.25f;
  picture.colour[8].a = 1.0f;  // no depth here
  return picture;
}

EyePair rig_for_comfort(std::optional<double> convergence, double cant = 0.0) {
  return make_rig(test::front_camera(comfort_width, comfort_height, comfort_focal),
                  {.convergence = convergence, .cant_degrees = cant});
}

TEST(Comfort, DisparityMatchesMethod) {
  for (const std::optional<double> convergence : {std::optional<double>(), std::optional<double>(3.0)}) {
    const auto range = disparity_range(rig_for_comfort(convergence).cameras, walls(), convergence);
    ASSERT_TRUE(range);
    const double inverse = convergence ? 1.0 / *convergence : 0.0;
    EXPECT_NEAR(range->near_px, comfort_focal * comfort_ipd * (1.0 / 2.0 - inverse), 1e-5);
    EXPECT_NEAR(range->far_px, comfort_focal * comfort_ipd * (1.0 / 8.0 - inverse), 1e-5);
    EXPECT_LT(range->vertical_px, 1e-9);
    // Straight ahead the angles are ipd (1/z - 1/D); to the sides the eyes turn a little less.
    EXPECT_NEAR(range->near_degrees, glm::degrees(comfort_ipd * (1.0 / 2.0 - inverse)), 0.02);
    EXPECT_NEAR(range->far_degrees, glm::degrees(comfort_ipd * (1.0 / 8.0 - inverse)), 0.1);
    EXPECT_GT(range->near_degrees, range->far_degrees);
  }
  // A headset's optics have a fixed focus, whatever the eyes' convergence is.
  const auto focused = disparity_range(rig_for_comfort(3.0).cameras, walls(), 2.5);
  EXPECT_NEAR(focused->near_px, comfort_focal * comfort_ipd * (1.0 / 2.0 - 1.0 / 2.5), 1e-5);
  EXPECT_TRUE(focused->near_degrees > 0.0 && focused->far_degrees < 0.0);
  // Swapped eyes change the sign.
  EyePair pair = rig_for_comfort({});
  std::swap(pair.cameras[0], pair.cameras[1]);
  EXPECT_LT(disparity_range(pair.cameras, walls(), {})->near_px, 0.0);
}

TEST(Comfort, CantedEyesHaveVerticalDisparity) {
  const auto range = disparity_range(rig_for_comfort({}, 10.0).cameras, walls(), 2.0);
  ASSERT_TRUE(range);
  EXPECT_GT(range->vertical_px, 1.0);
  // The focus is at the near wall, so the angle is about 0. It is not exactly 0, because the range omits a
  // hundredth of the pixels, those within some degrees of straight ahead.
  EXPECT_NEAR(range->near_degrees, 0.0, 0.05);
}

TEST(Comfort, ScreenPlaneHasZeroAngle) {
  Picture picture = walls();
  for (float& z : picture.z_sum) z = 3.0f;
  const auto range = disparity_range(rig_for_comfort(3.0).cameras, picture, 3.0);
  EXPECT_NEAR(range->near_degrees, 0.0, 1e-6);
  EXPECT_NEAR(range->far_degrees, 0.0, 1e-6);
  EXPECT_GT(disparity_range(rig_for_comfort(3.0).cameras, picture, 3.5)->far_degrees, 0.01)
      << "the focus is not looked at";
}

TEST(Comfort, ScreenIsAtZeroDisparity) {
  EXPECT_FALSE(screen_distance(rig_for_comfort({}).cameras));
  EXPECT_NEAR(*screen_distance(rig_for_comfort(3.0).cameras), 3.0, 1e-9);
  EXPECT_GT(std::abs(*screen_distance(rig_for_comfort(2.0).cameras) - 3.0), 0.5) << "any rig is at 3 m";
}

TEST(Comfort, EmptyPictureHasNoRange) {
  EXPECT_FALSE(disparity_range(rig_for_comfort({}).cameras, Picture(comfort_width, comfort_height), {}));
}

TEST(Comfort, ProposalIsComfortable) {
  const EyePair eyes = rig_for_comfort({});
  const auto range = disparity_range(eyes.cameras, walls(), {});
  EXPECT_FALSE(is_comfortable(*range)) << "2 m before eyes that look infinitely far is 1.8 degrees";
  const ComfortableRig better = comfortable_rig(*range, eyes.cameras);
  EXPECT_FALSE(better.ipd);
  EXPECT_NEAR(better.convergence, 3.2, 0.01) << "midway in 1/z between 2 and 8 m";
  EXPECT_TRUE(is_comfortable(
      *disparity_range(rig_for_comfort(better.convergence).cameras, walls(), better.convergence)));

  // In a deep scene the eyes must be closer to each other.
  Picture deep = walls();
  for (std::size_t k = 0; k < deep.z_sum.size() / 2; ++k) deep.z_sum[k] = 0.5f;
  const EyePair other = rig_for_comfort(3.0);
  const ComfortableRig narrow = comfortable_rig(*disparity_range(other.cameras, deep, 3.0), other.cameras);
  ASSERT_TRUE(narrow.ipd);
  const auto at = [&](double distance_between) {
    const EyePair pair = make_rig(test::front_camera(comfort_width, comfort_height, comfort_focal),
                                  {.ipd = distance_between, .convergence = narrow.convergence});
    return *disparity_range(pair.cameras, deep, narrow.convergence);
  };
  EXPECT_TRUE(is_comfortable(at(*narrow.ipd)));
  EXPECT_FALSE(is_comfortable(at(comfort_ipd))) << "any eyes would do";
}

TEST(Comfort, ScreenDistanceFitsScene) {
  // The walls at 2 m and 8 m fit into one degree on either side of the screen, but not if the screen is at
  // one of the walls.
  for (const std::optional<double> convergence : {std::optional<double>(), std::optional<double>(1.5)}) {
    const auto metres = suitable_convergence(rig_for_comfort(convergence).cameras, walls(), 1.0);
    ASSERT_TRUE(metres);
    EXPECT_TRUE(is_comfortable(*disparity_range(rig_for_comfort(metres).cameras, walls(), metres)))
        << *metres;
  }
  EXPECT_FALSE(is_comfortable(*disparity_range(rig_for_comfort(2.0).cameras, walls(), 2.0)));
  EXPECT_FALSE(is_comfortable(*disparity_range(rig_for_comfort(8.0).cameras, walls(), 8.0)));

  // In a scene that is too deep for any screen, the screen is at the most frequent depth, with three digits.
  Picture deep = walls();
  for (std::size_t k = 0; k < deep.z_sum.size(); ++k)
    deep.z_sum[k] = k % 10 == 0 ? 0.4f : k % 10 == 1 ? 500.0f : 2.71828f;
  EXPECT_NEAR(*suitable_convergence(rig_for_comfort({}).cameras, deep, 1.0), 2.72, 1e-9);
  EXPECT_NEAR(*suitable_convergence(rig_for_comfort({}).cameras, deep, 100.0), 0.0272, 1e-9)
      << "units are not metres";

  EXPECT_FALSE(suitable_convergence(rig_for_comfort({}).cameras, Picture(comfort_width, comfort_height), 1.0))
      << "nothing is seen";
}

}  // namespace
}  // namespace binosplat::stereo
