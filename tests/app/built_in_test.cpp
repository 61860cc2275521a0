// binosplat render of scenes that the program makes, and of repeated ones.

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::read_text;
using test::run_program;

struct BuiltIn : test::SceneTest {
  Outcome city(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", "demo:city", "--count", "20000"});
    return run_program(more);
  }
  nlohmann::json report() const { return nlohmann::json::parse(read_text(folder / "r.json")); }
};

/// The share of pixels that the model leaves half open or more.
double open_share(const Image& image) {
  EXPECT_EQ(image.channels, 4);
  std::size_t open = 0;
  for (std::size_t k = 3; k < image.data.size(); k += 4) open += image.data[k] < 0.5f;
  return 4.0 * static_cast<double>(open) / static_cast<double>(image.data.size());
}

TEST_F(BuiltIn, TheCityIsClosed) {
  const std::vector<std::string> what = {"--mono", "--size", "160x90", "--background", "none"};
  std::vector<std::string> arguments = what;
  arguments.insert(arguments.end(), {"--view", "all", "-o", out, "--json", folder / "r.json"});
  ASSERT_TRUE(good(city(arguments)));
  for (const char* view : {"street", "air", "corner"}) {
    const Image image = load_image(out + "/" + view + ".png");
    EXPECT_EQ(open_share(image), 0.0) << view;
  }
  EXPECT_EQ(report()["scene"]["name"], "demo:city");
  EXPECT_EQ(report()["scene"]["seed"], 1);
  EXPECT_EQ(report()["scene"]["count"], 20000);
  EXPECT_EQ(report()["scene"]["gaussians"], 20000);
  EXPECT_FALSE(report()["scene"].contains("repeat"));
  // Seen from below, where nothing was built, it is not.
  arguments = what;
  arguments.insert(arguments.end(), {"--eye", "0,40,0", "--at", "0,80,1", "-o", out});
  ASSERT_TRUE(good(city(arguments)));
  EXPECT_GT(open_share(load_image(out + "/camera.png")), 0.5) << "a hole goes unnoticed";
}

TEST_F(BuiltIn, PairsAreComfortableAsTheyCome) {
  const auto draw = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "render");
    words.insert(words.end(), {"--view", "all", "--size", "160x90", "-o", out, "--json", folder / "r.json"});
    const Outcome outcome = run_program(words);
    EXPECT_TRUE(good(outcome));
    bool comfortable = true;
    const nlohmann::json views = report()["views"];
    for (const auto& view : views) comfortable = comfortable && view["disparity"]["comfortable"].get<bool>();
    EXPECT_EQ(outcome.err.find("tire most eyes") == std::string::npos, comfortable) << outcome.err;
    return comfortable;
  };
  EXPECT_TRUE(draw({"demo:room"}));
  EXPECT_TRUE(draw({"demo:room", "--layout", "anaglyph"}));
  EXPECT_TRUE(draw({"demo:city", "--count", "100000"}));
  EXPECT_FALSE(draw({"demo:room", "--ipd", "63mm"})) << "what tires goes unnoticed";
  EXPECT_EQ(report()["views"][0]["ipd_metres"], 0.063) << "options come first";
}

TEST_F(BuiltIn, AnotherSeedIsAnotherPicture) {
  const auto draw = [&](const std::string& name, const std::string& seed) {
    ASSERT_TRUE(good(city({"--mono", "--size", "96x54", "-o", folder / name, "--seed", seed})));
  };
  draw("a.png", "1");
  draw("b.png", "1");
  draw("c.png", "18446744073709551615");
  EXPECT_EQ(read_text(folder / "a.png"), read_text(folder / "b.png"));
  EXPECT_NE(read_text(folder / "a.png"), read_text(folder / "c.png"));
}

TEST_F(BuiltIn, MemoryIsToldBeforeItIsTaken) {
  add_cameras();
  const Outcome outcome = render({"-o", out, "--json", folder / "r.json"});
  ASSERT_TRUE(good(outcome));
  const nlohmann::json memory = report()["memory"];
  // 300 Gaussians of 48 bytes, and 12 SH coefficients of 4.
  EXPECT_EQ(memory["model_bytes"], 300 * (48 + 48));
  EXPECT_GT(memory["frame_bytes_at_least"].get<double>(), 2 * 72 * 48 * 16);
  EXPECT_LT(memory["frame_bytes_at_least"].get<double>(), memory["gpu_peak_bytes"].get<double>());
  EXPECT_NE(outcome.err.find("GPU memory: 0.0 MB for the model, at least 1.3 MB for a frame"),
            std::string::npos)
      << outcome.err;
  const Outcome large = city({"--size", "64x36", "--repeat", "4x4", "--spacing", "900", "-o", out});
  ASSERT_TRUE(good(large));
  EXPECT_NE(large.err.find("GPU memory: 31 MB for the model, at least "), std::string::npos) << large.err;
}

TEST_F(BuiltIn, CopiesAreDrawn) {
  add_cameras();
  ASSERT_TRUE(good(render({"-o", folder / "one.png", "--view", "front", "--mono"})));
  ASSERT_TRUE(good(
      render({"-o", folder / "same.png", "--view", "front", "--mono", "--repeat", "1x1", "--spacing", "5"})));
  ASSERT_TRUE(good(render({"-o", folder / "many.png", "--view", "front", "--mono", "--repeat", "2x3",
                           "--spacing", "1.5", "--json", folder / "r.json"})));
  EXPECT_EQ(read_text(folder / "one.png"), read_text(folder / "same.png"));
  EXPECT_NE(read_text(folder / "one.png"), read_text(folder / "many.png"));
  const nlohmann::json scene = report()["scene"];
  EXPECT_EQ(scene["gaussians"], 1800);
  EXPECT_EQ(scene["repeat"], (nlohmann::json{{"x", 2}, {"z", 3}, {"spacing", 1.5}}));
  EXPECT_FALSE(scene.contains("seed"));
}

TEST_F(BuiltIn, OptionsWithoutTheirScene) {
  EXPECT_TRUE(
      ended(render({"-o", out, "--seed", "1"}), 2, "--seed is for demo:city, and " + model + " is none"));
  EXPECT_TRUE(ended(render({"-o", out, "--count", "20000"}), 2, "--count is for demo:city"));
  EXPECT_TRUE(
      ended(run_program({"render", "demo:room", "--seed", "3", "-o", out}), 2, "--seed is for demo:city"));
  EXPECT_TRUE(
      ended(run_program({"render", "demo:town", "-o", out}), 2, "are called demo:room and demo:city"));
  EXPECT_TRUE(ended(render({"-o", out, "--repeat", "2x2"}), 2, "--repeat and --spacing go together"));
  EXPECT_TRUE(ended(render({"-o", out, "--spacing", "2"}), 2, "--repeat and --spacing go together"));
  EXPECT_EQ(folder.files(), (std::set<std::string>{"model.ply"}));
}

TEST_F(BuiltIn, ValuesThatAreNone) {
  const struct {
    std::vector<std::string> arguments;
    const char* said;
  } cases[] = {
      {{"demo:city", "--count", "9999"}, "--count 9999: demo:city is made of 10000 to 100000000 Gaussians"},
      {{"demo:city", "--count", "-5"}, "expected a whole number"},
      {{"demo:city", "--count", "99999999999999999999999"}, "expected a whole number"},
      {{"demo:city", "--seed", "many"}, "see: binosplat render --help"},
      {{model, "--repeat", "0x2", "--spacing", "1"}, "NXxNZ, for one 4x4"},
      {{model, "--repeat", "4", "--spacing", "1"}, "NXxNZ, for one 4x4"},
      {{model, "--repeat", "99999999999x2", "--spacing", "1"}, "NXxNZ, for one 4x4"},
      {{model, "--repeat", "65536x65536", "--spacing", "1"}, "--repeat 65536x65536 of 300 Gaussians"},
      {{model, "--repeat", "2x2", "--spacing", "0"}, "above zero"},
      {{model, "--repeat", "2x2", "--spacing", "nan"}, "above zero"},
      {{model, "--repeat", "2x2", "--spacing", "1e300"}, "--spacing: 1e300: expected a number above zero"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments = c.arguments;
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"-o", out});
    EXPECT_TRUE(ended(run_program(arguments), 2, c.said));
  }
  EXPECT_EQ(folder.files(), (std::set<std::string>{"model.ply"}));
}

}  // namespace
}  // namespace binosplat
