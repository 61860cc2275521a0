// Runs `binosplat view --xr` on the test runtime: the submitted pictures equal those of a render::Frame, bit
// for bit.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "adagscale/calibrated_threshold.h"
#include "adagscale/calibration_file.h"
#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "lab/trace_rules.h"
#include "measure/metrics.h"
#include "stereo/drawing.h"
#include "stereo/eyes.h"
#include "support/calibration.h"
#include "support/display.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/scenes.h"
#include "xr/projection_layer.h"
#include "xr/walk.h"
#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

using Strings = std::vector<std::string>;

constexpr int view_width = 96, view_height = 80;  // a view's default size in the runtime
constexpr std::array<double, 4> left_fov = {-0.855, 0.646, 0.7, -0.7}, right_fov = {-0.646, 0.855, 0.7, -0.7};

glm::dvec4 turned(double degrees) {  // rotated to the left
  const double half = 0.5 * glm::radians(degrees);
  return {0.0, std::sin(half), 0.0, std::cos(half)};
}

Json head(const glm::dvec3& p, double degrees = 0.0) {
  const glm::dvec4 q = turned(degrees);
  return xr_pose({p.x, p.y, p.z}, {q.x, q.y, q.z, q.w});
}

struct XrView : testing::Test {
  TempFolder folder;
  std::string file = (folder / "model.ply").string();
  Model model;
  XrStage stage;

  XrView() {
    OutputFile written(file);
    write_model(written, random_model(5, 300, 1), ModelFormat::ply);
    written.commit();
    model = load_model(file);
    stage.script = {{"frames", 2}};
  }

  Strings plain_words = {"view",   file,   "--xr",  "--no-mirror", "--eye",
                         "0,0,-1", "--at", "0,0,1", "--up",        "0,-1,0"};

  Outcome view(const Strings& more = {}, const std::map<std::string, std::string>& variables = {}) {
    Strings words = plain_words;
    words.insert(words.end(), more.begin(), more.end());
    std::map<std::string, std::string> all = stage.variables();
    for (const auto& [name, value] : variables) all[name] = value;
    return run_program(words, {.folder = folder.path(), .variables = all});
  }

  /// Runs the program, which must succeed without faults, and returns the runtime's log.
  XrLog run(const Strings& more = {}) {
    const Outcome outcome = view(more);
    said = outcome.err;
    EXPECT_EQ(outcome.code, 0) << said;
    XrLog log = stage.log();
    EXPECT_EQ(log.faults(), Strings());
    return log;
  }

  std::string said;  // the program's output in run()

  /// Returns the located views of a frame's line, and the sizes of their pictures.
  static std::pair<std::vector<Eye>, std::vector<glm::ivec2>> views_of(const Json& frame) {
    const Json& located = frame["located"];
    std::vector<Eye> eyes;
    std::vector<glm::ivec2> sizes;
    for (std::size_t k = 0; k < located.size(); ++k) {
      const auto p = located[k]["pose"]["position"].get<std::array<float, 3>>();
      const auto q = located[k]["pose"]["orientation"].get<std::array<float, 4>>();
      const auto f = located[k]["fov"].get<std::array<float, 4>>();
      eyes.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}, {f[0], f[1], f[2], f[3]}});
      const auto rect = XrLog::view(frame, k)["rect"].get<std::array<int, 4>>();
      sizes.emplace_back(rect[2], rect[3]);
    }
    return {eyes, sizes};
  }

  /// Returns the expected pictures of this frame's line, for a placement in the world. Without an order and a
  /// projection, they are those of a headset.
  std::vector<Picture> expected(const Json& frame, const Placement& at,
                                render::FrameSettings settings = {{.depth = DepthKind::median}}) const {
    const auto [eyes, sizes] = views_of(frame);
    if (!settings.order && !settings.projection) {
      settings.order = Settings::headset().order;
      settings.projection = Settings::headset().projection;
    }
    render::Frame drawn(gl_context(), model);
    drawn.draw(stereo::views_from_xr(eyes, at, sizes), settings);
    return drawn.read_pictures();
  }

  /// Returns the program's first placement. The script's stage is a floor by default.
  static Placement start(bool on_floor = true) {
    return xr::start_of(xr::upright_at({0, 0, -1}, glm::dmat3(1.0), {0, -1, 0}, 1.0), on_floor);
  }
};

std::string bytes_of(const Picture& picture) {
  const Image image = quantised(on_black(picture));
  std::string bytes;
  for (std::size_t k = 0; k < image.data.size(); ++k) {
    bytes += static_cast<char>(std::lround(255.0f * image.data[k]));
    if (k % 3 == 2) bytes += static_cast<char>(255);
  }
  return bytes;
}

Image image_of(const std::string& bytes) {
  Image image(view_width, view_height, 3);
  for (std::size_t p = 0; p < image.data.size(); ++p)
    image.data[p] = static_cast<unsigned char>(bytes[p / 3 * 4 + p % 3]) / 255.0f;
  return image;
}

TEST_F(XrView, EqualsFrame) {
  const std::array<double, 4> up_fov = {-0.6, 0.5, 0.4, -0.8};
  const struct {
    const char* name;
    Json views, heads;
  } cases[] = {
      {"moving", {}, {head({0, 1.6, 0}), head({0.1, 1.5, -0.2}, 20)}},
      {"canted",
       {xr_view(view_width, view_height, left_fov, head({-0.03, 0, 0}, 8)),
        xr_view(view_width, view_height, right_fov, head({0.03, 0, 0}, -8))},
       {head({0, 1.6, 0}), head({0, 1.6, 0.1}, 5)}},
      {"of two sizes, asymmetric",
       {xr_view(64, 72, up_fov, head({-0.03, 0.01, 0})), xr_view(88, 56, right_fov, head({0.03, 0.01, 0}))},
       {head({0, 1.6, 0}), head({0.2, 1.6, 0})}},
  };
  for (const auto& test : cases) {
    stage.script = {{"frames", 2}, {"heads", test.heads}};
    if (!test.views.empty()) stage.script["views"]["stereo"] = test.views;
    const XrLog log = run();
    ASSERT_EQ(log.frames().size(), 2u);
    for (const Json& frame : log.frames()) {
      const std::vector<Picture> pictures = expected(frame, start());
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_TRUE(log.colours(frame, k) == bytes_of(pictures[k])) << test.name << " eye " << k;
        if (pictures[0].colour.size() == pictures[1].colour.size()) {
          EXPECT_TRUE(log.colours(frame, k) != bytes_of(pictures[1 - k])) << "swapped eyes go unnoticed";
        }
      }
    }
    EXPECT_TRUE(log.colours(log.frames().at(0), 0) != log.colours(log.frames().at(1), 0)) << test.name;
  }
}

// EqualsFrame and others draw by distance and tangent without these options.
TEST_F(XrView, OptionOrModelOverridesHeadsetOrder) {
  const auto shows = [&](const Strings& more, Order order, Projection projection) {
    const XrLog log = run(more);
    const Json frame = log.frames().at(0);
    const render::FrameSettings settings{{.order = order, .projection = projection}};
    return log.colours(frame, 0) == bytes_of(expected(frame, start(), settings)[0]);
  };
  const char* const line = "splats do not turn with the head";
  EXPECT_TRUE(shows({}, Order::distance, Projection::tangent));
  EXPECT_NE(said.find(line), std::string::npos) << said;
  EXPECT_FALSE(shows({}, Order::depth, Projection::affine)) << "an order goes unnoticed";
  EXPECT_TRUE(shows({"--order", "depth"}, Order::depth, Projection::affine));
  EXPECT_EQ(said.find(line), std::string::npos) << said;
  EXPECT_TRUE(shows({"--projection", "tangent"}, Order::depth, Projection::tangent));
  model.perspective = {Order::distance, Projection::affine};
  OutputFile written(file);
  write_model(written, model, ModelFormat::ply);
  written.commit();
  EXPECT_TRUE(shows({}, Order::distance, Projection::affine)) << "the file's";
  EXPECT_EQ(said.find(line), std::string::npos) << said;
}

// A compositor blends in linear light. So the stored colours are those of the model, over the room.
TEST_F(XrView, PassthroughShowsRoomAroundModel) {
  stage.script["frames"] = 1;
  for (const bool in_place : {true, false}) {
    stage.script["unordered_srgb"] = in_place;
    stage.script["blend_modes"] = {"OPAQUE", "ADDITIVE", "ALPHA_BLEND"};
    const XrLog log = run({"--passthrough"});
    const Json frame = log.frames().at(0);
    EXPECT_EQ(frame["blend_mode"], "ALPHA_BLEND");
    EXPECT_EQ(frame["layers"][0]["flags"], XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT);
    const std::string stored = log.colours(frame, 0);
    const Picture picture = expected(frame, start())[0];
    const auto stored_at = [&](std::size_t at) { return static_cast<unsigned char>(stored[at]) / 255.0; };
    int rooms = 0, wrong = 0, as_shown = 0,
        straight = 0;  // pixels without a splat; channels of other conventions
    for (std::size_t p = 0; p < picture.colour.size(); ++p) {
      const double alpha = 1.0 - picture.colour[p].a;
      rooms += stored.compare(4 * p, 4, std::string(4, '\0')) == 0 ? 1 : 0;
      EXPECT_NEAR(stored_at(4 * p + 3), alpha, 0.6 / 255.0);
      for (int c = 0; alpha > 0.0 && c < 3; ++c) {
        const double colour = picture.colour[p][c] / alpha;
        const auto differs = [&, at = 4 * p + static_cast<std::size_t>(c)](double wanted) {
          return std::abs(stored_at(at) - std::min(wanted, 1.0)) > 0.7 / 255.0 ? 1 : 0;
        };
        wrong += differs(linear_to_srgb(alpha * srgb_to_linear(colour)));
        as_shown += differs(picture.colour[p][c]);
        straight += differs(colour);
      }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(rooms, 100) << "the model has no end";
    EXPECT_GT(as_shown, 100) << "display values premultiplied by alpha go unnoticed";
    EXPECT_GT(straight, 100) << "colours without alpha go unnoticed";
  }
  EXPECT_EQ(run().frames().at(0)["blend_mode"], "OPAQUE");
  stage.script["blend_modes"] = {"OPAQUE", "ADDITIVE"};
  EXPECT_EQ(run({"--passthrough"}).frames().at(0)["blend_mode"], "ADDITIVE");
}

TEST_F(XrView, SubmitsMedianDepth) {
  const XrLog log = run({"--scale", "2"});
  const Json frame = log.frames().at(0);
  const std::vector<Picture> median = expected(frame, start());
  const std::vector<Picture> mean = expected(frame, start(), {});
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& info = XrLog::view(frame, k)["depth"];
    const double near = info["near"], far = info["far"];
    EXPECT_EQ(near, static_cast<double>(static_cast<float>(near_default)));
    const std::vector<float> depths = log.depths(frame, k);
    // The sides of the depths are an eighth of the picture's. Each depth is that of the pixel in the middle
    // of 8 x 8 px.
    ASSERT_EQ(depths.size(), (view_width / 4u) * (view_height / 4u));
    const auto differing = [&](const Picture& picture, int x = 4) {
      int count = 0;
      for (std::size_t p = 0; p < depths.size(); ++p) {
        const std::size_t from = (p / 24 * 8 + 4) * 2 * view_width + p % 24 * 8 + static_cast<std::size_t>(x);
        const double cover = 1.0 - picture.colour[from].a;
        const double z = cover > 0.5 ? picture.z_sum[from] / cover : far;
        const double expected = std::clamp(far / (far - near) * (1.0 - near / z), 0.0, 1.0);
        count += std::abs(expected - depths[p]) > 2e-6 ? 1 : 0;
      }
      return count;
    };
    EXPECT_EQ(differing(median[k]), 0) << k;
    EXPECT_GT(differing(mean[k]), 20) << "the mean goes unnoticed";
    EXPECT_GT(differing(median[1 - k]), 20) << "the other eye's go unnoticed";
    EXPECT_GT(differing(median[k], 0), 20) << "another pixel's go unnoticed";
  }
}

TEST_F(XrView, RecordsFramesAndMissedDisplays) {
  stage.script = {{"frames", 12}, {"late", {5}}, {"not_rendered", {8}}, {"pixels", Json::array()}};
  run({"--record", "60"});
  const std::filesystem::path recorded = folder.path() / "out" / folder.path().filename() / "profile_001";
  ASSERT_TRUE(std::filesystem::exists(recorded / "report.html")) << said;
  EXPECT_NE(said.find("frames of 2 x 96 x 80 px"), std::string::npos) << said;
  const lab::Table frames = frames_of(read_text(recorded / "frames.csv"));
  const auto column = [&](const std::string& name) {
    const auto at = std::ranges::find(frames.columns, name) - frames.columns.begin();
    std::vector<double> numbers;
    for (const auto& row : frames.rows) numbers.push_back(row[static_cast<std::size_t>(at)].get<double>());
    return numbers;
  };
  // The first frame begins the recording. The ninth frame must not be drawn.
  ASSERT_EQ(frames.rows.size(), 10u);
  EXPECT_EQ(column("displays_missed"), (std::vector<double>{0, 0, 0, 0, 1, 0, 0, 0, 0, 0}));
  EXPECT_NEAR(column("display_ms")[0], 11.1, 0.1);
  EXPECT_NEAR(column("display_ms")[4], 6 * 11.1, 0.1) << "a period later than the fifth would be";
  const Json trace = Json::parse(read_text(recorded / "trace.json"));
  EXPECT_EQ(faults_of_trace(trace), Strings());
  EXPECT_EQ(differences_of(trace, frames), Strings());
}

// The program ends the runtime's session properly, and reports the number of drawn frames.
TEST_F(XrView, SignalEndsSession) {
  stage.script = {{"frames", 1000000}, {"sleep", true}, {"pixels", Json::array()}};
  Program program(plain_words, {.variables = stage.variables()});
  wait_until([&] { return program.said().find("FOCUSED") != std::string::npos; });
  program.send(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("frames were drawn"), std::string::npos) << outcome.err;
  EXPECT_EQ(stage.log().faults(), Strings());
  const auto states = stage.log().all("state");
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.back()["state"], "XR_SESSION_STATE_EXITING");
}

// Every way of writing into a texture gives the same pictures.
TEST_F(XrView, WritesIntoEveryTextureFormat) {
  const auto first_picture = [&] {
    const XrLog log = run();
    return log.colours(log.frames().at(0), 0);
  };
  const std::string srgb = first_picture();
  for (const char* other : {"immutable", "unordered_srgb"}) {
    stage.script = {{"frames", 1}, {other, false}};
    EXPECT_TRUE(first_picture() == srgb) << other;
  }
}

// The runtime detects faults in frames: here it injects them itself.
TEST_F(XrView, TestRuntimeDetectsFaultsItInjects) {
  const std::pair<const char*, const char*> faults[] = {
      {"pose", "view 0 has another pose"},
      {"fov", "view 1 has another fov"},
      {"eyes", "view 1 has another pose"},
      {"depths", "has the depths of another one"},
      {"planes", "planes that bound nothing"},
      {"rectangle", "a rectangle beyond its swapchain"},
      {"stale", "an image of another frame"},
      {"written", "written to after its release"},
      {"wait", "was not waited for"},
      {"release", "an image was not released"},
      {"begin", "xrBeginFrame is expected"},
      {"time", "another display time"},
      {"binding", "has no /user/hand/left/input/grip/poses"},
      {"space", "XR_OBJECT_TYPE_SPACE was not destroyed before its parent"},
      {"instance", "XR_OBJECT_TYPE_INSTANCE was never destroyed"},
  };
  for (const auto& [injected, text] : faults) {
    stage.script = {{"frames", 3}, {"inject", injected}};
    view();
    const Strings found = stage.log().faults();
    bool is_seen = false;
    for (const std::string& fault : found) is_seen = is_seen || fault.find(text) != std::string::npos;
    EXPECT_TRUE(is_seen) << injected << testing::PrintToString(found);
  }
}

TEST_F(XrView, FollowsSessionAndHead) {
  stage.script = {{"frames", 8}, {"spaces", {"local"}}, {"not_rendered", {1}}};
  stage.add_event({{"frame", 2}, {"state", "SYNCHRONIZED"}});
  stage.add_event({{"frame", 3}, {"state", "FOCUSED"}});
  stage.add_event({{"frame", 4}, {"flags", {"position_valid"}}});
  stage.add_event({{"frame", 5}, {"flags", {"orientation_valid"}}});
  stage.add_event({{"frame", 6}, {"flags", {"position_valid", "orientation_valid"}}});
  stage.add_event({{"frame", 7}, {"recentre", head({0.3, 1.6, 0.2}, 15)}});
  const XrLog log = run();
  EXPECT_EQ(log.shown(), "x--x--xx") << "what nobody sees, or from where nobody knows, is drawn";
  EXPECT_NE(said.find("not tracked"), std::string::npos) << said;
  const Placement no_floor = start(false);
  for (const std::size_t k : {0, 3, 6, 7}) {
    const Json frame = log.frames().at(k);
    EXPECT_TRUE(log.colours(frame, 0) == bytes_of(expected(frame, no_floor)[0])) << k;
  }
  EXPECT_TRUE(log.colours(log.frames().at(6), 0) != log.colours(log.frames().at(7), 0));
}

// Wherever a session is lost, no object remains.
TEST_F(XrView, SurvivesLostSessionOnly) {
  std::vector<Json> losses = {{{"frame", 1}, {"state", "LOSS_PENDING"}}};
  for (const char* call : {"xrCreateActionSet", "xrAttachSessionActionSets", "xrCreateSwapchain"})
    losses.push_back({{"fail", call}, {"result", "XR_ERROR_SESSION_LOST"}, {"times", 1}});
  losses.push_back({{"frame", 1}, {"fail", "xrEndFrame"}, {"result", "XR_ERROR_SESSION_LOST"}, {"times", 1}});
  for (const Json& loss : losses) {
    stage.script = {{"frames", 4}, {"events", {loss}}};
    const Outcome again = view();
    EXPECT_EQ(again.code, 0) << loss << again.err;
    EXPECT_EQ(stage.log().faults(), Strings()) << loss;
    EXPECT_EQ(stage.log().all("session").size(), 2u) << loss;
    EXPECT_NE(again.err.find("lost the session"), std::string::npos) << again.err;
  }
  stage.script = {{"events", {{{"frame", 1}, {"instance_loss", true}}}}};
  const Outcome ended = view();
  EXPECT_EQ(ended.code, 3);
  EXPECT_NE(ended.err.find("has ended"), std::string::npos) << ended.err;
  EXPECT_EQ(stage.log().faults(), Strings());
}

TEST_F(XrView, UsesCalibration) {
  adagscale::ThresholdCalibration calibration = sample_calibration();
  calibration.gaussians = model.count();
  calibration.hash = adagscale::model_hash(model);
  calibration.perspective = {};
  calibration.focal = 60.0;
  calibration.depth_table = {8.0f, {1.0f, 0.5f, 0.25f, 0.125f}};
  calibration.views = {{"a", {0, 0, 0}}};
  calibration.entries = {{Threshold::adagscale, Transmittance::depth, 3.0}};
  const std::string path = folder / "c.json";
  write_text(path, json_of(calibration).dump());
  const XrLog log = run({"--threshold", "adagscale", "--calibration", path});
  const Json frame = log.frames().at(0);
  const auto [eyes, sizes] = views_of(frame);
  const shared::View left = stereo::views_from_xr(eyes, start(), sizes).front();
  const render::FrameSettings asked{{.threshold = Threshold::adagscale,
                                     .transmittance = Transmittance::depth,
                                     .order = Order::depth,  // a calibration keeps the model's
                                     .projection = Projection::affine,
                                     .depth = DepthKind::median}};
  const adagscale::CalibratedThreshold calibrated(path, calibration);
  EXPECT_EQ(log.colours(frame, 0),
            bytes_of(expected(frame, start(), calibrated.settings(asked, left, model.axes))[0]));
  EXPECT_NE(log.colours(frame, 0), bytes_of(expected(frame, start(), {{.order = Order::depth}})[0]))
      << "it leaves nothing out";
  // Without a calibration, the table is measured from the cameras.
  EXPECT_NE(run({"--threshold", "adagscale", "--tolerance", "3"}).colours(frame, 0),
            bytes_of(expected(frame, start())[0]));
}

TEST_F(XrView, StageSpaceStartsAtHead) {
  const auto first_picture = [&](const Json& where) {
    stage.script = {{"frames", 1}, {"spaces", {"local", "stage"}}, {"heads", {where}}};
    const XrLog log = run();
    return image_of(log.colours(log.frames().at(0), 0));
  };
  const Image there = first_picture(head({0.7, 1.6, -0.4}, 30));
  EXPECT_GT(measure::psnr(there, first_picture(head({0, 1.6, 0}))), 40.0);
}

TEST_F(XrView, ControllersMoveAndTurn) {
  stage.script = {
      {"frames", 4}, {"profile", "/interaction_profiles/oculus/touch_controller"}, {"period", 100000000}};
  stage.add_event({{"frame", 1}, {"input", {{"/user/hand/left/input/thumbstick", {0.0, 1.0}}}}});
  stage.add_event({{"frame", 2},
                   {"input",
                    {{"/user/hand/left/input/thumbstick", {0.0, 0.0}},
                     {"/user/hand/right/input/thumbstick", {1.0, 0.0}}}}});
  stage.add_event({{"frame", 3}, {"input", {{"/user/hand/left/input/menu/click", true}}}});
  const XrLog log = run();
  xr::Walk walk(start());
  const Eye eyes = {.position = {0, 1.6, 0}};
  std::array<xr::Hand, 2> hands;
  const auto shown = [&](std::size_t frame) {
    return log.colours(log.frames().at(frame), 0) ==
           bytes_of(expected(log.frames().at(frame), walk.placement())[0]);
  };
  EXPECT_TRUE(shown(0));
  hands[0].stick = {0, 1};
  EXPECT_FALSE(shown(1)) << "a walk goes unnoticed";
  walk.step(eyes, hands, 0.1);
  EXPECT_TRUE(shown(1));
  hands[0].stick = {0, 0};
  hands[1].stick = {1, 0};
  walk.step(eyes, hands, 0.1);
  EXPECT_TRUE(shown(2));
  walk.reset();
  hands[1].stick = {1, 0};
  EXPECT_TRUE(shown(3)) << "the menu button resets";
}

TEST_F(XrView, FourViewsShareOrder) {
  const Json middle = head({0, 1.6, 0});
  const auto eye = [](double x) { return head({x, 0, 0}); };
  const std::array<double, 4> inset = {-0.2, 0.25, 0.2, -0.2};
  stage.script = {{"frames", 2}, {"heads", {middle}}};
  stage.script["views"]["quad"] = {xr_view(48, 40, left_fov, eye(-0.03)),
                                   xr_view(48, 40, right_fov, eye(0.03)), xr_view(64, 56, inset, eye(-0.03)),
                                   xr_view(64, 56, inset, eye(0.03))};
  const XrLog log = run();
  const Json frame = log.frames().at(0);
  ASSERT_EQ(frame["layers"][0]["views"].size(), 4u);
  // The wide views show the inset's part of the picture in fewer pixels.
  const double wide = 48.0 / (std::tan(0.646) + std::tan(0.855)),
               fine = 64.0 / (std::tan(0.25) + std::tan(0.2));
  const render::ViewRegion fewer = {{.low_pass_share = static_cast<float>(wide * wide / (fine * fine))}};
  const std::vector<Picture> pictures = expected(frame, start(), {.regions = {fewer, fewer, {}, {}}});
  for (std::size_t k = 2; k < 4; ++k) EXPECT_TRUE(log.colours(frame, k) == bytes_of(pictures[k])) << k;
  for (std::size_t k = 0; k < 2; ++k) {
    // The pixels under the inset need not be drawn. All others must be.
    const std::string shown = log.colours(frame, k), whole = bytes_of(pictures[k]);
    int differ_outside = 0;
    for (int p = 0; p < 48 * 40; ++p) {
      const bool outside = p % 48 < 8 || p % 48 >= 40 || p / 48 < 8 || p / 48 >= 32;
      if (outside && std::memcmp(&shown[4 * p], &whole[4 * p], 4) != 0) ++differ_outside;
    }
    EXPECT_EQ(differ_outside, 0) << k;
  }
  EXPECT_NE(said.find("48 x 40, 48 x 40, 64 x 56, 64 x 56 px"), std::string::npos) << said;
  const std::string before = log.colours(frame, 0);
  run({"--quality", "40"});  // one tolerance for contexts and insets
  const XrLog looser = run({"--threshold", "squared", "--tolerance", "0.5"});
  const Json first = looser.frames().at(0);
  for (std::size_t k = 2; k < 4; ++k)
    EXPECT_TRUE(looser.colours(first, k) == bytes_of(pictures[k])) << "exact";
  EXPECT_TRUE(looser.colours(first, 0) != before) << "a tolerance goes unnoticed";
}

TEST_F(XrView, FoveatesAtGaze) {
  stage.script = {{"frames", 3}};
  stage.add_event({{"frame", 2}, {"input", {{"/user/eyes_ext/input/gaze_ext/pose", head({0, 1.6, 0}, 12)}}}});
  const XrLog log = run({"--foveate", "inset=25deg,context=0.5"});
  stereo::Drawing foveated(std::make_shared<render::GpuModel>(gl_context(), model));
  const auto shown = [&](std::size_t frame, const std::vector<glm::dvec2>& gaze) {
    const auto [views, sizes] = views_of(log.frames().at(frame));
    const Foveation foveation{.inset_degrees = 25.0, .context_scale = 0.5, .gaze = gaze};
    Settings settings = Settings::headset();
    settings.foveation = foveation;
    foveated.draw(stereo::views_from_xr(views, start(), sizes), {settings});
    const std::vector<Picture> pictures = foveated.read_pictures();
    return log.colours(log.frames().at(frame), 0) == bytes_of(pictures[0]) &&
           log.colours(log.frames().at(frame), 1) == bytes_of(pictures[1]);
  };
  EXPECT_TRUE(shown(0, {}));
  EXPECT_TRUE(shown(2, {{-12.0, 0.0}, {-12.0, 0.0}})) << "to the left";
  EXPECT_FALSE(shown(2, {})) << "a gaze goes unnoticed";
  EXPECT_TRUE(XrLog::view(log.frames().at(0), 0)["depth"].is_null()) << "none goes with composed pictures";
}

TEST_F(XrView, SkipsHiddenLensArea) {
  // A triangle that hides the tiles at the upper right corner, in the left eye only, from the second frame
  // on.
  const Json triangle = {{"vertices", {{-2.0, -2.0}, {-2.0, 2.0}, {1.6, -2.0}}}, {"indices", {0, 1, 2}}};
  stage.add_event({{"frame", 1}, {"masks", {triangle}}});
  const XrLog log = run();
  EXPECT_TRUE(log.colours(log.frames().at(0), 0) == bytes_of(expected(log.frames().at(0), start())[0]));
  const Json frame = log.frames().at(1);
  const xr::Mask mask = {{{-2.0f, -2.0f}, {-2.0f, 2.0f}, {1.6f, -2.0f}}, {0, 1, 2}};
  render::ViewRegion seen;
  seen.columns = xr::visible_columns(mask, views_of(frame).first[0].fov, {view_width, view_height});
  const std::vector<Picture> pictures = expected(frame, start(), {.regions = {seen, {}}});
  for (std::size_t k = 0; k < 2; ++k) EXPECT_TRUE(log.colours(frame, k) == bytes_of(pictures[k])) << k;
  EXPECT_TRUE(log.colours(frame, 0) != bytes_of(expected(frame, start())[0])) << "masks go unnoticed";
}

TEST_F(XrView, StreamsLevelsOfDetail) {
  const std::string levels = (folder / "levels").string();
  ASSERT_EQ(run_program({"levels", file, "-o", levels, "--chunk", "64", "--levels", "3"}).code, 0);
  stage.script = {{"frames", 60}, {"sleep", true}, {"pixels", {59}}};
  plain_words[1] = levels;
  std::vector<Strings> options = {{"--quality", "45"}};
  if (switched_on("BINOSPLAT_LONG")) options.emplace_back();
  for (const Strings& more : options) {
    const XrLog log = run(more);
    const std::string begun = said.substr(0, said.find(" Gaussians"));
    EXPECT_LT(std::stoi(begun.substr(begun.rfind(' ') + 1)), 100) << "of 300 the coarsest levels come first";
    const Json last = log.frames().at(59);
    const Image finest = image_of(bytes_of(expected(last, start())[0]));
    EXPECT_GT(measure::psnr(image_of(log.colours(last, 0)), finest), 38.0) << "22 dB: as it began";
  }
}

TEST_F(XrView, AppliesScaleAndFrameBudget) {
  stage.script["frames"] = 3;
  const XrLog log = run({"--scale", "0.5", "--frame-budget", "0.001"});
  EXPECT_EQ(log.all("swapchain").at(0)["width"], view_width / 2);
  EXPECT_EQ(XrLog::view(log.frames().at(0), 0)["rect"], Json({0, 0, view_width / 2, view_height / 2}));
}

TEST_F(XrView, ReportsMissingFeaturesInOneLine) {
  const auto ends = [&](const Outcome& outcome, int code, const char* with) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(with), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  write_text(folder / "libopenxr_loader.so.1", "no library");
  ends(view({}, {{"LD_LIBRARY_PATH", folder.path().string()}}), 3, "apt install libopenxr-loader1");
  ends(view({}, {{"XR_RUNTIME_JSON", (folder / "none.json").string()}}), 3, "no OpenXR runtime");
  const auto failing = [](const char* with) { return Json{{{"fail", "xrGetSystem"}, {"result", with}}}; };
  const std::pair<Json, const char*> scripts[] = {
      {{{"events", failing("XR_ERROR_FORM_FACTOR_UNAVAILABLE")}}, "has no headset"},
      {{{"events", failing("XR_ERROR_INSTANCE_LOST")}}, "runtime ended"},
      {{{"extensions", {"XR_KHR_composition_layer_depth"}}}, "takes no OpenGL"}};
  for (const auto& [script, said] : scripts) {
    stage.script = script;
    ends(view(), 3, said);
  }
  stage.script = {{"frames", 1}};
  ends(view({"--passthrough"}), 3, "expected OpenXR's blend mode ALPHA_BLEND or ADDITIVE");
  ends(view({"--passthrough", "--background", "1,1,1"}), 2, "the room is behind the model");
  ends(run_program({"view", file, "--passthrough"}), 2, "needs --xr");
  stage.script = {{"extensions", {"XR_KHR_opengl_enable"}}};
  const Outcome no_display = view({}, {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}});
  EXPECT_EQ(no_display.code, 3);
  EXPECT_NE(no_display.err.find("contexts of GLX only, which need an X display"), std::string::npos)
      << no_display.err;
  stage.script = {{"formats", {"GL_RGBA8"}}};
  const Outcome no_srgb = view();
  EXPECT_EQ(no_srgb.code, 3);
  EXPECT_NE(no_srgb.err.find("offers no textures"), std::string::npos) << no_srgb.err;
  for (const Strings& wrong : {Strings{"--layout", "anaglyph"}, {"--size", "640x400"}, {"--ipd", "0.06"}})
    ends(view(wrong), 2, "the headset determines it");
  ends(view({"--tiles", "snug"}), 2, "headsets use the tile test ellipse");
  ends(view({"--frame-budget", "5", "--quality", "40"}), 2, "the budget chooses it");
  ends(view({"--frame-budget", "-1"}), 2, "milliseconds");
  ends(run_program({"view", file, "--scale", "2"}), 2, "needs --xr");
}

// Under Khronos' validation, with a window that shows the left eye and without, by contexts of EGL (Monado)
// and of GLX (SteamVR).
TEST_F(XrView, BindingsOfEglAndGlxDrawEqualPictures) {
  const VirtualDisplay display;
  if (display.name().empty()) GTEST_SKIP() << "Xvfb is not installed";
  for (const char* const binding : {"EGL", "GLX"}) {
    // The extensions that the validation in Debian 12 knows.
    stage.script["extensions"] = {"XR_KHR_opengl_enable", "XR_KHR_composition_layer_depth",
                                  "XR_KHR_visibility_mask", "XR_EXT_eye_gaze_interaction"};
    if (binding == std::string("EGL")) stage.script["extensions"].push_back("XR_MNDX_egl_enable");
    for (const bool mirrors : {true, false}) {
      std::map<std::string, std::string> variables = stage.validated_variables();
      variables["DISPLAY"] = display.name();
      variables["ASAN_OPTIONS"] = "detect_leaks=0";  // the layers are unloaded: leak reports cannot name them
      Strings words = plain_words;
      if (mirrors) std::erase(words, "--no-mirror");
      const Outcome outcome = run_program(words, {.variables = variables});
      ASSERT_EQ(outcome.code, 0) << binding << outcome.err;
      const XrLog log = stage.log();
      EXPECT_EQ(log.faults(), Strings()) << binding;
      EXPECT_EQ(log.all("session").at(0)["binding"], binding);
      for (const Json& frame : log.frames()) {
        const std::vector<Picture> pictures = expected(frame, start());
        for (std::size_t k = 0; k < 2; ++k) {
          EXPECT_TRUE(log.colours(frame, k) == bytes_of(pictures[k])) << binding << " eye " << k;
          EXPECT_FALSE(log.colours(frame, k) == bytes_of(pictures[1 - k])) << "swapped eyes go unnoticed";
        }
      }
      EXPECT_EQ(stage.validation(outcome), "") << "apt install openxr-layer-corevalidation";
    }
  }
}

// SteamVR is reported to fail here (SteamVR-for-Linux issue 782).
TEST_F(XrView, ReportsGlxRuntimeWithoutTextures) {
  const VirtualDisplay display;
  if (display.name().empty()) GTEST_SKIP() << "Xvfb is not installed";
  stage.script = {{"extensions", {"XR_KHR_opengl_enable"}},
                  {"events", {{{"fail", "xrCreateSwapchain"}, {"result", "XR_ERROR_RUNTIME_FAILURE"}}}}};
  const Outcome outcome = view({}, {{"DISPLAY", display.name()}});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("reported of SteamVR on Linux"), std::string::npos) << outcome.err;
}

// SteamVR leaves errors behind in xrEndFrame (SteamVR-for-Linux issue 799).
TEST_F(XrView, IgnoresErrorsThatRuntimeLeaves) {
  stage.script["leaves_error"] = true;
  run();
  EXPECT_EQ(said.find("OpenGL error"), std::string::npos) << said;
}

}  // namespace
}  // namespace binosplat::test
