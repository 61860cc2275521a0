// The stability study: its cases, its verdicts, and a rule carried along a path.

#include "lab/stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "lab/along_path.h"
#include "lab/first_pair.h"
#include "lab/fixed_camera.h"
#include "render/frame.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::lab {
namespace {

StabilityCase small_case(std::size_t frames) {
  Camera head = test::front_camera(64, 48, 60);
  StabilityCase one{"small", "", std::make_shared<const Model>(test::random_model(71, 2500, 0)), {}, 0};
  for (std::size_t n = 0; n < frames; ++n) {
    one.frames.push_back(stereo::make_rig(head, {.ipd = 0.05}));
    head.position.x += 0.002;
  }
  return one;
}

StabilityResult run_one(const StabilityCase& one, const Variant& variant,
                        const StabilityBounds& bounds = {}) {
  return run_case(test::gl_context(), one, {variant}, bounds, [] {}).front();
}

TEST(Stability, EveryCombinationIsThereOnce) {
  std::set<std::string> names;
  for (const Variant& variant : all_variants()) names.insert(variant.name());
  EXPECT_EQ(names.size(), all_variants().size());
  EXPECT_EQ(names.size(), 1u + 2 * 3);  // tau; both thresholds by 3 sources
  EXPECT_TRUE(names.count("squared, last"));
  EXPECT_EQ(all_variants().front().th, TH_TAU);
}

TEST(Stability, ExactFramesHoldWhateverTheBounds) {
  const StabilityResult r = run_one(small_case(4), {.th = TH_TAU});
  EXPECT_EQ(r.verdict, "holds");
  EXPECT_TRUE(std::isinf(r.worst_db));
  EXPECT_EQ(r.removed, 0.0);
  EXPECT_EQ(r.drift_db, 0.0);
}

TEST(Stability, VerdictsFollowFromTheirBounds) {
  const StabilityCase one = small_case(6);
  const Variant rough{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 2.0f};
  const StabilityResult r = run_one(one, rough);
  EXPECT_GT(r.removed, 0.1);
  EXPECT_LT(r.signed_mean, 0.0);
  // Bounds on either side of what was measured, one at a time.
  StabilityBounds wide{0.0, 0.0, 1.0, 100.0, 100, 0.0};
  EXPECT_EQ(run_one(one, rough, wide).verdict, "holds");
  StabilityBounds tight = wide;
  tight.worst_db = r.worst_db + 0.1;
  EXPECT_EQ(run_one(one, rough, tight).verdict, "dips");
  tight = wide;
  tight.settled_db = r.settled_db + 0.1;
  EXPECT_EQ(run_one(one, rough, tight).verdict, "wrong");
  tight = wide;
  tight.darkening = -0.9 * r.signed_mean;
  EXPECT_EQ(run_one(one, rough, tight).verdict, "darkens");
  tight = wide;
  tight.disagreement_db = r.disagreement_db + 0.1;
  EXPECT_EQ(run_one(one, rough, tight).verdict, "rivalry");
}

TEST(Stability, AJumpIsWhereSettlingIsCountedFrom) {
  // Frames of another place at the end: what is settled to is theirs, and the ones before the jump do not
  // count.
  StabilityCase one = small_case(9);
  for (std::size_t n = 3; n < 9; ++n)
    one.frames[n] = stereo::make_rig(
        [] {
          Camera head = test::front_camera(64, 48, 60);
          head.position.z = 1.5;
          return head;
        }(),
        {.ipd = 0.05});
  one.event = 3;
  const Variant variant{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 0.5f};
  const StabilityResult r = run_one(one, variant);
  EXPECT_LE(r.settling, 5u);
  EXPECT_NEAR(r.drift_db, 0.0, 1.5);
}

TEST(Stability, TheCasesShowSomething) {
  std::set<std::string> names;
  for (const StabilityCase& one : built_in_cases()) {
    names.insert(one.name);
    EXPECT_GE(one.frames.size(), 24u) << one.name;
    render::Frame frame(test::gl_context(), *one.model);
    frame.draw(one.frames.front().views);
    double light = 0;
    for (const Picture& eye : frame.read_pictures()) {
      for (const glm::vec4& pixel : eye.colour) light += 1.0 - pixel.a;
    }
    EXPECT_GT(light, 0.5 * 2 * 128 * 96) << one.name << " covers too little of the picture";
  }
  EXPECT_EQ(names.size(), 8u);
}

TEST(Stability, TheToleranceComesToItsTarget) {
  const StabilityCase one = small_case(3);
  Variant variant{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST};
  variant.tolerance = first_pair_of(one).tolerance_at(variant, 38.0);
  FixedCamera camera = first_pair_of(one);
  camera.settle(variant);
  const double db = judge(camera.views(), camera.exact(), camera.pictures(), TILE_SIZE_DEFAULT).psnr;
  EXPECT_GE(db, 38.0);
  EXPECT_LT(db, 38.5);
  EXPECT_EQ(first_pair_of(one).tolerance_at({.th = TH_TAU}, 38.0), 0.0f);
}

std::vector<std::vector<shared::View>> path_with_jump() {
  std::vector<std::vector<shared::View>> frames;
  Camera head = test::front_camera(64, 48, 60);
  for (int n = 0; n < 8; ++n) {
    head.position.x = 0.002 * n + (n < 4 ? 0.0 : 0.8);  // a jump
    frames.push_back({make_view(head)});
  }
  return frames;
}

TEST(Carried, FallsBackToOneAndMakesAsManyPairs) {
  const Model model = test::random_model(72, 2500, 0);
  const auto frames = path_with_jump();
  Variant variant{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST};
  variant.tolerance = tolerance_along_path(test::gl_context(), model, frames, variant, 38.0);
  const auto results = draw_along_path(test::gl_context(), model, frames, variant, 0.0f, [] {});
  ASSERT_EQ(results.size(), 8u);
  for (std::size_t n = 0; n < results.size(); ++n) {
    EXPECT_EQ(results[n].fell_back, n == 0 || n == 4) << n;
    EXPECT_EQ(results[n].equals_one, n == 0 || n == 4) << n;
    EXPECT_NEAR(results[n].one_pairs, results[n].pairs, 0.01 * results[n].pairs) << n;
  }
  EXPECT_NEAR(results[1].db, 38.0, 1.5);
}

TEST(Carried, AQualityIsKept) {
  const Model model = test::random_model(73, 2500, 0);
  std::vector<std::vector<shared::View>> frames(90,
                                                path_with_jump()[0]);  // the tolerance starts far too small
  const Variant variant{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST};
  const auto results = draw_along_path(test::gl_context(), model, frames, variant, 38.0f, [] {});
  EXPECT_NEAR(results.back().db, 38.0, 1.0);
}

}  // namespace
}  // namespace binosplat::lab
