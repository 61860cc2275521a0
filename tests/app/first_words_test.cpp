// What a new user types first, right or wrong: the program does what is meant, or says what was not.

#include <cmath>

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::run_program;

struct FirstWords : test::SceneTest {
  test::Surroundings here;

  FirstWords() {
    add_cameras();
    here.folder = folder.path();
    here.variables = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
  }

  Outcome run(const std::vector<std::string>& words) const { return run_program(words, here); }

  /// What drawing a small picture said.
  std::string said(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", out});
    const Outcome outcome = render(arguments, here);
    EXPECT_TRUE(good(outcome));
    return outcome.err;
  }
};

TEST_F(FirstWords, AModelAloneIsDrawn) {
  EXPECT_TRUE(ended(run({"model.ply", "--view", "side"}), 0, "no command: binosplat render model.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / folder.path().filename() / "side_left.png"));
  EXPECT_TRUE(ended(run({"mdoel.ply"}), 2, "mdoel.ply: there is no such command and no such model"));
}

TEST_F(FirstWords, MistakesInWordsGetASuggestion) {
  EXPECT_TRUE(ended(run({"rendr", "model.ply"}), 2, "did you mean render?"));
  EXPECT_TRUE(ended(run({"render", "model.ply", "--sise", "3"}), 2,
                    "--sise: binosplat render has no such option; did you mean --size?"));
  EXPECT_TRUE(ended(run({"render", "model.ply", "--convergance=3"}), 2, "did you mean --convergence?"));
  EXPECT_TRUE(ended(run({"render", "model.ply", "other.ply"}), 2, "other.ply: one word too many"));
  const Outcome far = run({"render", "model.ply", "--xyzzy"});
  EXPECT_TRUE(ended(far, 2, "--xyzzy: binosplat render has no such option"));
  EXPECT_EQ(far.err.find("did you mean"), std::string::npos) << far.err;
}

TEST_F(FirstWords, AddressesAreNotFiles) {
  EXPECT_TRUE(ended(run({"render", "https://example.org/a.ply"}), 2, "download it first"));
}

TEST_F(FirstWords, OptionsMayComeBeforeTheScene) {
  EXPECT_TRUE(good(run({"render", "--view", "front", "side", "--size", "36x24", "-o", out, model})));
  EXPECT_TRUE(std::filesystem::exists(out + "/side_right.png"));
}

// Wherever an option takes many words, the last of them may be the scene.
TEST_F(FirstWords, TheSceneMayStandBehindTheNames) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"--view", "side"}, std::vector<std::string>{"--view", "front", "side"},
        std::vector<std::string>{"--view=side"}}) {
    std::filesystem::remove_all(out);
    std::vector<std::string> words = {"render", "--mono", "--size", "36x24"};
    words.insert(words.end(), names.begin(), names.end());
    words.insert(words.end(), {model, "-o", out});
    EXPECT_TRUE(good(run(words)));
    EXPECT_TRUE(std::filesystem::exists(out + "/side.png"));
    EXPECT_EQ(std::filesystem::exists(out + "/front.png"), names.size() == 3);
  }
  // These end at what comes next, a view that is not there.
  const std::string file = folder / "new.ply";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"trim", "--held-back", "nobody", model, "-o", file, "--quality", "40"},
           {"trim", "--test", "front", "nobody", model, "-o", file, "--quality", "40"},
           {"refit", "--held-back", "nobody", model, "-o", file, "--against", "exact"},
           {"calibrate", "--view", "nobody", model, "-o", folder / "c.json", "--quality", "40"},
           {"convert", "--view", "nobody", model, "-o", file, "--report", "2"},
           {"bench", "--view", "nobody", model, "-o", out},
           {"study", "--view", "nobody", model, "--turn"},
           {"--quiet", "render", "--view", "nobody", model, "-o", out}}) {
    const Outcome outcome = run(words);
    EXPECT_TRUE(ended(outcome, 2, "nobody")) << words[0];
    EXPECT_NE(outcome.err.find("has no camera of this name"), std::string::npos) << words[0] << outcome.err;
  }
  // What is a name stays one: where the scene stands elsewhere, and where no file is called so.
  test::write_text(folder / "side", "no model");
  EXPECT_TRUE(good(run({"render", model, "--view", "front", "side", "--size", "36x24", "-o", out})));
  EXPECT_TRUE(good(run({"render", "--view", "front", "side", "--size", "36x24", "-o", out, model})));
  EXPECT_TRUE(ended(run({"render", "--view", "front", "nosuch.ply", "-o", out}), 2,
                    "nosuch.ply was taken for a word of --view"));
  EXPECT_TRUE(good(run({"render", "--size", "36x24", "-o", out, "--view", "front", "side", "--", model})));
  EXPECT_TRUE(ended(run({"render", "-o", out}), 2, "SCENE is required"));
  // Several scenes, and an option that takes one word at a time.
  EXPECT_TRUE(ended(run({"study", "--levels", "--view", "front", model, "demo:room", "-o", out}), 2,
                    model + " is no folder with levels of detail"));
  EXPECT_TRUE(ended(run({"study", "--levels", "--detail", "1", model, "demo:room", "-o", out}), 2,
                    model + " is no folder with levels of detail"));
}

TEST_F(FirstWords, TheScreenHasAUnit) {
  const auto metres = [&](const char* text) {
    EXPECT_TRUE(
        good(render({"--convergence", text, "--size", "36x24", "-o", out, "--json", folder / "r.json"})));
    return nlohmann::json::parse(test::read_text(folder / "r.json"))["views"][0]["convergence_metres"];
  };
  EXPECT_DOUBLE_EQ(metres("300cm"), 3.0);
  EXPECT_DOUBLE_EQ(metres("2.5"), 2.5);
  EXPECT_DOUBLE_EQ(metres("4000mm"), 4.0);
  EXPECT_TRUE(metres("inf").is_null());
  EXPECT_TRUE(ended(render({"--convergence", "3ft", "-o", out}), 2, "its unit may be m, cm or mm"));
  EXPECT_TRUE(ended(render({"--convergence", "near", "-o", out}), 2, "--convergence near: expected metres"));
  EXPECT_TRUE(ended(render({"--convergence", "-3cm", "-o", out}), 2, "--convergence"));
}

TEST_F(FirstWords, QuietLeavesTheTableOut) {
  const std::vector<std::string> words = {"render", model, "--size", "36x24", "-o", out};
  EXPECT_NE(run(words).out.find("median ms"), std::string::npos);
  std::vector<std::string> quiet = words;
  quiet.emplace_back("--quiet");
  const Outcome outcome = run(quiet);
  ASSERT_TRUE(good(outcome));
  EXPECT_EQ(outcome.out.find("median ms"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("front_left.png"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.err.find("GPU memory"), std::string::npos) << outcome.err;
}

TEST_F(FirstWords, HelpSaysWhatTheCodesMean) {
  EXPECT_NE(run({"--help"}).out.find("3 no usable OpenGL, display or headset; 4 out of memory"),
            std::string::npos);
}

TEST_F(FirstWords, EyesApartHaveAUnit) {
  EXPECT_TRUE(ended(render({"--ipd", "63", "-o", out}), 2, "--ipd 63: that is 63 metres"));
  EXPECT_TRUE(ended(render({"--ipd", "0.063x", "-o", out}), 2, "its unit may be m, cm or mm"));
  const auto ipd = [&](const char* text) {
    EXPECT_TRUE(good(render({"--ipd", text, "--size", "36x24", "-o", out, "--json", folder / "r.json"})));
    return nlohmann::json::parse(test::read_text(folder / "r.json"))["views"][0]["ipd_metres"].get<double>();
  };
  EXPECT_DOUBLE_EQ(ipd("64mm"), 0.064);
  EXPECT_DOUBLE_EQ(ipd("0.5"), 0.5);
  EXPECT_DOUBLE_EQ(ipd("2m"), 2.0);
}

TEST_F(FirstWords, CheapChecksComeBeforeTheModelIsRead) {
  test::write_text(model, "no model");
  EXPECT_TRUE(ended(render({"--view", "nobody", "-o", out}), 2, "has no camera of this name"));
  EXPECT_TRUE(ended(render({"--calibration", "nosuch.json", "-o", out}), 2, "cannot read nosuch.json"));
  EXPECT_TRUE(ended(render({"--orbit", "2", "--fov", "190", "-o", out}), 2, "between 0 and 180"));
  EXPECT_TRUE(ended(render({"--view", "front", "-o", out}), 2, "model.ply is not a model"));
  // A photo of another size, wherever photos are compared, and one that fits.
  const auto run_with = [&](const std::string& command, const std::string& photo) {
    save_png(folder / "photos/front.png", Image(36, photo == "fits" ? 24 : 25, 3));
    std::vector<std::string> words = {command, model, "--photos", folder / "photos"};
    if (command == "render") words.insert(words.end(), {"--mono", "--size", "36x24", "--view", "front"});
    if (command != "render" && command != "refit") words.insert(words.end(), {"--max-drop", "1"});
    if (command == "bench" || command == "study") words.resize(4);
    words.insert(words.end(), {"-o", folder / (command == "calibrate"                    ? "c.json"
                                               : command == "refit" || command == "trim" ? "m.ply"
                                                                                         : "new")});
    return run(words);
  };
  std::filesystem::create_directory(folder / "photos");
  for (const char* command : {"render", "calibrate", "trim", "refit", "study", "bench"}) {
    EXPECT_TRUE(ended(run_with(command, "differs"), 2, "front.png has 36 x 25 px")) << command;
  }
  EXPECT_TRUE(ended(run_with("render", "fits"), 2, "model.ply is not a model"));
}

TEST_F(FirstWords, EmptyPicturesAreExplained) {
  EXPECT_NE(said({"--eye", "0,0,0", "--at", "0,0,-4"}).find("view camera looks away from the model"),
            std::string::npos);
  EXPECT_NE(said({"--eye", "0,0,-100", "--at", "100,0,-90"}).find("looks past the model"), std::string::npos);
  EXPECT_NE(said({"--view", "front", "--near", "50"}).find("nearer than --near 50"), std::string::npos);
  EXPECT_NE(said({"--view", "front", "--ipd", "500m"}).find("the eyes are 500 m apart"), std::string::npos);
  EXPECT_EQ(said({"--view", "front"}).find("empty"), std::string::npos);
  EXPECT_EQ(said({"--view", "front", "--reference-until", "project"}).find("empty"), std::string::npos);
}

TEST_F(FirstWords, OutputsAreWhatTheirEndingsSay) {
  EXPECT_TRUE(ended(render({"-o", folder / "a.gif"}), 2, "pictures are written as .png or .exr"));
  EXPECT_TRUE(ended(render({"-o", folder / "a.avi"}), 2, "videos as .mp4"));
  EXPECT_TRUE(ended(render({"-o", "-"}), 2, "-o -: pictures are files"));
  EXPECT_TRUE(ended(render({"--view", "front", "side", "-o", folder / "two.png"}), 2,
                    "two.png is one file, and 2 views are to be drawn (front, side): name a folder"));
  for (const char* name : {"v1.2", "run.v2", "plain"}) {
    EXPECT_TRUE(good(render({"--size", "36x24", "-o", folder / name})));
    EXPECT_TRUE(std::filesystem::exists(folder / name / "front_left.png")) << name;
  }
}

TEST_F(FirstWords, ModelsOfOneNameLeaveTheirPicturesApart) {
  const std::string bytes = test::read_text(model);
  for (const char* file : {"garden/point_cloud/iteration_7000/point_cloud.ply", "fox/exports/splat/splat.ply",
                           "bike/model.ply"}) {
    std::filesystem::create_directories((folder / file).parent_path());
    test::write_text(folder / file, bytes);
    EXPECT_TRUE(good(run({"render", file, "--size", "36x24"})));
  }
  EXPECT_TRUE(good(run({"render", "garden", "--size", "36x24"})));
  for (const char* name : {"garden_iteration_7000", "fox", "bike", "garden"})
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name / "framed_left.png")) << name;
}

TEST_F(FirstWords, TwoModelsOfOneFileNameDoToo) {
  for (const char* place : {"a", "b", "c/b"}) {
    std::filesystem::create_directories(folder / place);
    std::filesystem::copy(model, folder / place / "garden.ply");
  }
  const auto draw = [&](const std::string& file, const std::string& to) {
    std::filesystem::remove_all(folder / "out" / to / "framed_left.png");
    EXPECT_TRUE(good(run({"render", file, "--size", "36x24"})));
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / to / "framed_left.png")) << file;
  };
  for (int round = 0; round < 2; ++round) {
    draw("a/garden.ply", "garden");
    draw("b/garden.ply", "b_garden");
    draw("c/b/garden.ply", "c_b_garden");
  }
  EXPECT_EQ(test::read_text(folder / "out/b_garden/model.txt"), (folder / "b/garden.ply").string() + "\n");
  // Of one folder they differ in the ending.
  EXPECT_TRUE(good(run({"convert", "a/garden.ply", "-o", "a/garden.spz"})));
  EXPECT_TRUE(good(run({"convert", "a/garden.ply", "-o", "a/garden.splat"})));
  for (int round = 0; round < 2; ++round) {
    draw("a/garden.spz", "garden_spz");
    draw("a/garden.splat", "garden_splat");
  }
  // A built-in scene's folder is its own, too.
  std::filesystem::create_directories(folder / "out/city");
  test::write_text(folder / "out/city/model.txt", (folder / "city.ply").string() + "\n");
  EXPECT_TRUE(good(run({"render", "demo:city", "--count", "10000", "--size", "36x24"})));
  EXPECT_EQ(test::read_text(folder / "out/city/model.txt"), (folder / "city.ply").string() + "\n");
  EXPECT_EQ(test::read_text(folder / "out/city_2/model.txt"), "demo:city\n");
}

TEST_F(FirstWords, AModelsNameIsNoEnding) {
  std::filesystem::copy(model, folder / "scan.new.ply");
  std::filesystem::copy(model, folder / "clip.mp4.ply");
  for (const char* name : {"scan.new", "clip.mp4"}) {
    EXPECT_TRUE(good(run({"render", std::string(name) + ".ply", "--size", "36x24"})));
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name / "front_left.png")) << name;
  }
}

TEST_F(FirstWords, OptionsBeforeTheCommand) {
  EXPECT_TRUE(ended(run({"--foo", "render", "model.ply"}), 2, "--foo: binosplat has no such option"));
  const Outcome quiet = run({"--quiet", "render", "model.ply", "--mono", "--size", "36x24", "-o", out});
  EXPECT_TRUE(good(quiet));
  EXPECT_EQ(quiet.err, "");
}

TEST_F(FirstWords, QuietIsQuiet) {
  const Outcome outcome = render({"--quiet", "--mono", "--size", "36x24", "-o", out});
  EXPECT_TRUE(good(outcome));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(FirstWords, TheJudgeHasNoGpuTimes) {
  const auto printed = [&](const std::string& stage) {
    return render({"--mono", "--size", "36x24", "--frames", "2", "--reference-until", stage, "-o", out,
                   "--json", folder / "r.json"})
        .out;
  };
  const std::string judged = printed("blend");
  EXPECT_NE(judged.find("(by the float64 reference, on the CPU)"), std::string::npos) << judged;
  EXPECT_EQ(judged.find(" ms"), std::string::npos) << judged;
  EXPECT_TRUE(nlohmann::json::parse(test::read_text(folder / "r.json"))["views"][0]["gpu_ms"].is_null());
  EXPECT_NE(printed("project").find("blend  "), std::string::npos) << "the GPU's stages keep their times";
}

TEST_F(FirstWords, ViewsAreListed) {
  const Outcome outcome = run({"info", "model.ply", "--views", "--json", folder / "views.json"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("cameras.json: 4 views"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("side        72 x 48 px, 43.6 degrees high, at 0.5,0,0"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(nlohmann::json::parse(test::read_text(folder / "views.json")).size(), 4u);
}

TEST_F(FirstWords, AnOrbitGoesByTheCameras) {
  // Around (0, 0, 4), 4 away from each; up is -y.
  nlohmann::json cameras = {test::camera_json("back", 0.0), test::camera_json("front", 0.0)};
  cameras[1]["position"] = {0.0, 0.0, 8.0};
  cameras[1]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  cameras.push_back(test::camera_json("side", -4.0));
  cameras[2]["position"] = {-4.0, 0.0, 4.0};
  cameras[2]["rotation"] = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  test::write_text(folder / "cameras.json", cameras.dump());
  const Outcome outcome =
      render({"--orbit", "4", "--mono", "--size", "36x24", "-o", out, "--json", folder / "r.json"});
  EXPECT_TRUE(ended(outcome, 0, ": around what the cameras beside it look at"));
  const nlohmann::json drawn = nlohmann::json::parse(test::read_text(folder / "r.json"))["views"];
  ASSERT_EQ(drawn.size(), 4u);
  for (const nlohmann::json& view : drawn) {
    const auto at = view["eyes"][0]["position"].get<std::vector<double>>();
    EXPECT_NEAR(std::hypot(at[0], at[1], at[2] - 4.0), 4.0, 1e-5) << view.dump();
  }
  test::write_text(folder / "cameras.json", "no cameras");
  EXPECT_TRUE(ended(render({"--orbit", "4", "--mono", "--size", "36x24", "-o", out}), 0, "warning"));
}

TEST_F(FirstWords, WithoutCamerasOneStandsOnTheGround) {
  std::filesystem::remove(folder / "cameras.json");
  EXPECT_NE(said({"--size", "36x24"}).find("from outside; up is 0.00,-1.00,0.00, since nothing in it tells"),
            std::string::npos);
  test::save_ply(model, test::floor_model());
  const auto drawn = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--mono", "--size", "36x24", "--json", folder / "r.json"});
    const std::string text = said(arguments);
    const auto view = nlohmann::json::parse(test::read_text(folder / "r.json"))["views"][0]["eyes"][0];
    return std::pair(text, view["position"][2].get<double>());
  };
  const auto [text, height] = drawn({});
  EXPECT_NE(text.find("from 1.6 units above the ground (--eye and --at for another place); up is"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("0.00,1.00, by the surfaces in it (--up for another)"), std::string::npos) << text;
  EXPECT_NEAR(height, 1.6, 0.1);
  EXPECT_NEAR(drawn({"--units-per-metre", "0.5"}).second, 0.8, 0.1);
  EXPECT_NEAR(drawn({"--orbit", "3"}).second, 1.6, 0.1);
  const auto [other, above] = drawn({"--up", "0,-1,0"});
  EXPECT_NE(other.find("from outside"), std::string::npos) << other;
  EXPECT_EQ(other.find("up is"), std::string::npos) << "it was said: " << other;
  const std::vector<std::string> eye = {"--eye", "1,-3,2", "--at", "0,0,1"};
  EXPECT_NE(drawn(eye).first.find("from --eye: up is"), std::string::npos) << "it is a guess";
  std::vector<std::string> upright = eye;
  upright.insert(upright.end(), {"--up", "0,0,1"});
  EXPECT_EQ(drawn(upright).first.find("up is"), std::string::npos) << "it was said";
  add_cameras();
  const std::string beside = drawn(eye).first;
  EXPECT_NE(beside.find("0.00,-1.00,0.00, by what lies beside it (--up for another)"), std::string::npos)
      << beside;
}

}  // namespace
}  // namespace binosplat
