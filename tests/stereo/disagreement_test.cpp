// Binocular disagreement of pictures with known errors.

#include "stereo/disagreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/rig.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

constexpr int wall_width = 64, wall_height = 48;
constexpr double wall_focal = 60, wall_ipd = 0.06, depth = 1.2;  // a disparity of 3 px

EyePair rig_at_wall() {
  return make_rig(test::front_camera(wall_width, wall_height, wall_focal), {.ipd = wall_ipd});
}

// Returns a grey wall at one depth, as both eyes see it.
std::array<Picture, 2> wall(double z = depth) {
  std::array<Picture, 2> eyes = {Picture(wall_width, wall_height), Picture(wall_width, wall_height)};
  for (Picture& eye : eyes) {
    eye.colour.assign(eye.colour.size(), glm::vec4(0.5f, 0.5f, 0.5f, 0.0f));
    eye.z_sum.assign(eye.z_sum.size(), static_cast<float>(z));
  }
  return eyes;
}

void stain(Picture& eye, int x, int y, float by) {
  eye.colour[static_cast<std::size_t>(y) * wall_width + x] += glm::vec4(by, by, by, 0.0f);
}

TEST(Disagreement, SharedErrorIsNone) {
  const auto exact = wall();
  auto approximate = exact;
  stain(approximate[0], 30, 20, 0.2f);
  stain(approximate[1], 27, 20, 0.2f);  // the same point of the wall is 3 px further left
  const Disagreement same = disagreement(rig_at_wall().views, exact, approximate);
  EXPECT_GT(same.db, 120.0);  // rounding of the wall's depth to float
  EXPECT_NEAR(same.counted, (wall_width - 3.0) / wall_width,
              1e-9);  // three columns lie outside the right picture

  // Two pixels have one error each, one in the left eye and one in the right.
  auto apart = exact;
  stain(apart[0], 30, 20, 0.2f);
  stain(apart[1], 33, 20, 0.2f);  // in the wrong direction, as if the eyes were swapped
  const Disagreement rivalry = disagreement(rig_at_wall().views, exact, apart);
  const double counted = (wall_width - 3.0) * wall_height;
  EXPECT_NEAR(rivalry.db, -10 * std::log10(2 * 0.04 / counted), 0.01);
  EXPECT_NEAR(rivalry.picture.at(30, 20, 1), 0.2f, 1e-5f);
  EXPECT_NEAR(rivalry.picture.at(36, 20, 1), 0.2f, 1e-3f);
}

TEST(Disagreement, InterpolatesFractionalDisparity) {
  const auto exact = wall(depth * 3.0 / 2.5);  // 2.5 px
  auto approximate = exact;
  stain(approximate[0], 30, 20, 0.2f);
  stain(approximate[1], 27, 20, 0.2f);
  stain(approximate[1], 28, 20, 0.2f);
  const Disagreement d = disagreement(rig_at_wall().views, exact, approximate);
  EXPECT_NEAR(d.picture.at(30, 20, 0), 0.0f, 1e-4f);
  EXPECT_NEAR(d.picture.at(29, 20, 0), 0.1f, 1e-3f);  // half way to a stained pixel
}

TEST(Disagreement, CountsOnlyCommonPixels) {
  auto exact = wall();
  auto approximate = exact;
  stain(approximate[0], 30, 20, 0.2f);
  // The right eye sees something behind the wall.
  exact[1].z_sum[20 * wall_width + 27] = static_cast<float>(1.02 * depth);
  EXPECT_TRUE(std::isinf(disagreement(rig_at_wall().views, exact, approximate).db));
  exact[1].z_sum[20 * wall_width + 27] = static_cast<float>(1.005 * depth);
  EXPECT_FALSE(std::isinf(disagreement(rig_at_wall().views, exact, approximate).db));
  exact[0].colour[20 * wall_width + 30].a = 0.6f;  // too little coverage to have a depth
  EXPECT_TRUE(std::isinf(disagreement(rig_at_wall().views, exact, approximate).db));
}

TEST(Disagreement, FollowsCantedEyes) {
  const EyePair canted = make_rig(test::front_camera(wall_width, wall_height, wall_focal),
                                  {.ipd = wall_ipd, .cant_degrees = 10});
  // One point of the world, stained in each eye at its projection.
  const glm::dvec3 p(0.05, -0.02, 1.5);
  auto exact = wall();
  auto approximate = exact;
  std::array<glm::ivec2, 2> at;
  for (std::size_t k = 0; k < 2; ++k) {
    const shared::View& view = canted.views[k];
    const auto along = [&](const glm::vec4& row) { return glm::dot(glm::dvec3(row), p) + row.w; };
    const double z = along(view.row_z);
    at[k] = glm::ivec2(std::lround(view.lens.x * along(view.row_x) / z + view.lens.z - 0.5),
                       std::lround(view.lens.y * along(view.row_y) / z + view.lens.w - 0.5));
    exact[k].z_sum.assign(exact[k].z_sum.size(), static_cast<float>(z));
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) stain(approximate[k], at[k].x + dx, at[k].y + dy, 0.2f);
    }
  }
  approximate[0].z_sum = exact[0].z_sum;
  const Disagreement d = disagreement(canted.views, exact, approximate);
  EXPECT_NEAR(d.picture.at(at[0].x, at[0].y, 0), 0.0f, 1e-4f);
  std::array<shared::View, 2> swapped = {canted.views[1], canted.views[0]};  // an injected fault
  const Disagreement wrong = disagreement(swapped, exact, approximate);
  EXPECT_FALSE(wrong.picture.at(at[0].x, at[0].y, 0) == 0.0f && wrong.db == d.db);
}

TEST(Disparity, ErrorIsThatOfDrawnDepth) {
  const auto exact = wall();
  auto drawn = wall(depth * 3.0 / 2.5);            // a disparity of 2.5 px instead of 3
  drawn[0].colour[20 * wall_width + 30].a = 0.6f;  // too little coverage to have a depth
  const Image error = disagreement(rig_at_wall().views, exact, drawn).disparity;
  for (int y = 0; y < wall_height; ++y) {
    for (int x = 0; x < wall_width; ++x) {
      const bool counts = x >= 3 && !(x == 30 && y == 20);  // of the rest the right eye sees nothing
      EXPECT_NEAR(error.at(x, y, 0), counts ? 0.5 : -1.0, 1e-5) << x << " " << y;
    }
  }
  for (const float px : disagreement(rig_at_wall().views, exact, exact).disparity.data) EXPECT_LE(px, 0.0f);
}

// In canted eyes a point moves along a line that is not a row.
TEST(Disparity, ErrorFollowsCantedEyes) {
  const EyePair canted = make_rig(test::front_camera(wall_width, wall_height, wall_focal),
                                  {.ipd = wall_ipd, .cant_degrees = 10});
  const auto place_in = [&](std::size_t eye, const glm::dvec3& p) {
    const shared::View& view = canted.views[eye];
    const auto along = [&](const glm::vec4& row) { return glm::dot(glm::dvec3(row), p) + row.w; };
    const double z = along(view.row_z);
    return glm::dvec3(view.lens.x * along(view.row_x) / z + view.lens.z - 0.5,
                      view.lens.y * along(view.row_y) / z + view.lens.w - 0.5, z);
  };
  // Two points on the ray of one pixel of the left eye.
  const glm::dvec3 near_point(0.05, -0.02, 1.2);
  const glm::dvec3 eye = glm::dvec3(canted.cameras[0].position) - glm::dvec3(canted.views[0].anchor);
  const glm::dvec3 far_point = eye + 1.25 * (near_point - eye);
  const glm::dvec3 left = place_in(0, near_point), right = place_in(1, near_point),
                   drawn_at = place_in(1, far_point);
  auto exact = wall(), drawn = wall();
  exact[0].z_sum.assign(exact[0].z_sum.size(), static_cast<float>(left.z));
  exact[1].z_sum.assign(exact[1].z_sum.size(), static_cast<float>(right.z));
  drawn[0].z_sum.assign(drawn[0].z_sum.size(), static_cast<float>(1.25 * left.z));
  const Image error = disagreement(canted.views, exact, drawn).disparity;
  const double expected = glm::distance(glm::dvec2(right), glm::dvec2(drawn_at));
  EXPECT_GT(expected, 0.5);
  const float found =
      error.at(static_cast<int>(std::lround(left.x)), static_cast<int>(std::lround(left.y)), 0);
  EXPECT_NEAR(found, expected, 0.02) << "the nearest pixel's ray";
  const std::array<shared::View, 2> one_eye = {canted.views[0], canted.views[0]};  // an injected fault
  EXPECT_EQ(disagreement(one_eye, exact, drawn).disparity.at(30, 20, 0) > 0.4f, false);
}

TEST(Disagreement, RejectsMismatchedPictures) {
  const auto exact = wall();
  const std::array<Picture, 2> small = {Picture(4, 4), Picture(4, 4)};
  EXPECT_ERROR(disagreement(rig_at_wall().views, exact, small), "4 x 4", "64 x 48");
}

}  // namespace
}  // namespace binosplat::stereo
