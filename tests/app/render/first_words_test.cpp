// The first commands of a new user, right or wrong: the program does what is meant, or says what is wrong.

#include <cmath>

#include "app/scene.h"

namespace binosplat {
namespace {

struct CommandLine : SceneTest {
  Surroundings here;
  const Words small = {"--size", "36x24"};

  CommandLine() {
    add_cameras();
    here.folder = folder.path();
    here.variables = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
  }

  Outcome run(const Words& words) const { return run_program(words, here); }

  /// Returns what drawing a picture prints.
  std::string said(const Words& words) const { return checked(render(words, here)).err; }
};

TEST_F(CommandLine, ModelAloneIsRendered) {
  EXPECT_TRUE(ended(run({"model.ply", "--view", "side"}), 0, "no command: binosplat render model.ply"));
  EXPECT_TRUE(fs::exists(folder / "out" / folder.path().filename() / "side_left.png"));
  EXPECT_TRUE(ended(run({"mdoel.ply"}), 2, "mdoel.ply: there is no such command and no such model"));
}

TEST_F(CommandLine, SuggestsCorrections) {
  EXPECT_TRUE(ended(run({"rendr", "model.ply"}), 2, "did you mean render?"));
  EXPECT_TRUE(ended(run({"--foo", "render", "model.ply"}), 2, "--foo: binosplat has no such option"));
  EXPECT_TRUE(ended(run({"render", "model.ply", "--convergance=3"}), 2,
                    "--convergance: binosplat render has no such option; did you mean --convergence?"));
  EXPECT_TRUE(ended(run({"render", "model.ply", "other.ply"}), 2, "other.ply: one word too many"));
  const Outcome far = run({"render", "model.ply", "--xyzzy"});
  EXPECT_TRUE(ended(far, 2, "--xyzzy: binosplat render has no such option"));
  EXPECT_FALSE(has(far.err, "did you mean"));
}

// Every option takes one word, so the scene may be anywhere in the line.
TEST_F(CommandLine, AcceptsRepeatedOrCommaSeparatedNames) {
  const json cameras = {camera_json("front", 0.0), camera_json("side", 0.5), camera_json("a,b", 0.1)};
  save("cameras.json", cameras);
  const std::vector<std::pair<Words, Names>> cases = {
      {{"--view", "side"}, {"side"}},
      {{"--view=side"}, {"side"}},
      {{"--view", "front", "--view", "side"}, {"front", "side"}},
      {{"--view", "front,side"}, {"front", "side"}},
      {{"--view", "a,b"}, {"a,b"}},
      {{"--view", "a,b", "--view", "front,side"}, {"a,b", "front", "side"}}};
  for (const auto& [names, drawn] : cases) {
    fs::remove_all(out);
    ASSERT_TRUE(good(run(joined(joined({"render", "--mono", "-o", out}, joined(small, names)), {model}))));
    Names stems;
    for (const auto& file : fs::directory_iterator(out)) stems.insert(file.path().stem().string());
    EXPECT_EQ(stems, drawn) << names.back();
  }
  EXPECT_TRUE(ended(run({"render", "--view", "front,nobody", model, "-o", out}), 2, "--view nobody: "));
  EXPECT_TRUE(
      ended(run({"render", model, "--view", "front", "side", "-o", out}), 2, "side: one word too many"));
  EXPECT_TRUE(ended(run({"render", "-o", out}), 2, "SCENE is required"));
  EXPECT_TRUE(ended(run({"profile", model, "--view", "front,side", "-o", out}), 2, "name one"));
}

TEST_F(CommandLine, AcceptsUnitsOfLength) {
  const auto metres = [&](const char* option, const char* text) {
    return reported(joined(small, {option, text}))["views"][0];
  };
  EXPECT_DOUBLE_EQ(metres("--convergence", "300cm")["convergence_metres"], 3.0);
  EXPECT_DOUBLE_EQ(metres("--convergence", "2.5")["convergence_metres"], 2.5);
  EXPECT_TRUE(metres("--convergence", "inf")["convergence_metres"].is_null());
  EXPECT_DOUBLE_EQ(metres("--ipd", "64mm")["ipd_metres"], 0.064);
  EXPECT_DOUBLE_EQ(metres("--ipd", "2m")["ipd_metres"], 2.0);
}

TEST_F(CommandLine, QuietSuppressesOutput) {
  EXPECT_TRUE(has(render(small).out, "median ms"));
  const Outcome outcome = checked(render(joined(small, {"--quiet"})));
  EXPECT_FALSE(has(outcome.out, "median ms"));
  EXPECT_TRUE(has(outcome.out, "front_left.png"));
  EXPECT_EQ(run({"--quiet", "render", "model.ply", "--mono", "--size", "36x24", "-o", out}).err, "");
}

TEST_F(CommandLine, ChecksOptionsBeforeModel) {
  write_text(model, "no model");
  EXPECT_TRUE(ended(render({"--view", "nobody"}), 2, "has no camera of this name"));
  EXPECT_TRUE(ended(render({"--view", "front"}), 2, "model.ply is not a model"));
}

TEST_F(CommandLine, ExplainsEmptyPictures) {
  EXPECT_TRUE(has(said({"--eye", "0,0,0", "--at", "0,0,-4"}), "view camera looks away from the model"));
  EXPECT_TRUE(has(said({"--eye", "0,0,-100", "--at", "100,0,-90"}), "looks past the model"));
  EXPECT_TRUE(has(said({"--view", "front", "--near", "50"}), "nearer than --near 50"));
  EXPECT_TRUE(has(said({"--view", "front", "--ipd", "500m"}), "the eyes are 500 m apart"));
  EXPECT_FALSE(has(said({"--view", "front", "--reference-until", "project"}), "empty"));
}

TEST_F(CommandLine, EachModelHasOwnFolder) {
  for (const char* file : {"garden/point_cloud/iteration_7000/point_cloud.ply", "fox/exports/splat/splat.ply",
                           "scan.new.ply", "clip.mp4.ply", "a/bike.ply", "b/bike.ply", "c/b/bike.ply"}) {
    fs::create_directories((folder / file).parent_path());
    fs::copy(model, folder / file);
  }
  EXPECT_TRUE(good(run({"convert", "a/bike.ply", "-o", "a/bike.spz"})));
  // A built-in scene also has a separate folder.
  fs::create_directories(folder / "out/city");
  write_text(folder / "out/city/model.txt", (folder / "city.ply").string() + "\n");
  const std::pair<const char*, const char*> cases[] = {
      {"garden/point_cloud/iteration_7000/point_cloud.ply", "garden_iteration_7000"},
      {"garden", "garden"},
      {"fox/exports/splat/splat.ply", "fox"},
      {"scan.new.ply", "scan.new"},
      {"clip.mp4.ply", "clip.mp4"},
      {"a/bike.ply", "bike"},
      {"b/bike.ply", "b_bike"},
      {"c/b/bike.ply", "c_b_bike"},
      {"a/bike.spz", "a_bike"},
      {"b/bike.ply", "b_bike"},  // the same again
      {"demo:city", "city_2"},
  };
  for (const auto& [scene, name] : cases) {
    fs::remove_all(folder / "out" / name);
    Words words = {"render", scene, "--mono", "--size", "36x24"};
    if (scene == std::string("demo:city")) words.insert(words.end(), {"--count", "10000"});
    EXPECT_TRUE(good(run(words)));
    EXPECT_TRUE(fs::exists(folder / "out" / name / "model.txt")) << scene;
  }
  EXPECT_EQ(read_text(folder / "out/b_bike/model.txt"), (folder / "b/bike.ply").string() + "\n");
  EXPECT_EQ(read_text(folder / "out/city/model.txt"), (folder / "city.ply").string() + "\n");
}

TEST_F(CommandLine, AcceptsDotsInFolderNames) {
  EXPECT_TRUE(good(render(joined(small, {"-o", folder / "v1.2"}))));
  EXPECT_TRUE(fs::exists(folder / "v1.2/front_left.png"));
}

TEST_F(CommandLine, ReferenceHasNoGpuTimes) {
  const auto printed = [&](const std::string& stage) {
    return render(joined(small, {"--mono", "--frames", "2", "--reference-until", stage, "--json",
                                 folder / "r.json"}))
        .out;
  };
  const std::string by_reference = printed("blend");
  EXPECT_TRUE(has(by_reference, "(by the float64 reference, on the CPU)"));
  EXPECT_FALSE(has(by_reference, " ms"));
  EXPECT_TRUE(load_json(folder / "r.json")["views"][0]["gpu_ms"].is_null());
  EXPECT_TRUE(has(printed("project"), "blend  ")) << "the GPU's stages keep their times";
}

TEST_F(CommandLine, InfoListsViews) {
  const Outcome outcome = checked(run({"info", "model.ply", "--views", "--json", folder / "views.json"}));
  EXPECT_TRUE(has(outcome.out, "cameras.json: 4 views"));
  EXPECT_TRUE(has(outcome.out, "side        72 x 48 px, 43.6 degrees high, at 0.5,0,0"));
  EXPECT_EQ(load_json(folder / "views.json").size(), 4u);
}

TEST_F(CommandLine, OrbitFollowsCameras) {
  // Cameras around (0, 0, 4), each at a distance of 4; up is -y.
  json cameras = {camera_json("back", 0.0), camera_json("front", 0.0)};
  cameras[1]["position"] = {0.0, 0.0, 8.0};
  cameras[1]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  cameras.push_back(camera_json("side", -4.0));
  cameras[2]["position"] = {-4.0, 0.0, 4.0};
  cameras[2]["rotation"] = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  save("cameras.json", cameras);
  const Words orbit = joined(small, {"--orbit", "4", "--mono"});
  const json drawn = reported(orbit)["views"];
  ASSERT_EQ(drawn.size(), 4u);
  for (const json& view : drawn) {
    const auto at = view["eyes"][0]["position"].get<std::vector<double>>();
    EXPECT_NEAR(std::hypot(at[0], at[1], at[2] - 4.0), 4.0, 1e-5) << view.dump();
  }
  write_text(folder / "cameras.json", "no cameras");
  EXPECT_TRUE(ended(render(orbit), 0, "warning"));
}

TEST_F(CommandLine, DefaultCameraStandsOnGround) {
  fs::remove(folder / "cameras.json");
  EXPECT_TRUE(has(said(small), "the whole of it, from outside; up is 0.00,-1.00,0.00, as its format has it"));
  save_ply(model, room_model());
  const auto drawn = [&](const Words& words) {
    const std::string text = said(joined(joined(small, words), {"--mono", "--json", folder / "r.json"}));
    const json eye = load_json(folder / "r.json")["views"][0]["eyes"][0];
    return std::pair(text, eye["position"][2].get<double>());
  };
  const auto [text, height] = drawn({});
  EXPECT_TRUE(
      has(text, "from 1.6 units above its floor (--frame all, or --eye and --at, for others); up is"));
  EXPECT_TRUE(has(text, "0.00,1.00, by its floor (--up for another)"));
  EXPECT_NEAR(height, 1.6, 0.1);
  EXPECT_NEAR(drawn({"--units-per-metre", "0.5"}).second, 0.8, 0.1);
  EXPECT_NEAR(drawn({"--orbit", "3"}).second, 1.6, 0.1);
  const auto [other, above] = drawn({"--up", "0,-1,0"});
  EXPECT_TRUE(has(other, "from outside"));
  EXPECT_FALSE(has(other, "up is")) << "it was said";
  const Words eye = {"--eye", "1,-3,2", "--at", "0,0,1"};
  EXPECT_TRUE(has(drawn(eye).first, "from --eye: up is")) << "it is a guess";
  EXPECT_FALSE(has(drawn(joined(eye, {"--up", "0,0,1"})).first, "up is")) << "it was said";
  add_cameras();
  EXPECT_TRUE(has(drawn(eye).first, "0.00,-1.00,0.00, by what lies beside it (--up for another)"));
}

}  // namespace
}  // namespace binosplat
