#include "lab/levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "lab/levels_page.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

constexpr double none = INFINITY;  // of an error

/// A wall before both eyes, brighter by `by` than the finest one.
Model wall_by(float by) {
  Model model;
  for (int x = -8; x <= 8; ++x) {
    for (int y = -5; y <= 5; ++y)
      test::add(model, {0.5f * x, 0.5f * y, 4.0f + 0.1f * static_cast<float>(x % 3)}, glm::vec3(0.3f), 0.8f,
                glm::vec3((x + y) % 2 == 0 ? 0.6f : 0.3f) + by);
  }
  return model;
}

struct LevelsStudyTest : testing::Test {
  gl::Context& context = test::gl_context();
  LevelsScene scene{.name = "wall", .finest = 187};
  std::vector<LevelsShot> shots;
  std::size_t steps = 0, loaded = 0;

  LevelsStudyTest() {
    for (const char* name : {"near", "far"}) {
      LevelsShot& shot = shots.emplace_back(LevelsShot{name, {}});
      for (const double x : {-0.03, 0.03}) {
        Camera eye = test::front_camera(48, 32, 30.0);
        eye.position = {x, 0.0, shots.size() == 1 ? 0.0 : -2.0};
        shot.views.push_back(make_view(eye));
      }
    }
  }

  /// Details of 30 and 40 dB that bring walls as bright as these.
  void measure(float at_30, float at_40, const std::function<Model()>& finest) {
    const Model models[] = {wall_by(at_30), wall_by(at_40)};
    std::vector<FollowingModel> following;
    for (std::size_t k = 0; k < 2; ++k) {
      following.push_back({30.0 + 10.0 * static_cast<double>(k),
                           std::make_shared<render::GpuModel>(context, models[k]),
                           [k](std::span<const shared::View>) {
                             return LevelsBrought{100 + k, 33.0};
                           }});
    }
    measure_levels(
        scene, shots, following,
        [&] {
          ++loaded;
          return finest();
        },
        1, [&] { ++steps; });
  }
};

TEST_F(LevelsStudyTest, TellsWhatEachDetailLoses) {
  measure(0.05f, 0.0f, [] { return wall_by(0.0f); });
  EXPECT_EQ(steps, 2u);
  EXPECT_EQ(loaded, 1u);
  EXPECT_EQ(scene.shots, (std::vector<std::string>{"near", "far"}));
  EXPECT_EQ(scene.problem, "");
  ASSERT_EQ(scene.rows.size(), 3u);
  for (const LevelsRow& row : scene.rows) {
    ASSERT_EQ(row.shots.size(), 2u);
    for (const LevelsNumbers& shot : row.shots) EXPECT_GT(shot.frame_ms, 0.0);
  }
  // Planted: 0.05 times what is seen of the wall.
  for (const LevelsNumbers& shot : scene.rows[0].shots) {
    EXPECT_GT(*shot.psnr_db, 26.0);
    EXPECT_LT(*shot.psnr_db, 32.0);
    EXPECT_GT(*shot.flip, 0.01);
    EXPECT_GT(*shot.disagreement_db, *shot.psnr_db + 10.0) << "both eyes see the same error";
    EXPECT_EQ(shot.gaussians, 100.0);
    EXPECT_EQ(shot.predicted_db, 33.0);
  }
  for (const LevelsNumbers& shot : scene.rows[1].shots) {
    EXPECT_EQ(shot.psnr_db, none);
    EXPECT_EQ(shot.flip, 0.0);
    EXPECT_EQ(shot.disagreement_db, none);
  }
  EXPECT_FALSE(scene.rows[2].detail);
  EXPECT_EQ(scene.rows[2].shots[0].gaussians, 187.0);
  EXPECT_FALSE(scene.rows[2].shots[0].psnr_db);
}

TEST_F(LevelsStudyTest, OfOneEyeHasNoDisagreement) {
  for (LevelsShot& shot : shots) shot.views.resize(1);
  measure(0.05f, 0.0f, [] { return wall_by(0.0f); });
  EXPECT_FALSE(scene.rows[0].shots[0].disagreement_db);
  EXPECT_TRUE(scene.rows[0].shots[0].psnr_db);
  EXPECT_EQ(scene.eyes, 1u);
}

TEST_F(LevelsStudyTest, GoesOnWhereTheFinestHaveNoRoom) {
  measure(0.05f, 0.0f,
          []() -> Model { throw Error(ExitCode::out_of_memory, "no room for so many Gaussians"); });
  EXPECT_EQ(scene.problem, "no room for so many Gaussians");
  EXPECT_EQ(loaded, 1u) << "and is not asked for again";
  ASSERT_EQ(scene.rows.size(), 2u);
  for (const LevelsNumbers& shot : scene.rows[0].shots) {
    EXPECT_FALSE(shot.psnr_db || shot.flip || shot.disagreement_db);
    EXPECT_EQ(shot.predicted_db, 33.0);
    EXPECT_GT(shot.frame_ms, 0.0);
  }
  const LevelsStudy study{.device = "some", .frames = 1, .scenes = {scene}};
  const Page page = levels_page(study);
  EXPECT_NE(page.sections[0].sentence.find("in all views: no room for so many Gaussians."), std::string::npos)
      << page.sections[0].sentence;
  EXPECT_EQ(page.sections[1].problem, "This was not measured.");
  EXPECT_NE(html(page, to_json(study)).find("no room for so many"), std::string::npos);
}

TEST_F(LevelsStudyTest, EndsAtAnyOtherError) {
  EXPECT_THROW(measure(0.05f, 0.0f, []() -> Model { fail("a broken file"); }), Error);
}

TEST(LevelsMeans, AreThoseOfSquaredErrors) {
  LevelsRow row{40.0,
                {{.gaussians = 100, .psnr_db = 30.0, .flip = 0.1, .frame_ms = 1.0},
                 {.gaussians = 300, .psnr_db = 40.0, .flip = 0.3, .frame_ms = 3.0}}};
  const LevelsNumbers mean = mean_of(row);
  EXPECT_EQ(mean.gaussians, 200.0);
  EXPECT_NEAR(*mean.psnr_db, 32.596, 1e-3) << "35 would be the mean of dB";
  EXPECT_NEAR(*mean.flip, 0.2, 1e-9);
  EXPECT_EQ(mean.frame_ms, 2.0);
  EXPECT_FALSE(mean.predicted_db);
  EXPECT_EQ(worst_db(row), 30.0);
  row.shots[0].psnr_db = none;  // equal pictures
  EXPECT_NEAR(*mean_of(row).psnr_db, 43.01, 0.01);
}

LevelsScene some_scene(const std::string& name, std::size_t finest, double ms_at_40, bool has_finest) {
  LevelsScene scene{.name = name, .finest = finest, .shots = {"front"}, .eyes = 2, .width = 8, .height = 6};
  scene.rows.push_back({30.0, {{.gaussians = 100, .predicted_db = 30.5, .psnr_db = 31.0, .frame_ms = 1.0}}});
  scene.rows.push_back(
      {40.0, {{.gaussians = 200, .predicted_db = 40.5, .psnr_db = 41.0, .frame_ms = ms_at_40}}});
  if (has_finest) scene.rows.push_back({{}, {{.gaussians = double(finest), .frame_ms = 4.0}}});
  return scene;
}

TEST(LevelsPage, SetsTimesBesideThoseOfTheSmallestScene) {
  const LevelsStudy study{
      .device = "some",
      .frames = 5,
      .scenes = {some_scene("large", 4000, 3.0, false), some_scene("small", 400, 2.0, true)}};
  const Table growth = growth_table(study);
  EXPECT_EQ(growth.columns,
            (std::vector<std::string>{"scene", "thousand Gaussians", "times", "30 dB: ms", "30 dB: times",
                                      "40 dB: ms", "40 dB: times", "finest: ms", "finest: times"}));
  ASSERT_EQ(growth.rows.size(), 2u);
  EXPECT_EQ(growth.rows[0], row("small", 0.4, 1.0, 1.0, 1.0, 2.0, 1.0, 4.0, 1.0));
  EXPECT_EQ(growth.rows[1], row("large", 4.0, 10.0, 1.0, 1.0, 3.0, 1.5, nullptr, nullptr));
  const Page page = levels_page(study);
  const Section& section = page.sections[4];
  EXPECT_EQ(section.id, "growth");
  EXPECT_NE(section.sentence.find("10 times the Gaussians."), std::string::npos) << section.sentence;
  EXPECT_EQ(section.table, growth);
  EXPECT_EQ(section.chart->y, (std::vector<std::string>{"30 dB: ms", "40 dB: ms", "finest: ms"}));
}

TEST(LevelsPage, DrawsEachDetailOnce) {
  const LevelsStudy study{.device = "some", .frames = 5, .scenes = {some_scene("garden", 400, 2.0, true)}};
  EXPECT_TRUE(growth_table(study).rows.empty());
  const Page page = levels_page(study);
  ASSERT_EQ(page.sections.size(), 5u) << "without growth";
  const Table table = levels_table(study);
  ASSERT_EQ(table.rows.size(), 3u);
  const std::vector<Cell>& at_40 = table.rows[1];
  ASSERT_EQ(at_40.size(), table.columns.size());
  const auto number = [&](std::size_t column) { return std::get<double>(at_40[column].value); };
  EXPECT_EQ(at_40[1], 40.0);
  EXPECT_EQ(number(3), 50.0) << "% of the finest";
  EXPECT_NEAR(number(4), 40.5, 1e-9) << "predicted";
  EXPECT_NEAR(number(5), 41.0, 1e-9) << "true";
  EXPECT_EQ(at_40[7], Cell()) << "FLIP is not known";
  EXPECT_EQ(number(10), 0.5) << "of the finest's time";
  EXPECT_EQ(table.rows[2][1], "finest");
  EXPECT_EQ(to_json(study)["scenes"][0]["rows"][1]["views"][0]["name"], "front");
  EXPECT_FALSE(html(page, to_json(study)).empty());
}

}  // namespace
}  // namespace binosplat::lab
