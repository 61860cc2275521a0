#include "lab/floors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lab/times.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

TEST(Floors, AreWhatMustBeMovedAndComputed) {
  const Peaks peaks{.bytes = 1e12, .alphas = 1e12, .fmas = 1e13};
  FrameWork work;
  work.gaussians = 1000;
  work.degree = 1;  // 12 harmonics
  work.in_view = 500;
  work.splats = 1000;
  work.pairs = 12000;
  work.supertile_pairs = 10000;
  work.tiles = 100;
  work.pixels = 25600;
  work.alphas = 1e6;
  for (const char* stage : {"decode", "project", "bin", "sort", "blend"})
    work.stages.push_back({stage, 0.01});
  const std::vector<StageFloor> stages = profile(work, peaks);
  ASSERT_EQ(stages.size(), 5u);
  EXPECT_TRUE(std::isnan(stages[0].floor_ms)) << "decode has none";
  const std::map<std::string, double> bytes = {{"project", 1000 * 52.0 + 500 * 48.0 + 1000 * 52.0},
                                               {"bin", 1000 * 10.0 + 80000.0},
                                               {"sort", 80000.0 + 48000.0 + 800.0},
                                               {"blend", 12000 * 52.0 + 25600 * 20.0}};
  for (const StageFloor& stage : stages) {
    const auto found = bytes.find(stage.stage);
    if (found == bytes.end()) continue;
    EXPECT_DOUBLE_EQ(stage.bytes, found->second) << stage.stage;
    const double ms = std::max(found->second / 1e12, found->first == "blend" ? 1e6 / 1e12 : 0.0) * 1000;
    EXPECT_DOUBLE_EQ(stage.floor_ms, ms) << stage.stage;
    EXPECT_DOUBLE_EQ(stage.share, ms / 0.01) << stage.stage;
  }
  EXPECT_DOUBLE_EQ(stages[1].operations, 1000 * (90.0 + 32.0));
  // With more time for alphas than for bytes, the alphas determine the floor.
  work.alphas = 1e9;
  EXPECT_DOUBLE_EQ(profile(work, peaks)[4].floor_ms, 1.0);
}

TEST(Floors, RatesAreMeasuredAndAFramesWorkIsCounted) {
  const Peaks peaks = measure_peaks(test::gl_context());
  for (const double rate : {peaks.bytes, peaks.alphas, peaks.fmas}) {
    EXPECT_TRUE(std::isfinite(rate));
    EXPECT_GT(rate, 1e5);
  }
  // The stages of a frame. Other tests compare their counts with the reference.
  const Model model = test::random_model(3, 4000, 3);
  const shared::View view = make_view(test::front_camera(96, 96, 96.0));
  render::Frame frame(test::gl_context(), model);
  const render::FrameReport report = frame.draw(std::span(&view, 1));
  FrameWork work{
      .gaussians = 4000, .degree = 3, .in_view = double(report.visible), .splats = double(report.visible)};
  work.pairs = static_cast<double>(report.pairs);
  work.supertile_pairs = static_cast<double>(report.supertile_pairs);
  work.pixels = 96 * 96;
  const std::vector<Image> shown = frame.read_debug_view(SHOW_ALPHAS);
  for (const float alphas : shown.front().data) work.alphas += static_cast<double>(alphas);
  EXPECT_GT(work.alphas, work.pixels);
  work.stages = report.stages;
  for (const StageFloor& stage : profile(work, peaks)) EXPECT_GT(stage.share, 0.0) << stage.stage;
}

TEST(RunTimes, OutliersDoNotMoveWhatAFrameTakes) {
  lab::Reports frames;
  render::FrameReport report;
  report.stages = {{"blend", 0.0}};
  const auto add = [&](double ms, bool recorded) {
    report.total_ms = ms;
    report.stages[0].ms = ms / 2;
    report.measured = recorded;
    frames.push_back(report);
  };
  for (const double ms : {1.0, 1.0, 1.0, 1.0, 50.0, 1.0}) add(ms, false);  // one slow frame
  for (const double ms : {4.0, 4.0}) add(ms, true);
  const lab::Typical typical = lab::typical_of(frames);
  EXPECT_DOUBLE_EQ(typical.frame_ms, (6 * 1.0 + 2 * 4.0) / 8);
  EXPECT_DOUBLE_EQ(typical.stages.front().ms, typical.frame_ms / 2);
}

}  // namespace
}  // namespace binosplat::lab
