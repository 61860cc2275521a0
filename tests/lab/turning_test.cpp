// What turning a head changes, measured.

#include "lab/turning.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

// A wall of coarse Gaussians around the origin, each of its own colour, two deep.
Model shell() {
  test::Uniform uniform(5);
  Model model;
  model.name = "shell";
  for (int i = 0; i < 1500; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 6.2831853), across = std::sqrt(1 - z * z);
    const glm::vec3 direction(across * std::cos(angle), across * std::sin(angle), z);
    test::add(model, direction * static_cast<float>(uniform(2.0, 2.5)), glm::vec3(0.15f, 0.05f, 0.1f), 0.7f,
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)),
              {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
  }
  return model;
}

TEST(Turning, TellsWhatItChanges) {
  const Model model = shell();
  render::Frame frame(test::gl_context(), model);
  const Camera camera = test::front_camera(400, 400, 170);  // 99 degrees
  TurningStudy study{.scene = "shell", .settings = {.columns = 8, .rows = 6, .degrees = {15.0, 150.0}}};
  std::size_t steps = 0;
  measure_turning(study, frame, camera, near_default, [&] { ++steps; });
  EXPECT_EQ(steps, turning_steps(study.settings));
  ASSERT_EQ(study.turns.size(), 4u * 3 * 2);
  for (const Turned& turn : study.turns) {
    const bool rolls = turn.about == "ahead";
    EXPECT_EQ(turn.rays, turn.degrees == 15.0 || rolls ? 48u : 0u);
    if (turn.rays == 0) continue;
    const bool is_steady = turn.seen == Perspective{ORDER_DISTANCE, PROJECTION_TANGENT};
    if (is_steady || rolls) {
      EXPECT_GE(turn.psnr_db, 100.0) << turn.about;
      EXPECT_EQ(turn.share_beyond, 0.0);
      EXPECT_LE(turn.flip, 1e-3);
    } else {
      EXPECT_LT(turn.psnr_db, 60.0) << turn.about;
      EXPECT_GT(turn.flip, 1e-3);
    }
  }
  EXPECT_GT(study.turns.front().share_beyond, 0.1);
  const Table table = turning_table(study);
  EXPECT_EQ(table.rows.size(), 12u);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  EXPECT_EQ(to_json(study).at("turns").size(), 24u);
  const Page page = turning_page(study);
  EXPECT_NE(html(page, to_json(study)).find("Turn the head"), std::string::npos);
  // The rays, and what a turn changes of them: black by distance and tangent.
  const std::vector<Figure>& figures = page.sections.front().figures;
  ASSERT_EQ(figures.size(), 5u);
  const auto brightest = [](const Figure& figure) {
    return *std::max_element(figure.image.data.begin(), figure.image.data.end());
  };
  EXPECT_EQ(figures[0].image.data.size(), 8u * 6 * 3);
  EXPECT_GT(brightest(figures[0]), 0.5f);
  EXPECT_GT(brightest(figures[1]), 0.2f);
  EXPECT_LT(brightest(figures[4]), 0.01f);
}

}  // namespace
}  // namespace binosplat::lab
