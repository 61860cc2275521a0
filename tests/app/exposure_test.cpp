// Pictures get the exposures that a model was trained with before they are compared with photos.

#include <gtest/gtest.h>

#include <cmath>

#include "app/scene.h"
#include "base/image.h"
#include "formats/exposures.h"
#include "formats/image_file.h"
#include "support/fixtures.h"
#include "support/models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::ended;
using test::good;
using test::has;
using test::run_program;
using test::Words;

/// Turns colours about grey by an angle, which keeps all distances of colours, and adds something: as
/// exposure.json has it. Turned the other way it is its own transpose.
json turned_colours(double degrees, double added) {
  const double angle = degrees * std::acos(-1.0) / 180.0, c = (1.0 - std::cos(angle)) / 3.0,
               s = std::sin(angle) / std::sqrt(3.0), d = std::cos(angle) + c;
  return {{d, c + s, c - s, added}, {c - s, d, c + s, added}, {c + s, c - s, d, added}};
}

struct ExposureTest : test::SceneTest {
  ExposureTest() {
    add_row_of_cameras(6);
    Model colourful = test::random_model(71, 500, 1);
    for (std::size_t k = 0; k < colourful.sh.size(); ++k) colourful.sh[k] *= k % 12 < 3 ? 0.5f : 0.05f;
    test::save_ply(model, colourful);
    for (int i = 0; i < 6; ++i)
      exposures["view" + std::to_string(i)] = turned_colours(i % 2 == 0 ? 30.0 : -30.0, 0.03 + 0.03 * i);
  }

  /// Pictures of the model with the exposures, as photos of the views.
  void take_photos() const {
    ASSERT_TRUE(good(render({"--mono", "--view", "all", "-o", folder / "drawn"})));
    fs::create_directories(photos);
    test::write_text(folder / "true.json", exposures.dump());
    const Exposures given(folder / "true.json");
    for (const auto& [view, rows] : exposures.items())
      save_png(photos + "/" + view + ".png",
               exposed(load_image(folder / "drawn" / (view + ".png")), given.of(view)));
  }
  void write_exposures(const json& what) const { test::write_text(folder / "exposure.json", what.dump()); }

  double psnr(const Words& more = {}) const {
    return reported(
        joined({"--mono", "--view", "view0", "--photos", photos}, more))["views"][0]["photo_psnr_db"];
  }

  json exposures;
  const std::string photos = folder / "photos";
};

TEST_F(ExposureTest, IsThatOfTheTrainingUnlessAskedOtherwise) {
  take_photos();
  const double without = psnr();
  EXPECT_LT(without, 35.0);
  write_exposures(exposures);
  EXPECT_GT(psnr(), 50.0);  // rounded twice
  EXPECT_EQ(psnr({"--exposure", "none"}), without);
  const test::Outcome found = render({"--mono", "--view", "view0", "--photos", photos});
  EXPECT_TRUE(has(found.err, "exposure.json: each picture gets the exposure"));
  // Planted fault: a column before the matrix instead of a row.
  json transposed = exposures;
  for (auto& [view, rows] : transposed.items()) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) rows[i][j] = exposures[view][j][i];
    }
  }
  test::write_text(folder / "t.json", transposed.dump());
  EXPECT_LT(psnr({"--exposure", folder / "t.json"}), 35.0);
  // What is drawn stays as it is, and what changes nothing is not spoken of.
  ASSERT_TRUE(good(render({"--mono", "--view", "view0", "--photos", photos, "-o", folder / "again.png"})));
  EXPECT_EQ(test::read_text(folder / "again.png"), test::read_text(folder / "drawn/view0.png"));
  for (auto& [view, rows] : transposed.items()) rows = turned_colours(0.0, 0.0);
  write_exposures(transposed);
  EXPECT_FALSE(has(render({"--mono", "--view", "view0", "--photos", photos}).err, "exposure.json"));
  EXPECT_EQ(psnr(), without);
}

TEST_F(ExposureTest, OfAViewThatHasNoneIsSaidToBeMissing) {
  take_photos();
  exposures.erase("view0");
  write_exposures(exposures);
  EXPECT_TRUE(has(render({"--mono", "--view", "view0", "--photos", photos}).err,
                  "exposure.json has no exposure of view view0: it is compared as it is drawn"));
}

TEST_F(ExposureTest, ThatIsNoneIsAnError) {
  take_photos();
  const Words one = {"--mono", "--view", "view0", "--photos", photos};
  test::write_text(folder / "exposure.json", R"({"view0": [[1, 2]]})");
  const test::Refusal broken{one, "exposure.json, key 'view0'"};
  expect_refused({broken, {one, "--exposure none compares without it"}});
  EXPECT_TRUE(good(render(joined(one, {"--exposure", "none"}))));
  fs::remove_all(out);
  expect_refused({{{"--mono", "--view", "view0", "--exposure", "none"}, "that --photos compares with photos"},
                  {joined(one, {"--exposure", folder / "nowhere.json"}), "nowhere.json"}});
}

TEST_F(ExposureTest, IsTakenBackWhereColoursAreFitted) {
  take_photos();
  Model darker = test::random_model(71, 500, 1);
  for (std::size_t k = 0; k < darker.sh.size(); ++k) darker.sh[k] *= k % 12 < 3 ? 0.5f : 0.05f;
  for (float& c : darker.sh) c -= 0.1f;
  test::save_ply(model, darker);
  const auto after = [&](const std::string& exposure) -> double {
    EXPECT_TRUE(good(run_program({"refit", model, "-o", folder / "m.ply", "--json", folder / "r.json",
                                  "--photos", photos, "--views", "2", "--exposure", exposure})));
    return test::load_json(folder / "r.json")["steps"].back()["held_back_db"];
  };
  EXPECT_GT(after(folder / "true.json"), 40.0);
  EXPECT_LT(after("none"), 35.0) << "planted: photos of different exposures contradict each other";
  // Grey tells nothing of colours.
  exposures["view1"] = {{0.3, 0.3, 0.3, 0.0}, {0.3, 0.3, 0.3, 0.0}, {0.3, 0.3, 0.3, 0.0}};
  write_exposures(exposures);
  EXPECT_TRUE(
      ended(run_program({"refit", model, "-o", folder / "n.ply", "--photos", photos, "--held-back", "view0"}),
            2, "the exposure of view1 mixes its colours into fewer than three"));
}

TEST_F(ExposureTest, CountsInBenchesAndBounds) {
  take_photos();
  test::write_text(folder / "axes.json",
                   R"({"views": 1, "frames": 1, "repeats": 2, "sizes": ["own"], "settings": [{}]})");
  const auto db = [&](const std::string& exposure) -> double {
    const std::string to = folder / ("bench_" + fs::path(exposure).stem().string());
    EXPECT_TRUE(good(run_program({"bench", model, "--axes", folder / "axes.json", "--photos", photos,
                                  "--exposure", exposure, "-o", to})));
    return test::load_json(to + "/results.json")["points"][0]["photo_psnr_db"];
  };
  EXPECT_GT(db(folder / "true.json"), 50.0);
  EXPECT_LT(db("none"), 35.0);
  // A bound on what is lost of some 50 dB leaves more Gaussians than one on what is lost of 30.
  const auto left = [&](const std::string& exposure) -> std::size_t {
    EXPECT_TRUE(
        good(run_program({"trim", model, "--max-drop", "0.5", "--photos", photos, "--exposure", exposure,
                          "--views", "2", "-o", folder / "t.ply", "--json", folder / "t.json"})));
    return test::load_json(folder / "t.json")["steps"].back()["gaussians"];
  };
  EXPECT_GT(left(folder / "true.json"), left("none"));
}

// The photo of a trained model, with its colours turned, and the exposure that turns the picture's likewise.
TEST(ExposureOfFox, GivesTheDecibelsOfThePhotosThatItCameFrom) {
  REQUIRE_SCENE("fox", scene);
  const test::TempFolder folder;
  const fs::path ply = folder / "run/point_cloud/iteration_30000/point_cloud.ply";
  fs::create_directories(ply.parent_path());
  fs::create_symlink(scene / "fox.ply", ply);
  fs::copy(scene / "cameras.json", folder / "run");
  const json exposures = {{"0001", turned_colours(6.0, 0.03)}};
  test::write_text(folder / "run/exposure.json", exposures.dump());
  fs::create_directory(folder / "turned");
  save_png(folder / "turned/0001.png", exposed(load_image(scene / "photos/0001.jpg"),
                                               Exposures(folder / "run/exposure.json").of("0001")));
  const auto db = [&](const fs::path& photos, const std::string& exposure) -> double {
    EXPECT_TRUE(good(run_program({"render", ply, "--mono", "--view", "0001", "--photos", photos, "--exposure",
                                  exposure, "-o", folder / "out", "--json", folder / "r.json"})));
    return test::load_json(folder / "r.json")["views"][0]["photo_psnr_db"];
  };
  const double before = db(scene / "photos", "none");
  EXPECT_NEAR(db(folder / "turned", folder / "run/exposure.json"), before, 0.05);
  EXPECT_LT(db(folder / "turned", "none"), before - 1.0) << "planted: without the exposure";
}

}  // namespace
}  // namespace binosplat
