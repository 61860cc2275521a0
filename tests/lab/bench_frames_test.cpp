// Settings along a moving head: the reported numbers equal those of a second measurement of the same
// pictures.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lab/bench.h"
#include "lab/byte_pictures.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

using Views = std::vector<shared::View>;

/// Returns a stereo pair at x.
Views head_at(double x) {
  Camera camera = test::front_camera(50, 37, 48);
  camera.position.x = x;
  const auto eyes = stereo::make_rig(camera, {.ipd = 0.05}).views;
  return {eyes.begin(), eyes.end()};
}

/// Returns two stretches, each of six moving frames and two frames at rest.
std::vector<Stretch> sideways() {
  std::vector<Stretch> stretches;
  for (const double from : {0.0, -0.4}) {
    Stretch& stretch = stretches.emplace_back();
    for (int n = 0; n < 6; ++n) stretch.frames.push_back(head_at(from + 0.05 * n));
    stretch.moving = 6;
    stretch.frames.insert(stretch.frames.end(), 2, Views(stretch.frames.back()));
  }
  return stretches;
}

/// Returns the PSNR of each view, from 8-bit pictures that are read back and rounded on the CPU.
std::vector<double> looked_at(const std::vector<Picture>& exact, const std::vector<Picture>& drawn) {
  const auto shown = [](const Picture& picture) { return quantised(composite(picture, glm::vec3(0.0f))); };
  std::vector<double> db;
  for (std::size_t v = 0; v < exact.size(); ++v)
    db.push_back(measure::psnr(shown(exact[v]), shown(drawn[v])));
  return db;
}

struct BenchFrames : testing::Test {
  const Model model = test::random_model(71, 800, 0);
  BenchSettings settings;

  BenchFrames() {
    settings.threshold = Threshold::squared;
    settings.transmittance = Transmittance::last;
    settings.tolerance = 2.0f;
  }
  Bench bench(const std::vector<Stretch>& stretches, const BenchEffort& effort = {.repeats = 2}) const {
    return {test::gl_context(),
            [this]() -> const Model& { return model; },
            {.stretches = stretches, .small = make_view(test::front_camera(32, 24, 32))},
            effort};
  }
};

TEST_F(BenchFrames, ViewsHaveSeparateErrors) {
  render::Frame frame(test::gl_context(), model);
  BytePictures bytes(test::gl_context());
  gl::Buffer kept(test::gl_context(), "kept");
  const Views views = {make_view(test::front_camera(50, 37, 48)), make_view(test::front_camera(33, 21, 30)),
                       make_view(test::front_camera(16, 16, 12))};
  ASSERT_NE(views[0].width * views[0].height % THREADS, 0u);
  frame.draw(views);
  const auto exact = frame.read_pictures();
  bytes.keep(frame, views, kept);
  EXPECT_EQ(bytes.errors(frame, views, kept), std::vector<double>(3, 0.0));
  // A probe's pixels follow those of the views and do not count.
  const render::FrameSettings way{{.tolerance = 2.0f, .threshold = Threshold::squared}};
  for (const auto& probe : {std::optional<render::Probe>(), std::optional(render::Probe{.view = 1})}) {
    frame.draw_until(render::Stage::probe, views, way, {}, probe);
    const auto errors = bytes.errors(frame, views, kept);
    const auto db = looked_at(exact, frame.read_pictures());
    for (std::size_t v = 0; v < 3; ++v) {
      EXPECT_GT(errors[v], 0.0);
      EXPECT_NEAR(-10.0 * std::log10(errors[v]), db[v], 1e-4) << v;
    }
  }
}

TEST_F(BenchFrames, DetailsMatchSecondMeasurement) {
  const std::vector<Stretch> stretches = sideways();
  const Point point = bench(stretches).measure(settings);
  ASSERT_TRUE(point.measured());
  ASSERT_EQ(point.details.size(), 16u);
  double neighbours_off = 0.0;
  std::vector<double> moving, exact_pairs, pairs;
  std::size_t at = 0;
  for (std::size_t s = 0; s < stretches.size(); ++s) {
    render::Frame frame(test::gl_context(), model), still(test::gl_context(), model);
    std::vector<Picture> before;
    for (std::size_t n = 0; n < stretches[s].frames.size(); ++n, ++at) {
      SCOPED_TRACE(fmt::format("stretch {}, frame {}", s, n));
      const Views& views = stretches[s].frames[n];
      const auto of_exact = static_cast<double>(still.draw(views).pairs);
      const auto exact = still.read_pictures();
      const Report report = frame.draw(views, settings);
      const auto db = looked_at(exact, frame.read_pictures());
      const double worse = std::min({db[0], db[1], equal_db});
      const Row& row = point.details[at];
      EXPECT_EQ(number(row, "frame"), double(at));
      EXPECT_EQ(text(row, "phase"), n < 6 ? "moving" : "stop");
      EXPECT_NEAR(number(row, "psnr_db"), worse, 1e-4);
      EXPECT_EQ(number(row, "pairs"), static_cast<double>(report.pairs));
      EXPECT_EQ(number(row, "tolerance"), static_cast<double>(report.tolerance));
      EXPECT_GT(number(row, "frame_ms"), 0.0);
      // Injected: a comparison with the previous frame.
      if (n > 0 && n < 6)
        neighbours_off = std::max(neighbours_off, worse - looked_at(before, frame.read_pictures())[0]);
      before = exact;
      if (n >= 6) continue;
      moving.push_back(worse);
      pairs.push_back(static_cast<double>(report.pairs));
      exact_pairs.push_back(of_exact);
    }
  }
  EXPECT_GT(neighbours_off, 3.0) << "a neighbour's exact picture would go unnoticed";
  const auto sum = [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  };
  EXPECT_NEAR(number(point.row, "psnr_db"), sum(moving) / 12.0, 1e-3);
  EXPECT_NEAR(number(point.row, "worst_psnr_db"), *std::ranges::min_element(moving), 1e-3);
  EXPECT_NEAR(number(point.row, "pairs_removed"), 100.0 * (1.0 - sum(pairs) / sum(exact_pairs)), 1e-6);
  EXPECT_EQ(number(point.row, "frames"), 12);
  EXPECT_EQ(point.row["repeats_ms"].size(), 2u);
  const Row exact = bench(stretches).measure({}).row;
  EXPECT_EQ(number(exact, "equal_frames"), 12);
  EXPECT_EQ(number(exact, "pairs_removed"), 0.0);
  EXPECT_FALSE(exact.contains("reported_db"));
  settings.tolerance = 0.0f;
  settings.quality = 38.0f;  // whose frames are all exact, because they are small
  const Row small = bench(stretches).measure(settings).row;
  EXPECT_EQ(number(small, "exact_frames"), 100.0);
  EXPECT_EQ(number(small, "unmeasured") + number(small, "no_gain"), 0.0);
  EXPECT_EQ(number(small, "reported_db"), equal_db);
  EXPECT_EQ(number(small, "reported_minus_true_db"), 0.0);
}

TEST_F(BenchFrames, RedrawsFramesBeyondMemory) {
  const std::vector<Stretch> stretches = sideways();
  const auto gpu_model = std::make_shared<render::GpuModel>(test::gl_context(), model);
  render::Frame frame(gpu_model);
  const std::int64_t one_frame = BytePictures::bytes(stretches[0].frames[0]);
  EXPECT_EQ(one_frame, 4 * 2 * 50 * 37);
  ExactFrames all(gpu_model, {}, stretches, 100 * one_frame), some(gpu_model, {}, stretches, 3 * one_frame);
  for (std::size_t n = 0; n < 8; ++n) {
    frame.draw(stretches[1].frames[n], {{.tolerance = 1.0f, .threshold = Threshold::squared}});
    EXPECT_EQ(all.psnr(frame, 1, n), some.psnr(frame, 1, n)) << n;
    EXPECT_EQ(all.pairs(1, n), some.pairs(1, n));
  }
  frame.draw(stretches[0].frames[7]);
  EXPECT_EQ(some.psnr(frame, 0, 7), (std::vector<double>{INFINITY, INFINITY}));
}

TEST_F(BenchFrames, StretchesSpreadOverPath) {
  using Starts = std::vector<std::size_t>;
  EXPECT_EQ(stretch_starts(100, 20, 3), (Starts{0, 40, 80}));
  EXPECT_EQ(stretch_starts(100, 20, 1), (Starts{40})) << "in the middle";
  EXPECT_EQ(stretch_starts(50, 20, 3), (Starts{0, 30})) << "so many would overlap";
  EXPECT_EQ(stretch_starts(10, 20, 3), (Starts{0})) << "not even one fits";
}

}  // namespace
}  // namespace binosplat::lab
