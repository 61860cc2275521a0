// Runs examples/openxr.cpp on the test runtime: checks its pictures, its sequence of calls, and the
// validation layer's messages.

#include <binosplat/renderer.h>
#include <gtest/gtest.h>

#include "support/caller.h"
#include "support/display.h"
#include "support/ply.h"
#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

using Strings = std::vector<std::string>;
constexpr int example_width = 96, example_height = 80;

/// Writes Gaussians around the head, few enough for llvmpipe.
void write_model(const std::filesystem::path& path) {
  PlyFile file = inria_file(1, 300);
  Uniform uniform(5);
  for (std::size_t row = 0; row < file.rows.size(); ++row) {
    for (const char* axis : {"x", "y", "z"}) file.at(row, axis) = static_cast<float>(uniform(-3, 3));
    for (const char* scale : {"scale_0", "scale_1", "scale_2"}) {
      file.at(row, scale) = static_cast<float>(uniform(-3, -1));
    }
  }
  write_text(path, to_bytes(file));
}

/// Returns a script with a moving head, whose eyes are canted and have different angles.
Json moving_script() {
  const Json left = xr_view(example_width, example_height, {-0.855, 0.646, 0.7, -0.75},
                            xr_pose({-0.0315, 0, 0}, {0, 0.04361939, 0, 0.99904822}));
  const Json right = xr_view(example_width, example_height, {-0.646, 0.8, 0.7, -0.7},
                             xr_pose({0.0315, 0, 0}, {0, -0.04361939, 0, 0.99904822}));
  return {{"frames", 3},
          {"views", {{"stereo", {left, right}}}},
          {"heads",
           {xr_pose({0, 1.6, 0}), xr_pose({0.1, 1.5, 0.2}, {0, 0.38268343, 0, 0.92387953}),
            xr_pose({0.2, 1.7, -0.1}, {0.1305262, 0, 0, 0.9914449})}}};
}

Outcome run_example(XrStage& stage, std::map<std::string, std::string> more = {}) {
  write_model(stage.folder() / "model.ply");
  more.merge(stage.variables());
  return run_program({(stage.folder() / "model.ply").string()},
                     {.variables = more, .program = BINOSPLAT_XR_EXAMPLE});
}

/// Runs the example, which must succeed without faults, and returns the runtime's log.
XrLog log_of_example(XrStage& stage) {
  const Outcome outcome = run_example(stage);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  XrLog log = stage.log();
  EXPECT_EQ(log.faults(), Strings());
  return log;
}

glm::dvec4 four(const Json& json) { return {json[0], json[1], json[2], json[3]}; }

/// Draws a frame as the example must draw it, from the views that the runtime located.
struct Expected : Caller {
  explicit Expected(const std::filesystem::path& file) : model(file), renderer(get_proc_address(), model) {}

  std::array<std::string, 2> draw(const Json& frame) {
    std::array<View, 2> views;
    for (std::size_t k = 0; k < 2; ++k) {
      const Json& located = frame["located"][k];
      const Json& at = located["pose"]["position"];
      const glm::dvec4 fov = four(located["fov"]);
      views[k].eye = {
          {at[0], at[1], at[2]}, four(located["pose"]["orientation"]), {fov[0], fov[1], fov[2], fov[3]}};
      views[k].size = {example_width, example_height};
      views[k].target.texture = texture(GL_SRGB8_ALPHA8, example_width, example_height);
    }
    Settings settings = Settings::headset();
    settings.background = glm::vec3(0.0f);
    renderer.draw(views, model.placement(), settings);
    std::array<std::string, 2> out;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto pixels = read<unsigned char>(views[k].target.texture, example_width, example_height);
      for (int row = example_height - 1; row >= 0; --row) {
        const auto begin = pixels.begin() + 4 * row * example_width;
        out[k].append(begin, begin + 4 * example_width);
      }
    }
    return out;
  }

  const SplatModel model;
  Renderer renderer;
};

// Runs the example under Khronos' validation, and compares its pictures with the expected ones.
void expect_pictures(XrStage& stage, const std::string& display = "") {
  std::map<std::string, std::string> variables = stage.validated_variables();
  variables["DISPLAY"] = display;
  const Outcome outcome = run_example(stage, variables);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(stage.validation(outcome), "");
  const XrLog log = stage.log();
  EXPECT_EQ(log.faults(), Strings());
  ASSERT_EQ(log.frames().size(), 3u);
  Expected expected(stage.folder() / "model.ply");
  for (const Json& frame : log.frames()) {
    const auto pictures = expected.draw(frame);
    ASSERT_NE(pictures[0], pictures[1]);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_TRUE(log.colours(frame, k) == pictures[k]) << "frame " << frame["frame"] << " view " << k;
      EXPECT_FALSE(log.colours(frame, k) == pictures[1 - k]) << "swapped eyes go unnoticed";
    }
  }
}

TEST(XrExample, SubmitsExpectedPictures) {
  XrStage stage;
  stage.script = moving_script();
  expect_pictures(stage);
  EXPECT_EQ(stage.log().all("session").at(0)["binding"], "EGL");
}

TEST(XrExample, TakesGlxWithoutEgl) {
  const VirtualDisplay display;
  if (display.name().empty()) GTEST_SKIP() << "Xvfb is not installed";
  XrStage stage;
  stage.script = moving_script();
  stage.script["extensions"] = {"XR_KHR_opengl_enable"};
  expect_pictures(stage, display.name());
  EXPECT_EQ(stage.log().all("session").at(0)["binding"], "GLX");
  const Outcome no_display = run_example(stage, {{"DISPLAY", ""}});
  EXPECT_EQ(no_display.code, 2);
  EXPECT_NE(no_display.err.find("need an X display"), std::string::npos) << no_display.err;
}

TEST(XrExample, AcceptsRenderOnlyTextures) {
  XrStage stage;
  stage.script = moving_script();
  const auto first_picture = [&] {
    const XrLog log = log_of_example(stage);
    return log.colours(log.frames().at(0), 0);
  };
  const std::string written = first_picture();
  stage.script["unordered_srgb"] = false;
  EXPECT_TRUE(first_picture() == written);
}

/// Returns the number of pixels that differ between two pictures.
int changed(const std::string& picture, const std::string& without) {
  int count = 0;
  for (std::size_t at = 0; at < picture.size(); at += 4)
    count += picture.compare(at, 4, without, at, 4) != 0 ? 1 : 0;
  return count;
}

TEST(XrExample, DrawsControllersAmongSplats) {
  XrStage stage;
  stage.script = {{"frames", 5}};
  const auto hold = [&](int frame, const std::array<double, 3>& left) {
    stage.add_event({{"frame", frame}, {"input", {{"/user/hand/left/input/grip/pose", xr_pose(left)}}}});
  };
  hold(1, {0, 1.6, -0.3});
  hold(2, {0.1, 1.6, -0.5});
  hold(3, {0, 1.6, -2.0});
  stage.add_event({{"frame", 4}, {"hands", {"right"}}});
  const XrLog log = log_of_example(stage);
  ASSERT_EQ(log.frames().size(), 5u);
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<std::string> pictures;
    for (const Json& frame : log.frames()) pictures.push_back(log.colours(frame, k));
    EXPECT_GT(changed(pictures[1], pictures[0]), 50) << "nothing is as near as that hand";
    EXPECT_GT(changed(pictures[2], pictures[0]), 0) << "among the splats";
    EXPECT_EQ(changed(pictures[3], pictures[0]), 0) << "a hand is seen through all splats";
    EXPECT_TRUE(pictures[4] == pictures[0]) << "a hand that is gone is drawn";
  }
}

TEST(XrExample, FollowsSession) {
  XrStage stage;
  stage.script = moving_script();
  stage.script["frames"] = 8;
  stage.add_event({{"state", "SYNCHRONIZED"}});
  stage.add_event({{"frame", 1}, {"state", "FOCUSED"}});
  stage.script["not_rendered"] = {2};
  stage.add_event({{"frame", 3}, {"flags", {"orientation_valid"}}});
  stage.add_event({{"frame", 4}, {"flags", {"orientation_valid", "position_valid"}}});
  stage.add_event({{"frame", 5}, {"state", "SYNCHRONIZED"}});
  stage.add_event({{"frame", 6}, {"state", "STOPPING"}, {"then", "ready"}});
  stage.add_event({{"frame", 7}, {"recentre", xr_pose({0, 1.6, 1})}});
  const XrLog log = log_of_example(stage);
  EXPECT_EQ(log.shown(), "-x--x-xx");
  EXPECT_EQ(log.all("begin").size(), 2u);
}

TEST(XrExample, ExitsWithRuntime) {
  for (const Json& event :
       {Json{{"frame", 1}, {"instance_loss", true}}, Json{{"frame", 1}, {"state", "LOSS_PENDING"}}}) {
    XrStage stage;
    stage.add_event(event);
    EXPECT_EQ(log_of_example(stage).frames().size(), 1u);
  }
}

TEST(XrExample, ReportsMissingFeatures) {
  const std::vector<std::pair<Json, std::string>> cases = {
      {{{"events", {{{"fail", "xrGetSystem"}, {"result", "XR_ERROR_FORM_FACTOR_UNAVAILABLE"}}}}},
       "xrGetSystem failed: XR_ERROR_FORM_FACTOR_UNAVAILABLE (-35)"},
      {{{"events", {{{"frame", 1}, {"fail", "xrWaitFrame"}, {"result", "XR_ERROR_SESSION_LOST"}}}}},
       "xrWaitFrame failed: XR_ERROR_SESSION_LOST (-17)"},
      {{{"formats", {"GL_RGBA8"}}}, "xrCreateSwapchain failed: XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED (-26)"},
      {{{"extensions", {"XR_MNDX_egl_enable"}}}, "xrCreateInstance failed: no instance (-9)"}};
  for (const auto& [script, text] : cases) {
    XrStage stage;
    stage.script = script;
    const Outcome outcome = run_example(stage);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("openxr: " + text), std::string::npos) << outcome.err;
  }
  XrStage stage;
  const Outcome no_runtime = run_example(stage, {{"XR_RUNTIME_JSON", "none.json"}});
  EXPECT_EQ(no_runtime.code, 2);
  EXPECT_EQ(no_runtime.err.find("openxr: no OpenXR runtime. Install one"), 0u) << no_runtime.err;
}

}  // namespace
}  // namespace binosplat::test
