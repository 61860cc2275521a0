// binosplat refit.

#include "app/scene.h"
#include "formats/models/model_file.h"

namespace binosplat {
namespace {

Model colourful() {
  Model model = test::random_model(71, 500, 1);
  for (std::size_t k = 0; k < model.sh.size(); ++k) model.sh[k] *= k % 12 < 3 ? 0.5f : 0.1f;
  return model;
}

struct RefitTest : SceneTest {
  RefitTest() {
    add_row_of_cameras(8);
    save_ply(model, colourful());
  }

  /// Draws the current model as photos of the views.
  void take_photos(const fs::path& to) const {
    ASSERT_TRUE(good(run_program({"render", model, "--mono", "--view", "all", "-o", to})));
  }

  Outcome refit(const std::string& to, const Words& more) const {
    return run_program(joined({"refit", model, "-o", folder / to, "--json", folder / "r.json"}, more));
  }
  json steps() const { return load_json(folder / "r.json")["steps"]; }
};

TEST_F(RefitTest, RecoversPhotoColours) {
  take_photos(folder / "photos");
  Model darker = colourful();
  for (float& c : darker.sh) c -= 0.2f;
  save_ply(model, darker);
  const Outcome outcome =
      checked(refit("m.ply", {"--photos", folder / "photos", "--views", "2", "--test", "view3"}));
  const json all = steps();
  ASSERT_EQ(all.size(), 3u) << outcome.out;
  const double before = all[0]["validation_db"], after = all[2]["validation_db"], test = all[2]["test_db"];
  EXPECT_GT(after, before + 10.0);
  EXPECT_GT(test, before + 10.0);
  EXPECT_TRUE(has(outcome.out, "6 views fitted, 6 of them to photos; 1 to validate, 1 to test"));
  const Model found = load_model(folder / "m.ply");
  EXPECT_EQ(found.position, darker.position);
  EXPECT_EQ(found.opacity, load_model(model).opacity);
  EXPECT_EQ(found.perspective, Perspective{});

  EXPECT_EQ(load_json(folder / "r.json")["written"], true);
  // A view without a photo is fitted to the model's exact picture.
  fs::remove(folder / "photos" / "view5.png");
  const Outcome fewer = checked(refit("n.ply", {"--photos", folder / "photos"}));
  EXPECT_TRUE(has(fewer.out, "7 views fitted, 6 of them to photos; 1 to validate"));
}

TEST_F(RefitTest, FitsOtherOrderAndProjection) {
  ASSERT_TRUE(good(refit("m.ply", {"--against", "exact", "--order", "distance", "--projection", "tangent",
                                   "--validation", "view2,view4"})));
  EXPECT_EQ(load_json(folder / "r.json")["validation"], json({"view2", "view4"}));
  const json all = steps();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0]["validation_db"], 100.0);
  EXPECT_GT(all[3]["validation_db"], all[1]["validation_db"]);
  EXPECT_EQ(load_model(folder / "m.ply").perspective, (Perspective{Order::distance, Projection::tangent}));
}

TEST_F(RefitTest, NeverWritesWorseModel) {
  const Outcome same = refit("m.ply", {"--against", "exact"});
  EXPECT_TRUE(ended(same, 1, "would not improve on 100.000 dB"));
  EXPECT_FALSE(fs::exists(folder / "m.ply"));
  // The format loses more than the fit gains.
  const Outcome coarse = refit("m.sog", {"--against", "exact", "--order", "distance"});
  EXPECT_TRUE(ended(coarse, 1, "m.sog is not written"));
  EXPECT_FALSE(fs::exists(folder / "m.sog"));
}

TEST_F(RefitTest, RejectsInvalidOptions) {
  take_photos(folder / "one");
  for (int i = 1; i < 8; ++i) fs::remove(folder / "one" / ("view" + std::to_string(i) + ".png"));
  const std::string ply = folder / "m.ply";
  expect_refused_after({"refit", model, "-o", ply},
                       {{{"--photos", folder / "one"}, "only validation or test views have photos"},
                        {{}, "--photos DIR, or --against exact"},
                        {{"--against", "exact", "--photos", folder.path()}, "--against exact"},
                        {{"--against", "exact", "--sh-bits", "4"}, "only spz"},
                        {{"--against", "photos"}, "photos"},
                        {{"--photos", folder / "none"}, "none"},
                        {{"--against", "exact", "--test", "nowhere"}, "--test nowhere: "},
                        {{"--against", "exact", "--test", "view1", "--validation", "view1"},
                         "--validation view1: the view is named twice"}});
  expect_refused_after({"refit", "--against", "exact"}, {{{model, "-o", folder / "m.png"}, "m.png"}});
  fs::remove(folder / "cameras.json");
  expect_refused_after({"refit", "--against", "exact", "-o", ply}, {{{model}, "refit needs the cameras"}});
  fs::remove(model);
  expect_refused_after({"refit", "--against", "exact", "-o", ply}, {{{model}, "cannot read " + model}});
}

}  // namespace
}  // namespace binosplat
