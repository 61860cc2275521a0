// binosplat view, driven by synthetic input on a display of its own (Xvfb, xdotool).

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "app/scene.h"
#include "formats/image_file.h"
#include "lab/trace_rules.h"
#include "measure/metrics.h"
#include "support/broken.h"
#include "support/display.h"
#include "support/fixtures.h"
#include "support/level_errors.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::Program;
using test::Surroundings;
namespace fs = std::filesystem;

bool is_built() { return fs::exists(fs::path(BINOSPLAT_PROGRAM).parent_path() / "binosplat-view"); }

TEST(View, WithoutADisplayNamesRender) {
  if (!is_built()) GTEST_SKIP() << "the preview is not built";
  const Outcome outcome = test::run_program({"view", "demo:room"}, {.variables = {{"DISPLAY", ""}}});
  EXPECT_TRUE(ended(outcome, 3, "`binosplat render`"));
  // Debian 13's Wayland library has something to say, too.
  const std::size_t ours = outcome.err.find("binosplat: ");
  ASSERT_NE(ours, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n', ours), outcome.err.size() - 1) << outcome.err;
}

TEST(View, BadOptionsEndBeforeAnyWindow) {
  if (!is_built()) GTEST_SKIP() << "the preview is not built";
  const Surroundings none = {.variables = {{"DISPLAY", ""}}};
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& said) {
    std::vector<std::string> all = {"view", "demo:room"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = test::run_program(all, none);
    if (outcome.err.find("built without its preview") != std::string::npos)
      return testing::AssertionSuccess();
    return ended(outcome, 2, said);
  };
  for (const char* option : {"--mono", "--preset=headset", "--orbit=3", "--frames=2"}) {
    const std::string text = option;
    EXPECT_TRUE(refused({text}, text.substr(0, text.find('=')) + ": binosplat view has no such option"));
  }
  EXPECT_TRUE(refused({"--backend=device"}, "--backend is for `binosplat render`"));
  EXPECT_TRUE(refused({"--transmittance", "depth"}, "--transmittance"));
  EXPECT_TRUE(refused({"--view", "a", "--view", "b"}, "--view a b"));
  EXPECT_TRUE(refused({"--layout", "multi-view"}, "multi-view"));
  EXPECT_TRUE(refused({"--show", "colour"}, "--show"));
  EXPECT_TRUE(refused({"--th", "squared"}, "--tolerance"));
  EXPECT_TRUE(refused({"--no-such-option"}, "--no-such-option"));
  EXPECT_TRUE(refused({"--fps", "10"}, "--fps is for a folder with several models, and demo:room is none"));
}

TEST(View, HelpHasKeysAndNoOptionThatIsRefused) {
  if (!is_built()) GTEST_SKIP() << "the preview is not built";
  const Outcome outcome = test::run_program({"view", "--help"});
  ASSERT_TRUE(good(outcome));
  for (const char* said : {"--layout", "Escape", "F12", "full screen", "adagscale", "--calibration", "flip"})
    EXPECT_NE(outcome.out.find(said), std::string::npos) << said;
  for (const char* refused : {"--mono", "--only", "--preset", "--path", "multi-view"})
    EXPECT_EQ(outcome.out.find(refused), std::string::npos) << refused;
}

/// A display without a screen, and hands on it.
struct ViewOnADisplay : test::SceneTest {
  std::string display;
  std::optional<test::VirtualDisplay> screen;

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

  Program view(std::vector<std::string> more = {}) { return view(model, std::move(more)); }
  Program view(const std::string& scene, std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "view",    scene,           "-o", out, "--size",
        "600x400", "--convergence", "inf"};  // none that goes by what is seen
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Program(arguments, {.variables = {{"DISPLAY", display}}});
  }

  void hands(const std::string& what) const {
    EXPECT_EQ(std::system(fmt::format("DISPLAY={} xdotool {}", display, what).c_str()), 0) << what;
  }
  /// The last key that the preview gets. The window may be gone before it is let go, of which xdotool
  /// complains.
  Outcome ended_by(const std::string& name, Program& program) const {
    const std::string keys = "search --name binosplat windowfocus --sync key " + name;
    if (std::system(fmt::format("DISPLAY={} xdotool {} 2> /dev/null", display, keys).c_str()) < 0)
      ADD_FAILURE() << "no shell";
    Outcome outcome = program.wait();
    // Else the next window is told of a key that is held.
    hands("keyup " + name);
    return outcome;
  }
  Outcome leave(Program& program) const { return ended_by("Escape", program); }

  void key(const std::string& name) const { hands("search --name binosplat windowfocus --sync key " + name); }

  /// Waits until a run has said something so often.
  static testing::AssertionResult says(const Program& program, const std::string& text, int times = 1) {
    for (int tries = 0; tries < 600; ++tries) {
      const std::string said = program.said();
      int found = 0;
      for (std::size_t at = said.find(text); at != std::string::npos; at = said.find(text, at + 1)) ++found;
      if (found >= times) return testing::AssertionSuccess();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return testing::AssertionFailure() << "no " << times << ". '" << text << "' in: " << program.said();
  }

  Image picture(int number) const {
    return load_image(fs::path(out) / fmt::format("preview_{:03}.png", number));
  }

  /// The same pose as `render` draws it.
  Image rendered(const std::string& key, const std::string& size,
                 const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "--cameras", out + "/cameras.json",   "--view",        key,  "--size", size,
        "-o",        folder / "rendered.png", "--convergence", "inf"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_TRUE(good(render(arguments)));
    return load_image(folder / "rendered.png");
  }
};

bool same(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && measure::largest_difference(a, b).max == 0.0;
}

TEST_F(ViewOnADisplay, ShowsWhatRenderDraws) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F1");  // the picture takes the whole window
  key("F12");
  ASSERT_TRUE(says(program, "saved", 1));
  key("k");
  ASSERT_TRUE(says(program, "saved", 2));
  EXPECT_TRUE(same(picture(1), rendered("key_000", "300x400", {"--layout", "parallel"})));
  EXPECT_FALSE(same(picture(1), rendered("key_000", "300x400", {"--layout", "cross-eyed"})));

  // Layout, tiles and a threshold, each by a key.
  key("l");
  key("F12");
  ASSERT_TRUE(says(program, "saved", 3));
  EXPECT_TRUE(same(picture(2), rendered("key_000", "300x400", {"--layout", "cross-eyed"})));
  key("h");
  key("t");  // of pictures that are not exact any more: the next of all
  key("F12");
  ASSERT_TRUE(says(program, "saved", 4));
  const std::vector<std::string> approximate = {"--layout", "cross-eyed", "--tiles",     "obb",
                                                "--th",     "peripheral", "--tolerance", "0.15"};
  EXPECT_TRUE(same(picture(3), rendered("key_000", "300x400", approximate)));
  EXPECT_FALSE(same(picture(3), picture(2))) << "tiles and th changed nothing";

  // Moved by a held key and turned by the mouse; the path has both poses, and render replays it.
  hands("keydown w sleep 0.5 keyup w");
  hands("mousemove 500 300 mousedown 3 mousemove 520 310 mouseup 3");
  key("k");
  ASSERT_TRUE(says(program, "saved", 5));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 6));
  EXPECT_FALSE(same(picture(4), picture(3))) << "nothing moved";
  EXPECT_TRUE(same(picture(4), rendered("key_001", "300x400", approximate)));
  ASSERT_TRUE(good(render({"--path", out + "/cameras.json", "--fps", "2", "-o", folder / "replayed",
                           "--layout", "parallel", "--convergence", "inf"})));
  EXPECT_TRUE(same(picture(1), load_image(folder / "replayed/path_00000.png"))) << "it begins elsewhere";
  EXPECT_TRUE(fs::exists(folder / "replayed/path_00004.png")) << "there are two seconds between keys";

  EXPECT_EQ(leave(program).code, 0);
}

TEST_F(ViewOnADisplay, DrawsByACalibrationAndFlipsToTheExactPicture) {
  const std::string file = folder / "calibration.json";
  ASSERT_TRUE(good(test::run_program({"calibrate", model, "--quality", "36", "-o", file})));
  Program program = view({"--th", "adagscale", "--calibration", file});
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F1");
  key("k");
  ASSERT_TRUE(says(program, "saved", 1));
  int saved = 1;
  const auto now = [&] {
    key("F12");
    EXPECT_TRUE(says(program, "saved", ++saved));
    return picture(saved - 1);
  };
  const Image approximate = now();
  EXPECT_TRUE(same(
      approximate,
      rendered("key_000", "300x400", {"--layout", "parallel", "--th", "adagscale", "--calibration", file})));
  key("x");
  const Image exact = now();
  EXPECT_TRUE(same(exact, rendered("key_000", "300x400", {"--layout", "parallel"})));
  EXPECT_FALSE(same(exact, approximate)) << "the calibration leaves nothing out";
  key("x");
  EXPECT_TRUE(same(now(), approximate));
  EXPECT_EQ(leave(program).code, 0);

  // Without a calibration the table is measured while the window shows its first pictures.
  Program measuring = view({"--th", "adagscale", "--tolerance", "3"});
  EXPECT_TRUE(says(measuring, "measured how much light reaches each depth"));
  EXPECT_EQ(leave(measuring).code, 0);
}

TEST_F(ViewOnADisplay, AGridAndCamerasAreShownByKeys) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F1");
  hands("keydown s sleep 0.5 keyup s");  // out of where the cameras are
  int saved = 0;
  const auto after = [&](const std::string& name) {
    if (!name.empty()) key(name);
    key("F12");
    EXPECT_TRUE(says(program, "saved", ++saved));
    return picture(saved);
  };
  const Image plain = after(""), grid = after("b"), both = after("c"), of_cameras = after("b");
  EXPECT_FALSE(same(grid, plain));
  EXPECT_FALSE(same(both, grid));
  EXPECT_FALSE(same(of_cameras, both));
  EXPECT_FALSE(same(of_cameras, plain));
  EXPECT_TRUE(same(after("c"), plain));
  EXPECT_EQ(leave(program).code, 0);

  fs::remove(folder / "cameras.json");
  Program without = view();
  ASSERT_TRUE(says(without, "Gaussians"));
  key("c");
  EXPECT_TRUE(says(without, "comes without cameras"));
  EXPECT_EQ(leave(without).code, 0);
}

TEST_F(ViewOnADisplay, AMovingSceneGoesOnUntilItIsHeld) {
  const std::string frames = folder / "frames";
  fs::create_directory(frames);
  fs::copy_file(model, frames + "/f_1.ply");
  test::PlyFile brighter = test::small_model();
  for (auto& row : brighter.rows) row[brighter.column("f_dc_0")] += 1.0;
  test::write_text(frames + "/f_2.ply", to_bytes(brighter));
  Program program = view(frames, {"--fps", "4", "--cameras", folder / "cameras.json"});
  ASSERT_TRUE(says(program, "Gaussians"));
  int saved = 0;
  const auto now = [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    key("F12");
    EXPECT_TRUE(says(program, "saved", ++saved));
    return picture(saved);
  };
  const Image first = now();
  Image other = now();
  for (int tries = 0; tries < 20 && same(other, first); ++tries) other = now();
  EXPECT_FALSE(same(other, first)) << "it does not go on";
  for (int tries = 0; tries < 20 && !same(other, first); ++tries) other = now();
  EXPECT_TRUE(same(other, first)) << "it does not begin again";
  key("space");
  const Image held = now();
  for (int tries = 0; tries < 4; ++tries) EXPECT_TRUE(same(now(), held));
  EXPECT_EQ(leave(program).code, 0);
}

TEST_F(ViewOnADisplay, FramesAreRecordedByAKey) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F8");
  hands("keydown w sleep 1 keyup w");
  key("F8");
  ASSERT_TRUE(says(program, "saved " + out + "/profile_001"));
  EXPECT_TRUE(says(program, "model.ply, in the window: "));
  EXPECT_EQ(leave(program).code, 0);
  for (const char* const name : {"report.html", "trace.json", "frames.csv", "results.json"})
    EXPECT_TRUE(fs::exists(fs::path(out) / "profile_001" / name)) << name;
  const auto trace = nlohmann::json::parse(test::read_text(out + "/profile_001/trace.json"));
  EXPECT_EQ(test::faults_of_trace(trace), std::vector<std::string>());
  const lab::Table frames = test::frames_of(test::read_text(out + "/profile_001/frames.csv"));
  EXPECT_GT(frames.rows.size(), 3u) << "the head was under way for a second";
  EXPECT_EQ(test::differences_of(trace, frames), std::vector<std::string>());
  const std::string page = test::read_text(out + "/profile_001/report.html");
  EXPECT_NE(page.find(R"("png":"iVBORw0KGgo)"), std::string::npos) << "no picture of a bad frame";
}

TEST_F(ViewOnADisplay, KeysArePlayedAndGoneOnWith) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("k");
  ASSERT_TRUE(says(program, "saved", 1));
  hands("keydown w sleep 0.5 keyup w");
  key("k");
  ASSERT_TRUE(says(program, "saved", 2));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 3));
  key("space");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  key("space");
  key("F12");
  ASSERT_TRUE(says(program, "saved", 4));
  EXPECT_FALSE(same(picture(1), picture(2))) << "the way back to the first key was not gone";
  key("space");
  std::this_thread::sleep_for(std::chrono::seconds(3));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 5));
  EXPECT_TRUE(same(picture(1), picture(3))) << "the way does not end at the last key";
  EXPECT_EQ(leave(program).code, 0);

  Program next = view();
  ASSERT_TRUE(says(next, "2 keys of a path"));
  ASSERT_TRUE(says(next, "Gaussians"));
  key("k");
  ASSERT_TRUE(says(next, "saved"));
  EXPECT_EQ(leave(next).code, 0);
  ASSERT_TRUE(good(render({"--path", out + "/cameras.json", "--keys", "-o", folder / "keys"})));
  EXPECT_TRUE(fs::exists(folder / "keys/key_002_left.png"));
}

TEST_F(ViewOnADisplay, IsResizedHiddenAndShownAgain) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F1");  // the picture takes the whole window
  hands("search --name binosplat windowsize --sync 500 300");
  key("F12");
  ASSERT_TRUE(says(program, "saved", 1));
  EXPECT_EQ(picture(1).width, 500);
  EXPECT_EQ(picture(1).height, 300);
  hands("search --name binosplat windowunmap --sync windowmap --sync");
  key("F11");
  ASSERT_TRUE(says(program, "saved", 2));
  EXPECT_NE(test::read_text(fs::path(out) / "preview_001.exr").find("right.Z"), std::string::npos);
  EXPECT_EQ(leave(program).code, 0);
}

TEST_F(ViewOnADisplay, ShowsWhatAFrameIsMadeOf) {
  Program program = view({"--tolerance", "0.5"});
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F1");  // the picture takes the whole window
  key("k");
  ASSERT_TRUE(says(program, "saved", 1));
  const std::vector<std::string> names = {"split", "difference", "disagreement", "depth", "alphas"};
  std::string before = "picture";
  for (int n = 1; n <= static_cast<int>(names.size()); ++n) {
    const std::string& name = names[static_cast<std::size_t>(n - 1)];
    key("v");
    key("F12");
    ASSERT_TRUE(says(program, "saved", n + 1));
    const auto written = [&](const std::string& show) {
      return rendered("key_000", "300x400", {"--layout", "parallel", "--tolerance", "0.5", "--show", show});
    };
    EXPECT_TRUE(same(picture(n), written(name))) << name;
    EXPECT_FALSE(same(picture(n), written(before))) << name << " is shown as " << before;
    before = name;
  }
  EXPECT_EQ(leave(program).code, 0);
}

TEST_F(ViewOnADisplay, ASavedPoseIsFoundAgain) {
  std::vector<std::string> scale = {"--units-per-metre", "2", "--ipd", "0.1"};
  Program program = view(scale);
  ASSERT_TRUE(says(program, "Gaussians"));
  hands("search --name binosplat windowfocus --sync keydown w sleep 0.5 keyup w");
  key("F9");
  ASSERT_TRUE(says(program, "saved", 1));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 2));
  EXPECT_EQ(leave(program).code, 0);

  const Outcome outcome = render({"-o", folder / "again.png", "--convergence", "inf"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.err.find("model.binosplat.json"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("pose saved there"), std::string::npos) << outcome.err;
  EXPECT_TRUE(same(picture(1), load_image(folder / "again.png")));
  ASSERT_TRUE(good(render({"-o", folder / "other.png", "--convergence", "inf", "--units-per-metre", "1"})));
  EXPECT_FALSE(same(picture(1), load_image(folder / "other.png"))) << "the saved scale changes nothing";

  Program again = view();
  ASSERT_TRUE(says(again, "Gaussians"));
  key("F12");
  ASSERT_TRUE(says(again, "saved"));
  EXPECT_EQ(leave(again).code, 0);
  EXPECT_TRUE(same(picture(1), picture(2)));
}

TEST_F(ViewOnADisplay, UpThatIsFoundIsSaved) {
  std::filesystem::remove(folder / "cameras.json");
  test::save_ply(model, test::floor_model());
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F9");
  ASSERT_TRUE(says(program, "saved", 1));
  EXPECT_EQ(leave(program).code, 0);
  const auto pose = nlohmann::json::parse(test::read_text(folder / "model.binosplat.json"))[0];
  EXPECT_NEAR(pose["up"][2].get<double>(), 1.0, 1e-3) << pose.dump();
  EXPECT_NEAR(pose["position"][2].get<double>(), 1.6, 0.1) << pose.dump();
}

TEST_F(ViewOnADisplay, AFailedLoadIsToldAndTheOldSceneStays) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 1));
  fs::rename(model, folder / "whole.ply");
  test::write_text(model, "ply\nformat ascii 1.0\n");
  key("F5");
  ASSERT_TRUE(says(program, "warning"));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 2));
  EXPECT_TRUE(same(picture(1), picture(2)));

  fs::rename(folder / "whole.ply", model);
  key("F5");
  ASSERT_TRUE(says(program, "Gaussians", 2));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 3));
  EXPECT_TRUE(same(picture(1), picture(3)));
  EXPECT_EQ(leave(program).code, 0);
}

TEST_F(ViewOnADisplay, FinerLevelsComeWhileOneLooks) {
  REQUIRE_FIXTURES(fixtures);
  const std::string scene = fixtures / "sog/st-lod";
  const auto start = [&](const std::string& to, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"view",    scene,           "-o", to, "--size",
                                          "600x400", "--convergence", "inf"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Program(arguments, {.variables = {{"DISPLAY", display}}});
  };
  Program program = start(out, {});
  ASSERT_TRUE(says(program, ": 250 Gaussians")) << "the coarsest at first";
  key("F1");
  ASSERT_TRUE(says(program, "levels of 1000 Gaussians"));
  key("F12");
  ASSERT_TRUE(says(program, "saved", 1));
  key("k");
  ASSERT_TRUE(says(program, "saved", 2));
  EXPECT_EQ(leave(program).code, 0);
  const auto drawn = [&](const std::string& level) {
    const Outcome outcome =
        test::run_program({"render", scene, "--cameras", out + "/cameras.json", "--view", "key_000", "--size",
                           "300x400", "--lod", level, "-o", folder / "level.png", "--convergence", "inf"});
    EXPECT_TRUE(good(outcome));
    return load_image(folder / "level.png");
  };
  EXPECT_TRUE(same(picture(1), drawn("0")));
  EXPECT_FALSE(same(picture(1), drawn("1")));

  Program far_away = start(folder / "far", {"--detail", "1e6"});
  ASSERT_TRUE(says(far_away, ": 250 Gaussians"));
  key("F1");
  key("F12");
  ASSERT_TRUE(says(far_away, "saved"));
  const Outcome outcome = leave(far_away);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err.find("levels of"), std::string::npos) << outcome.err;
  EXPECT_TRUE(same(load_image(folder / "far/preview_001.png"), drawn("1")));

  const test::Copy told(scene);
  test::add_level_errors(told);
  Program by_db({"view", told.path(), "-o", folder / "db", "--detail", "60dB", "--size", "600x400"},
                {.variables = {{"DISPLAY", display}}});
  ASSERT_TRUE(says(by_db, "levels of 1000 Gaussians"));
  const Outcome of_few = leave(by_db);
  EXPECT_EQ(of_few.code, 0);
  EXPECT_EQ(of_few.err.find("dB predicted"), std::string::npos) << "of so few all are shown: " << of_few.err;
}

TEST_F(ViewOnADisplay, NobodyWaitsForABigModel) {
  Program program({"view", "demo:city", "--count", "20000000", "-o", out},
                  {.variables = {{"DISPLAY", display}}});
  ASSERT_TRUE(says(program, "drawing with"));
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = leave(program);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_NE(outcome.err.find("left while demo:city was being read"), std::string::npos) << outcome.err;
}

TEST_F(ViewOnADisplay, WhatADisplayLacksIsTold) {
  const auto ends = [&](const std::string& name, const std::string& value, const std::string& layout,
                        const std::string& said) {
    const Outcome outcome = test::run_program({"view", model, "-o", out, "--layout", layout},
                                              {.variables = {{"DISPLAY", display}, {name, value}}});
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return ended(outcome, 3, said);
  };
  EXPECT_TRUE(ends("MESA_GL_VERSION_OVERRIDE", "3.3", "parallel", "`binosplat render`"));
  EXPECT_TRUE(ends("A", "b", "quad-buffer", "no stereo windows"));
}

TEST_F(ViewOnADisplay, ALostGpuEndsIt) {
  // Says that the GPU was reset once a picture has been saved; see lost_context.c.
  const std::string flag = folder / "lost";
  Program program({"view", model, "-o", out}, {.variables = {{"DISPLAY", display},
                                                             {"LD_PRELOAD", BINOSPLAT_LOST_CONTEXT},
                                                             {"LOST_CONTEXT", flag},
                                                             {"ASAN_OPTIONS", "verify_asan_link_order=0"}}});
  ASSERT_TRUE(says(program, "Gaussians"));
  key("F12");
  ASSERT_TRUE(says(program, "saved"));
  test::write_text(flag, "");
  EXPECT_TRUE(ended(ended_by("t", program), 3, "was reset"));
}

TEST_F(ViewOnADisplay, AtRestNothingIsDrawn) {
  Program program = view();
  ASSERT_TRUE(says(program, "Gaussians"));
  std::this_thread::sleep_for(std::chrono::seconds(4));
  const Outcome outcome = leave(program);
  EXPECT_EQ(outcome.code, 0);
  const std::size_t at = outcome.err.find(" frames were drawn, ");
  ASSERT_NE(at, std::string::npos) << outcome.err;
  const std::size_t line = outcome.err.rfind('\n', at) + 1;
  const std::string drawn = outcome.err.substr(outcome.err.find(' ', line) + 1);
  EXPECT_GE(std::stoi(drawn), 1);
  EXPECT_LE(std::stoi(drawn), 3) << outcome.err;
}

TEST_F(ViewOnADisplay, ABrokenModelIsTold) {
  test::write_text(folder / "broken.ply", "ply\nformat ascii 1.0\n");
  Program program({"view", folder / "broken.ply", "-o", out}, {.variables = {{"DISPLAY", display}}});
  EXPECT_TRUE(ended(program.wait(), 2, "broken.ply"));
}

}  // namespace
}  // namespace binosplat
