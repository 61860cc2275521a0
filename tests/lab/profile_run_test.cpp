// Frames drawn for a profile: report and trace name the events that are injected in them.

#include "lab/profile_run.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "lab/trace_rules.h"
#include "stereo/rig.h"
#include "stream/stream_levels.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using nlohmann::json;

std::vector<shared::View> pair_at(double z, int width, int height) {
  Camera camera = test::front_camera(width, height, width);
  camera.position.z = z;
  const auto views = stereo::make_rig(camera, {}).views;
  return {views.begin(), views.end()};
}

struct Drawn {
  Profile profile;
  json trace;

  Drawn(render::Recording recording) {
    profile.recording = std::move(recording);
    profile.facts.is_software = true;
    trace = test::trace_of(profile);
  }

  /// Returns whether report and trace name an event in this frame.
  bool names(std::size_t n, const std::string& event) const {
    const std::string reason = reason_of(profile, summary_of(profile), n);
    const double begin = std::chrono::duration<double, std::micro>(profile.recording.frames[n].begin -
                                                                   profile.recording.frames[0].begin)
                             .count();
    double first = -1.0;
    bool is_in_trace = false;
    for (const json& one : trace["traceEvents"]) {
      if (one["tid"] != 2 || !one.contains("ts")) continue;
      const double at = one["ts"];
      if (one["name"] == "frame" && one["args"]["frame"] == 0) first = at;
      if (one["ph"] == "i" && one["name"] == event && std::abs(at - first - begin) < 1.0) is_in_trace = true;
    }
    return reason.find(event) != std::string::npos && is_in_trace;
  }
};

TEST(ProfileInput, ReportsRedrawnAndCompilingFrames) {
  Model model;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.1 * i;
    test::add(model, {std::cos(angle), std::sin(angle), 4.0 + 0.001 * i}, glm::vec3(1.5f), 0.1f);
  }
  gl::Context& context = test::gl_context();
  constexpr int width = 512, height = 256;
  ProfileInput run;
  for (int n = 0; n < 6; ++n) run.frames.push_back(pair_at(n == 3 ? 0.0 : -400.0, width, height));
  ProfileDrawer drawer(std::make_shared<render::GpuModel>(context, model), run, nullptr);
  drawer.warm_up();
  const Drawn drawn(drawer.record([&](std::size_t done) {
    if (done == 1) context.set_shader_folder({});  // discards all programs
  }));
  EXPECT_EQ(test::faults_of_trace(drawn.trace), std::vector<std::string>());
  EXPECT_EQ(test::differences_of(drawn.trace, frames_table(drawn.profile.recording)),
            std::vector<std::string>());
  EXPECT_TRUE(drawn.names(1, "program compiled"));
  EXPECT_NE(reason_of(drawn.profile, summary_of(drawn.profile), 1).find("blend"), std::string::npos)
      << "and which";
  EXPECT_TRUE(drawn.names(3, "drawn again"));
  EXPECT_TRUE(drawn.names(3, "buffers grew"));
  for (const std::size_t n : {0u, 2u, 4u, 5u}) {
    EXPECT_TRUE(events_of(drawn.profile.recording, n, 0.0).empty())
        << n << ": " << events_of(drawn.profile.recording, n, 0.0)[0].text();
  }
  const auto& frame = drawn.profile.recording.frames[3];
  EXPECT_GE(frame.report.redraws, 1);
  EXPECT_EQ(frame.report.spans.size(), static_cast<std::size_t>(frame.report.redraws + 1) *
                                           drawn.profile.recording.frames[2].report.spans.size());
  EXPECT_GT(gpu_ms(frame), frame.report.gpu_ms) << "the drawing that overflowed counts, too";
  EXPECT_EQ(drawer.picture(3).width, 256) << "of 512 px, at most 320";
}

TEST(ProfileInput, ReportsLevelUploads) {
  const test::TempFolder folder;
  test::write_levels(folder, 600);
  Stream stream(folder / "lod-meta.json", {.detail = {.spacing_px = 2.0}, .reserve = 1000});
  ProfileInput run;
  for (int n = 0; n < 12; ++n) run.frames.push_back(pair_at(n < 4 ? -900.0 : 0.0, 48, 32));
  run.settings.threshold = Threshold::squared;
  run.settings.quality = 40.0f;
  run.fps = 200.0;
  ProfileDrawer drawer(stream.gpu_model(test::gl_context(), PRECISION_FULL), run, &stream);
  drawer.warm_up();
  const std::size_t before = stream.gaussians();
  const Drawn drawn(drawer.record([&](std::size_t done) {
    // Gives the reading thread time.
    if (done > 4) std::this_thread::sleep_for(std::chrono::milliseconds(30));
  }));
  EXPECT_EQ(test::faults_of_trace(drawn.trace), std::vector<std::string>());
  ASSERT_GT(stream.gaussians(), before);
  std::size_t uploaded = 0;
  for (std::size_t n = 0; n < run.frames.size(); ++n) {
    const render::FrameRecord& frame = drawn.profile.recording.frames[n];
    uploaded += frame.levels.uploaded;
    EXPECT_EQ(drawn.names(n, "levels uploaded"), frame.levels.uploaded > 0) << n;
    EXPECT_EQ(drawn.names(n, "measured its error"), frame.report.sampled_error) << n;
  }
  EXPECT_GT(uploaded, 0u);
  EXPECT_TRUE(drawn.names(0, "drawn exactly")) << "it is small";
  std::set<std::string> spans;
  for (const ThreadSpan& span : drawn.profile.recording.spans) spans.insert(span.thread + ": " + span.name);
  for (const char* const span : {"draws: levels", "draws: upload levels", "draws: submit",
                                 "reads levels: choose levels", "reads levels: read levels"})
    EXPECT_TRUE(spans.contains(span)) << span;
}

TEST(ProfileInput, FramesBeginAtRate) {
  const Model model = test::random_model(0, 30, 1);
  ProfileInput run;
  run.frames.assign(10, pair_at(0.0, 32, 16));
  run.fps = 20.0;
  ProfileDrawer drawer(std::make_shared<render::GpuModel>(test::gl_context(), model), run, nullptr);
  drawer.warm_up();
  const render::Recording recording = drawer.record([&](std::size_t done) {
    // The next frame cannot begin in time.
    if (done == 4) std::this_thread::sleep_for(std::chrono::milliseconds(70));
  });
  std::vector<int> ticks;
  for (const render::FrameRecord& frame : recording.frames) {
    ticks.push_back(static_cast<int>(
        std::lround((frame.due - recording.frames[0].due) / std::chrono::duration<double>(0.05))));
    EXPECT_GE(frame.begin, frame.due);
  }
  EXPECT_EQ(ticks, (std::vector<int>{0, 1, 2, 3, 5, 6, 7, 8, 9, 10}));
}

}  // namespace
}  // namespace binosplat::lab
