#include "lab/bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/faulty_shaders.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "stereo/rig.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

TEST(Bench, ViewsAreSpreadEvenly) {
  EXPECT_EQ(spread_evenly(10, 1), (std::vector<std::size_t>{0}));
  EXPECT_EQ(spread_evenly(10, 4), (std::vector<std::size_t>{0, 3, 6, 9}));
  EXPECT_EQ(spread_evenly(3, 7), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(spread_evenly(0, 3).empty());
}

struct BenchPoint : testing::Test {
  Model model = test::random_model(3, 600, 1);
  Camera head = test::front_camera(64, 48, 64.0);
  shared::View small = make_view(resized(head, 32, 24));

  Bench bench(gl::Context& context, int eyes, bool seen = false) const {
    BenchView view{"front", {make_view(head)}, {}};
    if (eyes == 2) {
      const auto rig = stereo::make_rig(head, {});
      view.eyes = {rig.views[0], rig.views[1]};
    }
    return {context, model, {view}, small, {.frames = 2, .repeats = 2, .seen = seen}};
  }
};

TEST_F(BenchPoint, ExactIsEqualAndAToleranceIsNot) {
  Bench both = bench(test::gl_context(), 2);
  const BenchNumbers exact = both.measure({});
  EXPECT_TRUE(std::isinf(exact.exact.psnr_db));
  EXPECT_TRUE(std::isinf(exact.exact.disagreement_db)) << "the eyes agree";
  EXPECT_EQ(exact.frames, 4u);
  EXPECT_EQ(exact.stages.size(), 4u);
  for (const int transmittance : {TRANSMITTANCE_ONE, TRANSMITTANCE_DEPTH, TRANSMITTANCE_LAST}) {
    render::FrameSettings settings;
    settings.th = TH_SQUARED;
    settings.tolerance = 4.0f;
    settings.transmittance = transmittance;
    const BenchNumbers point = both.measure(settings);
    EXPECT_LT(point.exact.psnr_db, 60.0);
    EXPECT_GT(point.exact.disagreement_db, 3.0);
    EXPECT_GT(point.exact.flip, 0.0);
    EXPECT_LT(point.pairs, exact.pairs);
  }
}

TEST_F(BenchPoint, FoveatedIsExactWhereOneLooks) {
  Bench both = bench(test::gl_context(), 2, true);
  BenchSettings foveated;
  foveated.foveation = stereo::Foveation{.inset_degrees = 20.0, .context_scale = 0.3};
  const BenchNumbers point = both.measure(foveated), exact = both.measure({});
  ASSERT_EQ(point.problem, "");
  EXPECT_EQ(point.stages.back().name, "compose");
  ASSERT_TRUE(point.seen && exact.seen);
  EXPECT_EQ(exact.seen->visible, 0.0);
  EXPECT_GT(point.seen->visible, 0.0);
  EXPECT_LT(point.exact.psnr_db, 60.0);
  ASSERT_GE(point.seen->rings.size(), 3u);
  EXPECT_TRUE(std::isinf(point.seen->rings[0].psnr_db)) << "the inset reaches 10 degrees";
  EXPECT_TRUE(std::isinf(point.seen->rings[1].psnr_db));
  EXPECT_LT(point.seen->rings[2].psnr_db, 60.0);
  double share = 0.0;
  for (const RingNumbers& ring : point.seen->rings) share += ring.share;
  EXPECT_NEAR(share, 1.0, 1e-9);
  EXPECT_FALSE(bench(test::gl_context(), 2).measure({}).seen);
}

TEST_F(BenchPoint, AWrongInsetIsNotTimed) {
  const test::FaultyShaders faulty("foveate.comp", "if (beyond == 0.0) return 1.0;",
                                   "if (beyond == 0.0) return 0.9;");
  BenchSettings foveated;
  foveated.foveation = stereo::Foveation{.inset_degrees = 20.0};
  for (const int transmittance : {TRANSMITTANCE_ONE, TRANSMITTANCE_LAST}) {
    foveated.th = TH_SQUARED;
    foveated.tolerance = 0.3f;
    foveated.transmittance = transmittance;
    EXPECT_NE(
        bench(test::gl_context(), 1).measure(foveated).problem.find("the inset is not the exact picture's"),
        std::string::npos);
  }
}

// The built-in shaders with a fault in them: what is drawn is not what the reference draws, and no time is
// given.
TEST_F(BenchPoint, WrongPicturesAreNotTimed) {
  render::FrameSettings lossy;
  lossy.th = TH_SQUARED;
  lossy.tolerance = 0.05f;
  for (const auto& settings : {render::FrameSettings{}, lossy})
    EXPECT_EQ(bench(test::gl_context(), 1).measure(settings).problem, "") << "without a fault it is timed";

  const test::FaultyShaders faulty("pixels.glsl", "inside ? float(TRANSMITTANCE_MIN)", "inside ? 0.05");
  const BenchNumbers point = bench(test::gl_context(), 1).measure({});
  EXPECT_FALSE(point.measured());
  EXPECT_NE(point.problem.find("differ from the float64 reference"), std::string::npos) << point.problem;
  EXPECT_FALSE(bench(test::gl_context(), 1).measure(lossy).measured()) << "a tolerance is no excuse";
  // Nothing in view.
  model.opacity.assign(model.count(), 0.0f);
  EXPECT_NE(bench(test::gl_context(), 1).measure({}).problem.find("is empty"), std::string::npos);
}

}  // namespace
}  // namespace binosplat::lab
