// Runs binosplat view with synthetic input, on a separate display (Xvfb, xdotool).

#include "app/scene.h"
#include "formats/models/model_file.h"
#include "lab/trace_rules.h"
#include "shared/choices.h"
#include "support/broken.h"
#include "support/display.h"
#include "support/level_errors.h"

namespace binosplat {
namespace {

bool is_built() { return fs::exists(fs::path(BINOSPLAT_PROGRAM).parent_path() / "binosplat-view"); }

/// Runs without a display.
struct View : testing::Test {
  void SetUp() override {
    if (!is_built()) GTEST_SKIP() << "the preview is not built";
  }
  static Outcome view(const Words& words) {
    return run_program(joined({"view", "demo:room"}, words), {.variables = {{"DISPLAY", ""}}});
  }
};

TEST_F(View, MissingDisplaySuggestsRender) {
  const Outcome outcome = view({});
  EXPECT_TRUE(ended(outcome, 3, "`binosplat render`"));
  // Debian 13's Wayland library also prints a message.
  const std::size_t ours = outcome.err.find("binosplat: ");
  ASSERT_NE(ours, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n', ours), outcome.err.size() - 1) << outcome.err;
}

TEST_F(View, RejectsOptionsBeforeWindow) {
  const Refusal cases[] = {
      {{"--mono"}, "--mono: binosplat view has no such option"},
      {{"--preset=headset"}, "--preset: binosplat view has no such option"},
      {{"--orbit=3"}, "--orbit: binosplat view has no such option"},
      {{"--frames=2"}, "--frames: binosplat view has no such option"},
      {{"--backend=device"}, "--backend needs --xr"},
      {{"--transmittance", "depth"}, "--transmittance"},
      {{"--view", "a", "--view", "b"}, "--view a b"},
      {{"--layout", "multi-view"}, "multi-view"},
      {{"--show", "colour"}, "--show"},
      {{"--threshold", "squared"}, "--tolerance"},
  };
  for (const auto& [words, said] : cases) EXPECT_TRUE(ended(view(words), 2, said));
}

TEST_F(View, HelpListsKeysAndValidOptions) {
  const std::string help = run_program({"view", "--help"}).out;
  for (const char* said :
       {"--layout", "Escape", "F12", "full screen", "adagscale", "--calibration", "switch"})
    EXPECT_TRUE(has(help, said));
  for (const char* refused : {"--mono", "--only", "--preset", "--path", "multi-view"})
    EXPECT_FALSE(has(help, refused));
}

/// A virtual display with a window, and synthetic input.
struct ViewWindow : SceneTest {
  std::string display;
  std::optional<test::VirtualDisplay> screen;
  std::optional<Program> window;

  void SetUp() override {
    if (std::getenv("BINOSPLAT_LONG") == nullptr) GTEST_SKIP() << "takes a minute: BINOSPLAT_LONG=1";
    if (std::system("command -v Xvfb > /dev/null && command -v xdotool > /dev/null") != 0)
      GTEST_SKIP() << "Xvfb and xdotool are not installed";
    if (!is_built()) GTEST_SKIP() << "the preview is not built";
    add_cameras();
    screen.emplace();
    display = screen->name();
    ASSERT_NE(display, "") << "Xvfb did not start";
  }

  /// Starts `view`.
  void start(const Words& words, std::map<std::string, std::string> variables = {}) {
    variables["DISPLAY"] = display;
    window.emplace(joined({"view"}, words), Surroundings{.variables = variables});
  }
  /// Starts `view` with a scene in a small window, without a screen distance, and waits until it is shown.
  void open_scene(const std::string& scene, const Words& more = {}) {
    start(joined({scene, "-o", out, "--size", "600x400", "--convergence", "inf"}, more));
    EXPECT_TRUE(says("Gaussians"));
  }
  void open(const Words& more = {}) { open_scene(model, more); }
  /// The same, with the picture in the whole window.
  void open_whole(const Words& more = {}) {
    open(more);
    key("F1");
  }

  void send_input(const std::string& what) const {
    EXPECT_EQ(std::system(fmt::format("DISPLAY={} xdotool {}", display, what).c_str()), 0) << what;
  }
  void key(const std::string& name) const {
    send_input("search --name binosplat windowfocus --sync key " + name);
  }
  void hold(const std::string& name, const char* seconds = "0.5") const {
    send_input(fmt::format("keydown {0} sleep {1} keyup {0}", name, seconds));
  }
  /// Presses the last key that the preview receives. The window may be gone before the key is released, and
  /// then xdotool complains.
  Outcome ended_by(const std::string& name) {
    const std::string keys = "search --name binosplat windowfocus --sync key " + name;
    if (std::system(fmt::format("DISPLAY={} xdotool {} 2> /dev/null", display, keys).c_str()) < 0)
      ADD_FAILURE() << "no shell";
    Outcome outcome = window->wait();
    // Otherwise the next window sees a pressed key.
    send_input("keyup " + name);
    return outcome;
  }
  /// Leaves the preview, and returns its output.
  std::string leave() {
    const Outcome outcome = ended_by("Escape");
    EXPECT_EQ(outcome.code, 0);
    return outcome.err;
  }

  /// Returns how often the preview has printed a text.
  int count_said(const std::string& text) const {
    const std::string said = window->said();
    int times = 0;
    for (std::size_t at = said.find(text); at != std::string::npos; at = said.find(text, at + 1)) ++times;
    return times;
  }
  /// Waits until it has printed a text that often.
  testing::AssertionResult says(const std::string& text, int times = 1) const {
    wait_until([&] { return count_said(text) >= times; });
    if (count_said(text) >= times) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "no " << times << ". '" << text << "' in: " << window->said();
  }

  /// Presses a key that saves a file.
  void save_by(const std::string& name) const {
    const int before = count_said("saved");
    key(name);
    EXPECT_TRUE(says("saved", before + 1));
  }
  /// Returns the picture that the window shows.
  Image shown() const {
    save_by("F12");
    int number = 0;
    const auto file = [&](int n) { return fs::path(out) / fmt::format("preview_{:03}.png", n); };
    while (fs::exists(file(number + 1))) ++number;
    return load_image(file(number));
  }

  /// Returns the same pose drawn by `render`.
  Image rendered(const std::string& pose, const Words& more = {}) const {
    EXPECT_TRUE(good(render(joined({"--cameras", out + "/cameras.json", "--view", pose, "--size", "300x400",
                                    "-o", folder / "rendered.png", "--convergence", "inf"},
                                   more))));
    return load_image(folder / "rendered.png");
  }
};

bool same(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && measure::largest_difference(a, b).max == 0.0;
}

TEST_F(ViewWindow, EqualsRender) {
  open_whole();
  const Image first = shown();
  save_by("k");
  EXPECT_TRUE(same(first, rendered("key_000", {"--layout", "parallel"})));
  EXPECT_FALSE(same(first, rendered("key_000", {"--layout", "cross-eyed"})));

  // Layout, tile test and threshold, each changed by a key.
  key("l");
  const Image crossed = shown();
  EXPECT_TRUE(same(crossed, rendered("key_000", {"--layout", "cross-eyed"})));
  key("h");
  key("t");  // the next of all tile tests, since the picture is not exact any more
  const Image third = shown();
  const Words approximate = {"--layout",    "cross-eyed", "--tiles",     "obb",
                             "--threshold", "adagscale",  "--tolerance", "0.15"};
  EXPECT_TRUE(same(third, rendered("key_000", approximate)));
  EXPECT_FALSE(same(third, crossed)) << "tiles and threshold changed nothing";

  // A key moves the head and the mouse turns it. The path has both poses, and render replays them.
  hold("w");
  send_input("mousemove 500 300 mousedown 3 mousemove 520 310 mouseup 3");
  save_by("k");
  const Image moved = shown();
  EXPECT_FALSE(same(moved, third)) << "nothing moved";
  EXPECT_TRUE(same(moved, rendered("key_001", approximate)));
  ASSERT_TRUE(good(render({"--path", out + "/cameras.json", "--fps", "2", "-o", folder / "replayed",
                           "--layout", "parallel", "--convergence", "inf"})));
  EXPECT_TRUE(same(first, load_image(folder / "replayed/path_00000.png"))) << "it begins elsewhere";
  EXPECT_TRUE(fs::exists(folder / "replayed/path_00004.png")) << "there are two seconds between keys";
  leave();
}

TEST_F(ViewWindow, UsesCalibrationAndFlipsToExact) {
  const std::string file = folder / "calibration.json";
  ASSERT_TRUE(good(run_program({"calibrate", model, "--quality", "36", "-o", file})));
  open_whole({"--threshold", "adagscale", "--calibration", file});
  save_by("k");
  const Image approximate = shown();
  EXPECT_TRUE(same(approximate, rendered("key_000", {"--layout", "parallel", "--threshold", "adagscale",
                                                     "--calibration", file})));
  key("x");
  const Image exact = shown();
  EXPECT_TRUE(same(exact, rendered("key_000", {"--layout", "parallel"})));
  EXPECT_FALSE(same(exact, approximate)) << "the calibration leaves nothing out";
  key("x");
  EXPECT_TRUE(same(shown(), approximate));
  leave();

  // Without a calibration, the table is measured before the first picture.
  open({"--threshold", "adagscale", "--tolerance", "3"});
  EXPECT_TRUE(says("transmittance by depth: measuring 4 views"));
  leave();
}

TEST_F(ViewWindow, ReloadKeepsKOfSameModel) {
  const std::string found = "AdaGScale: K = ";
  open({"--threshold", "adagscale", "--quality", "36"});
  ASSERT_TRUE(says(found));
  const Image by_k = shown();
  const int before = count_said("Gaussians");
  key("F5");
  ASSERT_TRUE(says("Gaussians", before + 1));
  EXPECT_TRUE(same(shown(), by_k));
  EXPECT_EQ(count_said(found), 1);
  Model other = load_model(model);
  for (float& opacity : other.opacity) opacity *= 0.9f;
  save_ply(model, other);
  key("F5");
  EXPECT_TRUE(says(found, 2)) << "another model has its own";
  EXPECT_EQ(count_said(": 36."), 2) << "for another quality than was asked for";
  leave();
}

TEST_F(ViewWindow, KeysShowGridAndCameras) {
  open_whole();
  hold("s", "1");  // away from the cameras
  const auto after = [&](const std::string& name) {
    key(name);
    return shown();
  };
  const Image plain = shown(), grid = after("b"), both = after("c"), of_cameras = after("b");
  EXPECT_FALSE(same(grid, plain));
  EXPECT_FALSE(same(both, grid));
  EXPECT_FALSE(same(of_cameras, both));
  EXPECT_FALSE(same(of_cameras, plain));
  EXPECT_TRUE(same(after("c"), plain));
  leave();

  fs::remove(folder / "cameras.json");
  open();
  key("c");
  EXPECT_TRUE(says("comes without cameras"));
  leave();
}

TEST_F(ViewWindow, KeyRecordsProfile) {
  const std::string profile = out + "/profile_001";
  open();
  key("F8");
  hold("w", "1");
  key("F8");
  ASSERT_TRUE(says("saved " + profile));
  EXPECT_TRUE(says("model.ply, in the window: "));
  leave();
  EXPECT_TRUE(fs::exists(profile + "/results.json"));
  const json trace = load_json(profile + "/trace.json");
  EXPECT_EQ(test::faults_of_trace(trace), Words());
  const lab::Table frames = test::frames_of(read_text(profile + "/frames.csv"));
  EXPECT_GT(frames.rows.size(), 3u) << "the head was under way for a second";
  EXPECT_EQ(test::differences_of(trace, frames), Words());
  EXPECT_TRUE(has(read_text(profile + "/report.html"), R"("png":"iVBORw0KGgo)"))
      << "no picture of a bad frame";
}

TEST_F(ViewWindow, PlaysAndExtendsKeys) {
  open();
  save_by("k");
  hold("w");
  save_by("k");
  const Image last = shown();
  key("space");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  key("space");
  EXPECT_FALSE(same(shown(), last)) << "the way back to the first key was not gone";
  key("space");
  std::this_thread::sleep_for(std::chrono::seconds(3));
  EXPECT_TRUE(same(shown(), last)) << "the way does not end at the last key";
  leave();

  open();
  ASSERT_TRUE(says("2 keys of a path"));
  save_by("k");
  leave();
  ASSERT_TRUE(good(render({"--path", out + "/cameras.json", "--keys", "-o", folder / "keys"})));
  EXPECT_TRUE(fs::exists(folder / "keys/key_002_left.png"));
}

TEST_F(ViewWindow, SurvivesResizeAndHide) {
  open_whole();
  send_input("search --name binosplat windowsize --sync 500 300");
  const Image resized = shown();
  EXPECT_EQ(resized.width, 500);
  EXPECT_EQ(resized.height, 300);
  send_input("search --name binosplat windowunmap --sync windowmap --sync");
  save_by("F11");
  EXPECT_TRUE(has(read_text(out + "/preview_001.exr"), "right.Z"));
  leave();
}

TEST_F(ViewWindow, ShowsDebugViews) {
  open_whole({"--threshold", "squared", "--tolerance", "0.5"});
  save_by("k");
  const auto written = [&](int show) {
    return rendered("key_000", {"--layout", "parallel", "--threshold", "squared", "--tolerance", "0.5",
                                "--show", show_choices[show].name});
  };
  for (int show = SHOW_SPLIT; show <= SHOW_ALPHAS; ++show) {
    key("v");
    const Image now = shown();
    EXPECT_TRUE(same(now, written(show))) << show_choices[show].name;
    EXPECT_FALSE(same(now, written(show - 1))) << show_choices[show].name << " is the one before";
  }
  leave();
}

TEST_F(ViewWindow, RestoresSavedPose) {
  open({"--units-per-metre", "2", "--ipd", "0.1"});
  send_input("search --name binosplat windowfocus --sync keydown w sleep 0.5 keyup w");
  save_by("F9");
  const Image saved = shown();
  leave();

  const Outcome outcome = render({"-o", folder / "again.png", "--convergence", "inf"});
  ASSERT_TRUE(ended(outcome, 0, "model.binosplat.json"));
  EXPECT_TRUE(has(outcome.err, "pose saved there"));
  EXPECT_TRUE(same(saved, load_image(folder / "again.png")));
  ASSERT_TRUE(good(render({"-o", folder / "other.png", "--convergence", "inf", "--units-per-metre", "1"})));
  EXPECT_FALSE(same(saved, load_image(folder / "other.png"))) << "the saved scale changes nothing";

  open();
  EXPECT_TRUE(same(shown(), saved));
  leave();
}

TEST_F(ViewWindow, SavesDetectedUp) {
  fs::remove(folder / "cameras.json");
  save_ply(model, room_model());
  open();
  save_by("F9");
  leave();
  const json pose = load_json(folder / "model.binosplat.json")[0];
  EXPECT_NEAR(pose["up"][2].get<double>(), 1.0, 1e-3) << pose.dump();
  EXPECT_NEAR(pose["position"][2].get<double>(), 1.6, 0.1) << pose.dump();
}

TEST_F(ViewWindow, FailedReloadKeepsScene) {
  open();
  const Image before = shown();
  fs::rename(model, folder / "whole.ply");
  write_text(model, "ply\nformat ascii 1.0\n");
  key("F5");
  ASSERT_TRUE(says("warning"));
  EXPECT_TRUE(same(shown(), before));

  fs::rename(folder / "whole.ply", model);
  key("F5");
  ASSERT_TRUE(says("Gaussians", 2));
  EXPECT_TRUE(same(shown(), before));
  leave();
}

TEST_F(ViewWindow, LoadsFinerLevels) {
  REQUIRE_FIXTURES(fixtures);
  const std::string scene = fixtures / "sog/st-lod";
  open_scene(scene);
  EXPECT_TRUE(says(": 250 Gaussians")) << "the coarsest at first";
  key("F1");
  ASSERT_TRUE(says("levels of 1000 Gaussians"));
  const Image finest = shown();
  save_by("k");
  leave();
  const auto drawn = [&](const std::string& level) {
    EXPECT_TRUE(
        good(run_program({"render", scene, "--cameras", out + "/cameras.json", "--view", "key_000", "--size",
                          "300x400", "--lod", level, "-o", folder / "level.png", "--convergence", "inf"})));
    return load_image(folder / "level.png");
  };
  EXPECT_TRUE(same(finest, drawn("0")));
  EXPECT_FALSE(same(finest, drawn("1")));

  open_scene(scene, {"--detail", "1e6"});
  key("F1");
  const Image coarsest = shown();
  EXPECT_FALSE(has(leave(), "levels of"));
  EXPECT_TRUE(same(coarsest, drawn("1")));

  const test::Copy told(scene);
  test::add_level_errors(told);
  open_scene(told.path(), {"--detail", "60dB"});
  ASSERT_TRUE(says("levels of 1000 Gaussians"));
  EXPECT_FALSE(has(leave(), "dB predicted")) << "of so few all are shown";
}

TEST_F(ViewWindow, QuitsWhileLoading) {
  start({"demo:city", "--count", "20000000", "-o", out});
  ASSERT_TRUE(says("drawing with"));
  const auto began = std::chrono::steady_clock::now();
  EXPECT_TRUE(has(leave(), "quit while demo:city was still loading"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
}

TEST_F(ViewWindow, ReportsMissingDisplayFeatures) {
  const auto ends = [&](const std::string& name, const std::string& value, const std::string& layout,
                        const std::string& said) {
    start({model, "-o", out, "--layout", layout}, {{name, value}});
    const Outcome outcome = window->wait();
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return ended(outcome, 3, said);
  };
  EXPECT_TRUE(ends("MESA_GL_VERSION_OVERRIDE", "3.3", "parallel", "`binosplat render`"));
  EXPECT_TRUE(ends("A", "b", "quad-buffer", "no stereo windows"));
}

TEST_F(ViewWindow, LostGpuEndsProgram) {
  // Reports a GPU reset once a picture is saved; see lost_context.cpp.
  const std::string flag = folder / "lost";
  start({model, "-o", out}, {{"LD_PRELOAD", BINOSPLAT_LOST_CONTEXT},
                             {"LOST_CONTEXT", flag},
                             {"ASAN_OPTIONS", "verify_asan_link_order=0"}});
  ASSERT_TRUE(says("Gaussians"));
  shown();
  write_text(flag, "");
  EXPECT_TRUE(ended(ended_by("t"), 3, "was reset"));
}

TEST_F(ViewWindow, DrawsNothingAtRest) {
  open();
  std::this_thread::sleep_for(std::chrono::seconds(4));
  const std::string said = leave();
  const std::size_t at = said.find(" frames were drawn, ");
  ASSERT_NE(at, std::string::npos) << said;
  const std::string drawn = said.substr(said.find(' ', said.rfind('\n', at) + 1) + 1);
  EXPECT_GE(std::stoi(drawn), 1);
  EXPECT_LE(std::stoi(drawn), 3) << said;
}

TEST_F(ViewWindow, ReportsBrokenModel) {
  write_text(folder / "broken.ply", "ply\nformat ascii 1.0\n");
  start({folder / "broken.ply", "-o", out});
  EXPECT_TRUE(ended(window->wait(), 2, "broken.ply"));
}

}  // namespace
}  // namespace binosplat
