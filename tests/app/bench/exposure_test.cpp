// Before a comparison with photos, pictures get the exposures of the model's training.

#include <cmath>

#include "app/scene.h"
#include "base/image.h"
#include "formats/training/exposures.h"

namespace binosplat {
namespace {

/// Returns exposure.json's rows for a rotation of colours about grey, which keeps distances between colours,
/// plus a constant. The rotation by the negative angle is the transpose.
json turned_colours(double degrees, double added) {
  const double angle = degrees * std::acos(-1.0) / 180.0, c = (1.0 - std::cos(angle)) / 3.0,
               s = std::sin(angle) / std::sqrt(3.0), d = std::cos(angle) + c;
  return {{d, c + s, c - s, added}, {c - s, d, c + s, added}, {c + s, c - s, d, added}};
}

struct ExposureTest : SceneTest {
  ExposureTest() {
    add_row_of_cameras(6);
    save_ply(model, colourful(0.0f));
    for (int i = 0; i < 6; ++i)
      exposures["view" + std::to_string(i)] = turned_colours(i % 2 == 0 ? 30.0 : -30.0, 0.03 + 0.03 * i);
  }

  static Model colourful(float brighter) {
    Model made = test::random_model(71, 500, 1);
    for (std::size_t k = 0; k < made.sh.size(); ++k)
      made.sh[k] = brighter + made.sh[k] * (k % 12 < 3 ? 0.5f : 0.05f);
    return made;
  }

  /// Draws the model with the exposures, as photos of the views.
  void take_photos() const {
    ASSERT_TRUE(good(render({"--mono", "--view", "all", "-o", folder / "drawn"})));
    fs::create_directories(photos);
    const Exposures given(save("true.json", exposures));
    for (const auto& [view, rows] : exposures.items())
      save_png(photos + "/" + view + ".png",
               exposed(load_image(folder / "drawn" / (view + ".png")), given.of(view)));
  }

  double psnr(const Words& more = {}) const {
    return reported(joined(one, more))["views"][0]["photo_psnr_db"];
  }

  json exposures;
  const std::string photos = folder / "photos";
  const Words one = {"--mono", "--view", "view0", "--photos", photos};
};

TEST_F(ExposureTest, DefaultsToTrainingExposure) {
  take_photos();
  const double without = psnr();
  EXPECT_LT(without, 35.0);
  save("exposure.json", exposures);
  EXPECT_GT(psnr(), 50.0);  // rounded to 8 bits twice
  EXPECT_EQ(psnr({"--exposure", "none"}), without);
  EXPECT_TRUE(ended(render(one), 0, "exposure.json: each picture gets the exposure"));
  // Injected fault: the transposed matrix.
  json transposed = exposures;
  for (auto& [view, rows] : transposed.items()) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) rows[i][j] = exposures[view][j][i];
    }
  }
  EXPECT_LT(psnr({"--exposure", save("t.json", transposed)}), 35.0);
  // Exposures do not change the drawn picture. Exposures that change nothing are not mentioned.
  ASSERT_TRUE(good(render(joined(one, {"-o", folder / "again.png"}))));
  EXPECT_EQ(read_text(folder / "again.png"), read_text(folder / "drawn/view0.png"));
  for (auto& [view, rows] : transposed.items()) rows = turned_colours(0.0, 0.0);
  save("exposure.json", transposed);
  EXPECT_FALSE(has(render(one).err, "exposure.json"));
  EXPECT_EQ(psnr(), without);
}

TEST_F(ExposureTest, WarnsOfMissingExposure) {
  take_photos();
  exposures.erase("view0");
  save("exposure.json", exposures);
  EXPECT_TRUE(
      has(render(one).err, "exposure.json has no exposure of view view0: it is compared as it is drawn"));
}

TEST_F(ExposureTest, RejectsInvalidExposure) {
  take_photos();
  write_text(folder / "exposure.json", R"({"view0": [[1, 2]]})");
  const Refusal broken{one, "exposure.json, key 'view0'"};
  expect_refused({broken, {one, "--exposure none compares without it"}});
  EXPECT_TRUE(good(render(joined(one, {"--exposure", "none"}))));
  fs::remove_all(out);
  expect_refused({{{"--mono", "--view", "view0", "--exposure", "none"}, "has an effect only with --photos"},
                  {joined(one, {"--exposure", folder / "nowhere.json"}), "nowhere.json"}});
}

TEST_F(ExposureTest, RefitRemovesExposure) {
  take_photos();
  save_ply(model, colourful(-0.1f));
  const auto after = [&](const std::string& exposure) -> double {
    EXPECT_TRUE(good(run_program({"refit", model, "-o", folder / "m.ply", "--json", folder / "r.json",
                                  "--photos", photos, "--views", "2", "--exposure", exposure})));
    return load_json(folder / "r.json")["steps"].back()["validation_db"];
  };
  EXPECT_GT(after(folder / "true.json"), 40.0);
  EXPECT_LT(after("none"), 35.0) << "injected: photos of different exposures contradict each other";
  // Grey pictures contain no information about colours.
  exposures["view1"] = {{0.3, 0.3, 0.3, 0.0}, {0.3, 0.3, 0.3, 0.0}, {0.3, 0.3, 0.3, 0.0}};
  save("exposure.json", exposures);
  EXPECT_TRUE(ended(
      run_program({"refit", model, "-o", folder / "n.ply", "--photos", photos, "--validation", "view0"}), 2,
      "the exposure of view1 is singular"));
}

TEST_F(ExposureTest, AppliesInBenchAndTrim) {
  take_photos();
  write_text(folder / "axes.json",
             R"({"views": 1, "frames": 1, "repeats": 2, "sizes": ["own"], "settings": [{}]})");
  const auto db = [&](const std::string& exposure) -> double {
    const std::string to = folder / ("bench_" + fs::path(exposure).stem().string());
    EXPECT_TRUE(good(run_program({"bench", model, "--suite", folder / "axes.json", "--photos", photos,
                                  "--exposure", exposure, "-o", to})));
    return load_json(to + "/results.json")["points"][0]["photo_psnr_db"];
  };
  EXPECT_GT(db(folder / "true.json"), 50.0);
  EXPECT_LT(db("none"), 35.0);
  // A bound on the loss from about 50 dB leaves more Gaussians than one on the loss from 30 dB.
  const auto left = [&](const std::string& exposure) -> std::size_t {
    EXPECT_TRUE(
        good(run_program({"trim", model, "--max-drop", "0.5", "--photos", photos, "--exposure", exposure,
                          "--views", "2", "-o", folder / "t.ply", "--json", folder / "t.json"})));
    return load_json(folder / "t.json")["steps"].back()["gaussians"];
  };
  EXPECT_GT(left(folder / "true.json"), left("none"));
}

}  // namespace
}  // namespace binosplat
