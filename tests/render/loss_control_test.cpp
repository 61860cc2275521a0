// --quality: the loss that keeps frames at a wanted error.

#include "render/loss_control.h"

#include <cmath>

#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::LossControl;

const FrameSettings squared = {.th = TH_SQUARED, .quality = 40};

// Runs the control for so many frames on views whose error follows a law of its own; the quality of the last.
double settled(LossControl& control, const std::vector<shared::View>& views, int frames, double at_one,
               double power) {
  double error = 0;
  for (int n = 0; n < frames; ++n) {
    const render::Probe probe = control.next_probe(views, squared);
    error = at_one * std::pow(control.next_loss(squared, false), power);
    // The upper half of the picture is worse than the lower one.
    control.measured(error * (probe.first_row < views[0].height / 2 ? 1.5 : 0.5));
  }
  return -10 * std::log10(error);
}

TEST(LossControl, FindsTheLossWhateverTheSceneIsLike) {
  const std::vector views = {make_view(test::front_camera(64, 160, 64))};
  for (const double power : {1.0, 1.3, 1.6}) {
    for (const double at_one : {1e-4, 1e-3, 1e-2, 0.1}) {
      LossControl control;
      EXPECT_NEAR(settled(control, views, 80, at_one, power), 40.0, 0.7) << at_one << " ^ " << power;
      EXPECT_NEAR(control.quality(), 40.0, 0.7);
    }
  }
}

TEST(LossControl, ProbesEveryRowOfEveryViewInTurn) {
  const std::vector views = {make_view(test::front_camera(8, 45, 8)),
                             make_view(test::front_camera(8, 45, 8))};
  LossControl control;
  std::vector<int> seen(90);
  int frames = 0;
  for (; frames < 30; ++frames) {
    const render::Probe probe = control.next_probe(views, squared);
    EXPECT_GT(probe.rows, 0u);
    for (std::uint32_t y = 0; y < probe.rows; ++y) ++seen.at(45 * probe.view + probe.first_row + y);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 90);  // 15 strips of 3 rows a view
}

TEST(LossControl, ACutForgetsWhatWasSeenButNotTheLoss) {
  const std::vector views = {make_view(test::front_camera(64, 64, 64))};
  LossControl control;
  settled(control, views, 80, 1e-2, 1.3);
  control.next_probe(views, squared);
  const float before = control.next_loss(squared, false);
  control.next_probe(views, squared);
  EXPECT_NEAR(control.next_loss(squared, true), before, 0.05 * before);
  EXPECT_NEAR(control.quality(), 40.0, 0.1);  // nothing else is known
}

TEST(LossControl, MovesByAThirdAFrameAtMost) {
  const std::vector views = {make_view(test::front_camera(64, 64, 64))};
  LossControl control;
  float last = 0;
  for (int n = 0; n < 20; ++n) {
    control.next_probe(views, squared);
    const float loss = control.next_loss(squared, false);
    if (n > 0) {
      EXPECT_LE(loss, 1.34f * last);
      EXPECT_GE(loss, 0.74f * last);
    }
    last = loss;
    control.measured(n % 2 == 0 ? 0.0 : 0.5);
  }
}

TEST(Quality, TheProbeTellsTheErrorOfItsStrip) {
  const Model model = test::random_model(97, 3000, 1);
  const std::vector views = {make_view(test::front_camera(160, 120, 160))};
  const auto exact = test::draw(model, views);
  FrameSettings settings = squared;
  settings.quality = 34;
  settings.probe_strips = 1;  // all of the picture
  settings.background = {0.2f, 0.4f, 0.6f};
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 34; ++n) {
    const render::FrameReport report = frame.draw(views, settings);
    if (n < 28) continue;  // the loss starts hundreds of times too small for this model
    const double db = measure::psnr(composite(frame.read_pictures().front(), settings.background),
                                    composite(exact.front(), settings.background));
    EXPECT_NEAR(report.quality, db, 0.3);
    EXPECT_NEAR(db, 34.0, 0.5);
  }
}

TEST(Quality, AStripIsDrawnExactlyWhereverItLies) {
  // With no loss the probe must find no error: its lens, clamp and tiles are those of the whole picture.
  const Model model = test::random_model(98, 3000, 1);
  const auto eyes = stereo::make_rig(test::front_camera(96, 100, 100), {.ipd = 0.1, .cant_degrees = 4}).views;
  const std::vector views(eyes.begin(), eyes.end());
  for (std::uint32_t first_row = 0; first_row < 100; first_row += 17) {
    const render::Probe probe{first_row % 2, first_row, std::min(17u, 100 - first_row)};
    const auto shape = render::make_shape(views, {.th = TH_SQUARED, .loss = 0.3f}, model, probe);
    const auto strip = test::draw(model, std::vector{shape.views.back()}).front();
    const auto whole = test::draw(model, std::vector{views[probe.view]}).front();
    double worst = 0;
    for (std::size_t k = 0; k < strip.colour.size(); ++k)
      worst = std::max<double>(worst, glm::length(strip.colour[k] - whole.colour[first_row * 96 + k]));
    EXPECT_LT(worst, 2e-3)
        << first_row;  // fp32 puts a splat 1e-5 px aside, which may turn one alpha near tau
    if (first_row == 0) continue;
    shared::View clamped = shape.views.back();  // as if the strip were a camera of its own
    clamped.slopes.y = -(clamped.lens.w + 0.15f * static_cast<float>(clamped.height)) / clamped.lens.y;
    clamped.slopes.w = (static_cast<float>(clamped.height) * 1.15f - clamped.lens.w) / clamped.lens.y;
    const auto wrong = test::draw(model, std::vector{clamped}).front();
    EXPECT_FALSE(test::same_bits(wrong, strip));
  }
}

TEST(Quality, TheProbeIsNoPictureAndChangesNone) {
  const Model model = test::random_model(99, 3000, 1);
  const auto eyes = stereo::make_rig(test::front_camera(96, 80, 100), {.ipd = 0.1}).views;
  const std::vector views(eyes.begin(), eyes.end());
  FrameSettings settings = {
      .th = TH_SQUARED, .transmittance = TRANSMITTANCE_BOTH, .contrast = CONTRAST_FINAL, .quality = 38};
  render::Frame steered(test::gl_context(), model), given(test::gl_context(), model);
  for (int n = 0; n < 6; ++n) {
    const render::FrameReport report = steered.draw(views, settings);
    FrameSettings same = settings;
    same.quality = 0;
    same.loss = report.loss;
    const render::FrameReport other = given.draw(views, same);
    EXPECT_GT(report.pairs, other.pairs);  // the probe's
    const auto a = steered.read_pictures(), b = given.read_pictures();
    ASSERT_EQ(a.size(), 2u);
    for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(test::same_bits(a[eye], b[eye])) << n;
  }
}

TEST(Quality, NeedsARule) {
  const Model model = test::random_model(100, 10, 0);
  const shared::View view = make_view(test::front_camera(32, 32, 32));
  EXPECT_TRUE(test::fails_saying([&] { test::draw(model, view, {.quality = 40}); }, {"--quality 40", "tau"}));
  EXPECT_TRUE(test::fails_saying([&] { test::draw(model, view, {.th = TH_SQUARED, .quality = -1}); },
                                 {"--quality -1"}));
}

}  // namespace
}  // namespace binosplat
