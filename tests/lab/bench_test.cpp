#include "lab/bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "adagscale/depth_table.h"
#include "base/error.h"
#include "render/faulty_shaders.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

struct BenchPoint : testing::Test {
  Model model = test::random_model(3, 600, 1);
  Camera head = test::front_camera(64, 48, 64.0);
  shared::View small = make_view(resized(head, 32, 24));

  Bench bench(gl::Context& context, int eyes, bool seen = false) const {
    BenchCase what{.views = {{"front", {make_view(head)}}}, .small = small};
    if (eyes == 2) {
      const auto rig = stereo::make_rig(head, {});
      what.views.front().eyes = {rig.views[0], rig.views[1]};
    }
    return bench(context, std::move(what), seen);
  }
  Bench bench(gl::Context& context, BenchCase what, bool seen = false) const {
    return {context,
            [this]() -> const Model& { return model; },
            std::move(what),
            {.frames = 2, .repeats = 2, .seen = seen}};
  }
};

TEST_F(BenchPoint, OnlyExactSettingsAreEqual) {
  Bench both = bench(test::gl_context(), 2);
  const Point exact = both.measure({});
  EXPECT_EQ(number(exact.row, "psnr_db"), equal_db);
  EXPECT_EQ(number(exact.row, "disagreement_db"), equal_db) << "the eyes agree";
  EXPECT_EQ(number(exact.row, "disparity_p99_px"), 0.0);
  EXPECT_EQ(number(exact.row, "frames"), 4);
  EXPECT_EQ(exact.row["repeats_ms"].size(), 2u);
  EXPECT_EQ(exact.row.contains("cpu_repeats_ms"), test::gl_context().software());
  double stages = 0.0;
  for (const auto& [name, value] : exact.row.items()) stages += stage_of(name) ? 1.0 : 0.0;
  EXPECT_EQ(stages, 4.0);
  for (const Transmittance transmittance : {Transmittance::one, Transmittance::depth, Transmittance::last}) {
    render::FrameSettings settings;
    settings.threshold = Threshold::squared;
    settings.tolerance = 4.0f;
    settings.transmittance = transmittance;
    const Row row = both.measure(settings).row;
    EXPECT_LT(number(row, "psnr_db"), 60.0);
    EXPECT_GT(number(row, "disagreement_db"), 3.0);
    EXPECT_GT(number(row, "disparity_p99_px"), number(row, "disparity_median_px"));
    EXPECT_LT(number(row, "disparity_p99_px"), 10.0);
    EXPECT_GT(number(row, "flip"), 0.0);
    EXPECT_NEAR(number(row, "pairs_removed"),
                100.0 * (1.0 - number(row, "pairs") / number(exact.row, "pairs")), 1e-9);
    EXPECT_GT(number(row, "pairs_removed"), 0.0);
  }
}

// The table's bins are of the view depth, or with the tangent projection of the distance.
TEST_F(BenchPoint, DepthTableFollowsProjection) {
  head = test::front_camera(64, 48, 20.0);  // wide, so that both differ
  BenchSettings settings;
  settings.threshold = Threshold::adagscale;
  settings.tolerance = 0.5f;
  settings.transmittance = Transmittance::depth;
  settings.projection = Projection::tangent;
  const double pairs = number(bench(test::gl_context(), 1).measure(settings).row, "pairs");
  render::Frame frame(test::gl_context(), model);
  const shared::View view = make_view(head);
  const auto pairs_with = [&](std::optional<Projection> of_table) {
    settings.depth_table =
        adagscale::measure_depth_table(frame, {&view, 1}, {.frame = {{.projection = of_table}}});
    return static_cast<double>(frame.draw({&view, 1}, settings).pairs);
  };
  EXPECT_EQ(pairs, pairs_with(Projection::tangent));
  EXPECT_NE(pairs, pairs_with({})) << "injected: the table of the model's own projection";
}

TEST_F(BenchPoint, FoveatedIsExactAtGaze) {
  Bench both = bench(test::gl_context(), 2, true);
  BenchSettings foveated;
  foveated.foveation = stereo::Foveation{.inset_degrees = 20.0, .context_scale = 0.3};
  const Point point = both.measure(foveated), exact = both.measure({});
  ASSERT_TRUE(point.measured()) << point.row;
  EXPECT_TRUE(point.row.contains(stage_column("compose")));
  EXPECT_EQ(number(exact.row, "seen"), 0.0);
  EXPECT_GT(number(point.row, "seen"), 0.0);
  EXPECT_LT(number(point.row, "psnr_db"), 60.0);
  std::vector<Row> rings;
  std::ranges::copy_if(point.details, std::back_inserter(rings),
                       [](const Row& row) { return text(row, "kind") == "ring"; });
  ASSERT_GE(rings.size(), 3u);
  EXPECT_EQ(number(rings[0], "psnr_db"), equal_db) << "the inset reaches 10 degrees";
  EXPECT_EQ(number(rings[1], "psnr_db"), equal_db);
  EXPECT_LT(number(rings[2], "psnr_db"), 60.0);
  EXPECT_NEAR(mean_number(rings, "area") * double(rings.size()), 100.0, 1e-9);
  EXPECT_FALSE(bench(test::gl_context(), 2).measure({}).row.contains("seen"));
}

TEST_F(BenchPoint, WrongInsetIsNotTimed) {
  const test::FaultyShaders faulty("foveate.comp", "if (beyond == 0.0) return 1.0;",
                                   "if (beyond == 0.0) return 0.9;");
  BenchSettings foveated;
  foveated.foveation = stereo::Foveation{.inset_degrees = 20.0};
  for (const Transmittance transmittance : {Transmittance::one, Transmittance::last}) {
    foveated.threshold = Threshold::squared;
    foveated.tolerance = 0.3f;
    foveated.transmittance = transmittance;
    EXPECT_NE(text(bench(test::gl_context(), 1).measure(foveated).row, "problem")
                  .find("the inset differs from the exact picture"),
              std::string::npos);
  }
}

// Injected faults in the built-in shaders: the picture differs from the reference's, so no time is reported.
TEST_F(BenchPoint, WrongPicturesAreNotTimed) {
  render::FrameSettings lossy;
  lossy.threshold = Threshold::squared;
  lossy.tolerance = 0.05f;
  for (const auto& settings : {render::FrameSettings{}, lossy})
    EXPECT_TRUE(bench(test::gl_context(), 1).measure(settings).measured()) << "without a fault it is timed";

  const test::FaultyShaders faulty("pixels.glsl", "inside ? float(TRANSMITTANCE_MIN)", "inside ? 0.05");
  const Point point = bench(test::gl_context(), 1).measure({});
  EXPECT_FALSE(point.measured());
  EXPECT_NE(text(point.row, "problem").find("differ from the float64 reference"), std::string::npos)
      << point.row;
  EXPECT_FALSE(bench(test::gl_context(), 1).measure(lossy).measured()) << "a tolerance is no excuse";
  // Nothing is visible.
  model.opacity.assign(model.count(), 0.0f);
  EXPECT_NE(text(bench(test::gl_context(), 1).measure({}).row, "problem").find("is empty"),
            std::string::npos);
}

/// Returns a wall in front of both eyes, brighter than the finest one by `by`.
Model wall_by(float by) {
  Model model;
  for (int x = -8; x <= 8; ++x) {
    for (int y = -5; y <= 5; ++y)
      test::add(model, {0.5f * x, 0.5f * y, 4.0f + 0.1f * static_cast<float>(x % 3)}, glm::vec3(0.3f), 0.8f,
                glm::vec3((x + y) % 2 == 0 ? 0.6f : 0.3f) + by);
  }
  return model;
}

struct BenchLevels : BenchPoint {
  const Model brighter = wall_by(0.05f);
  BenchSettings detailed;
  BenchCase what;

  BenchLevels() {
    model = wall_by(0.0f);
    detailed.detail = DetailRequest{.db = 30.0};
    const auto rig = stereo::make_rig(head, {.ipd = 0.06});
    what.views = {{"pair", {rig.views[0], rig.views[1]}}};
    what.small = small;
    what.follow = [this](const DetailRequest&) {
      return FollowingModel{std::make_shared<render::GpuModel>(test::gl_context(), brighter),
                            [](std::span<const shared::View>) {
                              return LoadedLevels{100, 33.0};
                            }};
    };
  }
};

TEST_F(BenchLevels, CompareWithFinestLevel) {
  Bench both = bench(test::gl_context(), what);
  const Row row = both.measure(detailed).row;
  EXPECT_GT(number(row, "psnr_db"), 26.0) << "0.05 times what is seen of the wall";
  EXPECT_LT(number(row, "psnr_db"), 32.0);
  EXPECT_GT(number(row, "disagreement_db"), number(row, "psnr_db") + 10.0) << "both eyes see the same error";
  EXPECT_EQ(number(row, "gaussians"), 100.0);
  EXPECT_EQ(number(row, "reported_db"), 33.0);
  EXPECT_GT(number(row, "frame_ms"), 0.0);
  EXPECT_EQ(number(both.measure({}).row, "psnr_db"), equal_db);
}

TEST_F(BenchLevels, ContinueWithoutFinestLevel) {
  int loaded = 0;
  const auto without = [&](ExitCode code) {
    return Bench(test::gl_context(),
                 [&, code]() -> const Model& {
                   ++loaded;
                   throw Error(code, "no room for so many Gaussians");
                 },
                 what, {.frames = 1, .repeats = 2});
  };
  Bench small_gpu = without(ExitCode::out_of_memory);
  const Row row = small_gpu.measure(detailed).row;
  EXPECT_EQ(text(row, "no_exact"), "the finest levels cannot be drawn: no room for so many Gaussians");
  EXPECT_FALSE(row.contains("psnr_db") || row.contains("flip") || row.contains("disagreement_db") ||
               row.contains("disparity_p99_px"));
  EXPECT_EQ(number(row, "reported_db"), 33.0);
  EXPECT_GT(number(row, "frame_ms"), 0.0);
  const Row finest = small_gpu.measure({}).row;
  EXPECT_EQ(finest["no_exact"], row["no_exact"]);
  EXPECT_FALSE(finest.contains("frame_ms") || finest.contains("problem")) << "it is no fault of the picture";
  EXPECT_EQ(loaded, 1) << "and are not asked for again";
  what.views.clear();
  what.stretches = {{std::vector(3, std::vector{make_view(head)}), 2}};
  Bench along = without(ExitCode::out_of_memory);
  const Row frames = along.measure(detailed).row;
  EXPECT_GT(number(frames, "frame_ms"), 0.0);
  EXPECT_EQ(number(frames, "reported_db"), 33.0);
  EXPECT_FALSE(frames.contains("psnr_db") || frames.contains("pairs_removed") ||
               frames.contains("worst_view"));
  EXPECT_THROW(without(ExitCode::bad_input).measure(detailed), Error) << "any other error ends it";
}

/// Spots, each alone in a tile. Their sizes determine which pairs a tolerance drops and what that costs.
struct FoundToleranceOfSpots : testing::Test {
  static constexpr int columns = 6, rows = 2, tile = 16;
  static constexpr double focal = 100.0, depth = 10.0;
  struct Spot {
    double variance;  // px^2, including the low-pass
    double opacity;
    bool left;
  };
  std::vector<Spot> spots;
  Model model;
  BenchCase what;

  FoundToleranceOfSpots() {
    Camera camera = test::front_camera(columns * tile, rows * tile, focal);
    camera.name = "whole";
    what.training.push_back({camera, {}});
    for (int n = 0; n < columns * rows; ++n) {
      const double variance = 1.5 + 0.06 * n, opacity = 0.1 + 0.07 * n;
      const int column = n % columns, row = n / columns;
      const double x = (column + 0.5) * tile - 0.5 * camera.width;
      const double y = (row + 0.5) * tile - 0.5 * camera.height;
      const auto scale = static_cast<float>(std::sqrt(variance - 0.3) * depth / focal);
      test::add(model, glm::vec3(x, y, focal) * static_cast<float>(depth / focal),
                glm::vec3(scale, scale, 1e-6f), static_cast<float>(opacity));
      spots.push_back({variance, opacity, n % columns < columns / 2});
    }
    camera.name = "left";
    camera.width /= 2;  // keeps its principal point, and shows the left half of the picture
    what.tested.push_back({camera, {}});
    what.views = {{"left", {make_view(camera)}}};
    what.small = what.views.front().eyes.front();
  }

  static double error(const Spot& spot) {
    return spot.opacity * spot.opacity * M_PI * spot.variance;  // the integral of alpha^2 over the pixels
  }

  /// The loss of dropping spots in a rule's order, as long as the whole picture reaches the target: dB of the
  /// whole picture and of its left half.
  struct Known {
    double whole_db = equal_db, left_db = equal_db, removed_left = 0.0;
  };
  static Known known(const std::vector<Spot>& order, double target) {
    double all = 0.0, of_left = 0.0;
    Known k;
    const double pixels = columns * rows * tile * tile;
    double removed = 0.0;
    for (const Spot& spot : order) {
      all += error(spot);
      const double db = -10.0 * std::log10(all / pixels);
      if (db < target) break;
      of_left += spot.left ? error(spot) : 0.0;
      removed += spot.left ? 200.0 / (columns * rows) : 0.0;
      k = {db, of_left > 0.0 ? -10.0 * std::log10(of_left / (0.5 * pixels)) : equal_db, removed};
    }
    return k;
  }
};

TEST_F(FoundToleranceOfSpots, LossMatchesCalculation) {
  Bench bench(test::gl_context(), [this]() -> const Model& { return model; }, what,
              {.frames = 1, .repeats = 2});
  Bench without_perception(test::gl_context(), [this]() -> const Model& { return model; }, what,
                           {.frames = 1, .repeats = 2, .perception = false});
  const auto ordered = [&](auto worth) {
    std::vector<Spot> order = spots;
    std::ranges::sort(order, {}, worth);
    return order;
  };
  // A spot is dropped completely if Th > sigma (docs/method.md 5).
  const auto paper = ordered([](const Spot& s) { return (s.opacity - 1.0 / 255) * 2 * M_PI * s.variance; });
  const auto squared = ordered([](const Spot& s) { return s.opacity * s.opacity * M_PI * s.variance; });
  for (const Threshold threshold : {Threshold::adagscale, Threshold::squared}) {
    for (const double target : {30.0, 26.0}) {
      BenchSettings settings;
      settings.threshold = threshold;
      settings.transmittance = Transmittance::depth;
      settings.min_psnr = target;
      settings.found_on_training = true;
      const Row found = bench.measure(settings).row;
      const Known k = known(threshold == Threshold::adagscale ? paper : squared, target);
      EXPECT_NEAR(number(found, "found_db"), k.whole_db, 0.01 * k.whole_db) << "in the training view";
      EXPECT_NEAR(number(found, "psnr_db"), k.left_db, 0.01 * k.left_db) << "in the test view";
      EXPECT_NEAR(number(found, "pairs_removed"), k.removed_left, 1e-9);
      EXPECT_GT(k.removed_left, 0.0) << "of nothing this could not fail";
      const Row quick = without_perception.measure(settings).row;
      EXPECT_FALSE(quick.contains("flip"));
      for (const char* name : {"psnr_db", "pairs", "pairs_removed"})
        EXPECT_NEAR(number(quick, name), number(found, name), 1e-3) << name;
      settings.found_on_training = false;
      const Row tuned = bench.measure(settings).row;
      EXPECT_NEAR(number(tuned, "psnr_db"), number(tuned, "found_db"), 1e-3)
          << "tuned on the test view itself";
      EXPECT_GE(number(tuned, "psnr_db"), target);
      EXPECT_NE(number(tuned, "found_tolerance"), number(found, "found_tolerance"));
    }
  }
}

}  // namespace
}  // namespace binosplat::lab
