// binosplat render with built-in scenes, and with repeated ones.

#include "app/scene.h"

namespace binosplat {
namespace {

struct BuiltInScenes : SceneTest {
  Outcome draw(const std::string& scene, const Words& words) const {
    return run_into_out(joined({"render", scene, "--json", folder / "r.json"}, words));
  }
  json report() const { return load_json(folder / "r.json"); }
};

/// Returns the share of pixels of which the model covers less than half.
double open_share(const Image& image) {
  EXPECT_EQ(image.channels, 4);
  std::size_t open = 0;
  for (std::size_t k = 3; k < image.data.size(); k += 4) open += image.data[k] < 0.5f;
  return 4.0 * static_cast<double>(open) / static_cast<double>(image.data.size());
}

TEST_F(BuiltInScenes, CityHasNoHoles) {
  const Words what = {"--count", "20000", "--mono", "--size", "160x90", "--background", "none"};
  ASSERT_TRUE(good(draw("demo:city", joined(what, {"--view", "all"}))));
  for (const char* view : {"street", "air", "corner"})
    EXPECT_EQ(open_share(load_image(out + "/" + view + ".png")), 0.0) << view;
  const json scene = report()["scene"];
  EXPECT_EQ(scene["name"], "demo:city");
  EXPECT_EQ(scene["seed"], 1);
  EXPECT_EQ(scene["count"], 20000);
  EXPECT_EQ(scene["gaussians"], 20000);
  EXPECT_FALSE(scene.contains("repeat"));
  // Another seed makes another city.
  const std::string street = read_text(out + "/street.png");
  ASSERT_TRUE(good(draw("demo:city", joined(what, {"--seed", "1"}))));
  EXPECT_EQ(read_text(out + "/street.png"), street);
  ASSERT_TRUE(good(draw("demo:city", joined(what, {"--seed", "18446744073709551615"}))));
  EXPECT_NE(read_text(out + "/street.png"), street);
  // Seen from below, where nothing is built, the city is open.
  ASSERT_TRUE(good(draw("demo:city", joined(what, {"--eye", "0,40,0", "--at", "0,80,1"}))));
  EXPECT_GT(open_share(load_image(out + "/camera.png")), 0.5) << "a hole goes unnoticed";
}

TEST_F(BuiltInScenes, DefaultDisparityIsComfortable) {
  const auto comfortable = [&](const std::string& scene, const Words& words) {
    const Outcome outcome = checked(draw(scene, joined(words, {"--view", "all", "--size", "160x90"})));
    bool all = true;
    const json views = report()["views"];
    for (const json& view : views) all = all && view["disparity"]["comfortable"].get<bool>();
    EXPECT_EQ(outcome.err.find("tire most eyes") == std::string::npos, all) << outcome.err;
    return all;
  };
  EXPECT_TRUE(comfortable("demo:room", {}));
  EXPECT_TRUE(comfortable("demo:city", {"--count", "100000"}));
  EXPECT_FALSE(comfortable("demo:room", {"--ipd", "63mm"})) << "what tires goes unnoticed";
  EXPECT_EQ(report()["views"][0]["ipd_metres"], 0.063) << "options come first";
}

TEST_F(BuiltInScenes, RepeatsModel) {
  add_cameras();
  const auto copies = [&](const std::string& name, const Words& words) {
    return reported(joined(words, {"--view", "front", "--mono", "-o", folder / name}))["scene"];
  };
  copies("one.png", {});
  copies("same.png", {"--repeat", "1x1", "--spacing", "5"});
  const json scene = copies("many.png", {"--repeat", "2x3", "--spacing", "1.5"});
  EXPECT_EQ(read_text(folder / "one.png"), read_text(folder / "same.png"));
  EXPECT_NE(read_text(folder / "one.png"), read_text(folder / "many.png"));
  EXPECT_EQ(scene["gaussians"], 1800);
  EXPECT_EQ(scene["repeat"], (json{{"x", 2}, {"z", 3}, {"spacing", 1.5}}));
  EXPECT_FALSE(scene.contains("seed"));
}

}  // namespace
}  // namespace binosplat
