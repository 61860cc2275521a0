// The measured changes when a head turns.

#include <gtest/gtest.h>

#include "lab/bench.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

// Returns a wall of coarse Gaussians around the origin, two layers deep, each with a different colour.
Model shell() {
  test::Uniform uniform(5);
  Model model;
  for (int i = 0; i < 1500; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 6.2831853), across = std::sqrt(1 - z * z);
    const glm::vec3 direction(across * std::cos(angle), across * std::sin(angle), z);
    test::add(model, direction * static_cast<float>(uniform(2.0, 2.5)), glm::vec3(0.15f, 0.05f, 0.1f), 0.7f,
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)),
              {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
  }
  return model;
}

TEST(BenchTurns, ReportChangesByTurn) {
  const Model model = shell();
  const Camera camera = test::front_camera(200, 200, 85);  // 99 degrees
  Bench bench(test::gl_context(), [&]() -> const Model& { return model; }, {.turned = camera}, {});
  const double rays = test::gl_context().software() ? 16 * 12 : 48 * 36;
  for (const bool steady : {false, true}) {
    BenchSettings settings;
    settings.order = steady ? Order::distance : Order::depth;
    settings.projection = steady ? Projection::tangent : Projection::affine;
    const Point point = bench.measure(settings);
    ASSERT_EQ(point.details.size(), 3u * 5);
    for (const Row& turn : point.details) {
      const bool rolls = text(turn, "axis") == "ahead";
      const double degrees = number(turn, "degrees");
      EXPECT_EQ(number(turn, "rays") == rays, degrees <= 15.0 || rolls) << turn;
      if (steady || rolls) {
        EXPECT_EQ(number(turn, "psnr_db"), equal_db) << turn;
        EXPECT_EQ(number(turn, "rays_off"), 0.0);
        EXPECT_LE(number(turn, "flip"), 1e-3);
      } else if (degrees >= 5.0) {
        EXPECT_LT(number(turn, "psnr_db"), 60.0) << turn;
        EXPECT_GT(number(turn, "flip"), 1e-3);
      }
    }
    EXPECT_EQ(number(point.row, "psnr_db") == equal_db, steady) << "the mean of 15 degrees";
    ASSERT_TRUE(point.picture);
    const float brightest = *std::ranges::max_element(point.picture->data);
    EXPECT_EQ(brightest < 0.01f, steady) << "what a turn changes: black by distance and tangent";
  }
}

}  // namespace
}  // namespace binosplat::lab
