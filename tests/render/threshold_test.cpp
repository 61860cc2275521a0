// Th on the GPU against the reference's: by depth, and shared between eyes.

#include <algorithm>
#include <cmath>

#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;

constexpr double loss = 0.6;

stereo::EyePair rig() { return stereo::make_rig(test::front_camera(120, 90, 110), {.ipd = 0.3}); }

// Th of every Gaussian by itself as one view has it, 0 where it does not draw it. `upper` by Gaussian.
std::vector<double> thresholds(const Model& model, const shared::View& view, int th,
                               const std::vector<double>& upper = {}) {
  std::vector<double> result(model.count());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const reference::Splat splat = reference::project(model, i, view);
    if (splat.drawn) result[i] = reference::threshold(th, loss, splat, upper.empty() ? 1.0 : upper[i]);
  }
  return result;
}

// How many splats of a view go by another Th than the one expected, and how many were compared. What a
// picture's edge cuts off is not drawn and not compared.
struct Compared {
  int wrong = 0;
  int all = 0;
};
Compared compare(const test::StageRun& run, std::uint32_t view, const Model& model,
                 const std::vector<double>& expected) {
  const auto [splats, tiles] = run.projected(view);
  Compared result;
  for (std::size_t i = 0; i < model.count(); ++i) {
    if (tiles[i] == 0) continue;
    const double rho = 2 * std::log(model.opacity[i] / expected[i]);
    ++result.all;
    if (!(std::abs(splats[i].colour.w - rho) <= 1e-4 * (1 + std::abs(rho)))) ++result.wrong;
  }
  return result;
}

std::vector<double> smaller(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (b[i] > 0) a[i] = std::min(a[i], b[i]);
  }
  return a;
}

TEST(ThEyes, EachEyeGoesByItsOwnOrTheSmallerOrTheOneBetween) {
  // Near and large, so that the eyes see different sizes.
  const Model model = test::random_model(91, 3000, 0);
  const auto eyes = rig().views;
  const shared::View between = stereo::make_rig(test::front_camera(120, 90, 110), {.ipd = 0}).views[0];
  for (const int th : {TH_PERIPHERAL, TH_SQUARED}) {
    const auto left = thresholds(model, eyes[0], th), right = thresholds(model, eyes[1], th);
    const auto both = smaller(left, right), middle = thresholds(model, between, th);
    const std::vector<double>* expected[3][2] = {{&left, &right}, {&both, &both}, {&middle, &middle}};
    for (const int th_eyes : {TH_EYES_PER_EYE, TH_EYES_SHARED_MIN, TH_EYES_CYCLOPEAN}) {
      test::StageRun run(model, {eyes[0], eyes[1]},
                         {.th = th, .th_eyes = th_eyes, .loss = static_cast<float>(loss)});
      run.run_until(render::Stage::project);
      for (std::uint32_t eye = 0; eye < 2; ++eye) {
        const Compared c = compare(run, eye, model, *expected[th_eyes][eye]);
        EXPECT_EQ(c.wrong, 0) << th_eyes_choices[th_eyes].name << " of " << c.all;
        EXPECT_GT(c.all, 300);
        // Every other choice would be told apart.
        for (int other = 0; other < 3; ++other) {
          if (other == th_eyes) continue;
          EXPECT_GT(compare(run, eye, model, *expected[other][eye]).wrong, c.all / 20);
        }
      }
    }
  }
}

TEST(ThEyes, CantedEyesShareTheirTh) {
  const Model model = test::random_model(92, 3000, 0);
  const auto eyes = stereo::make_rig(test::front_camera(120, 90, 110), {.ipd = 0.3, .cant_degrees = 5}).views;
  const auto both = smaller(thresholds(model, eyes[0], TH_SQUARED), thresholds(model, eyes[1], TH_SQUARED));
  test::StageRun run(model, {eyes[0], eyes[1]},
                     {.th = TH_SQUARED, .th_eyes = TH_EYES_SHARED_MIN, .loss = static_cast<float>(loss)});
  run.run_until(render::Stage::project);
  // The stage runs once an order group, and the last one's splats are in the order of its own indices.
  const Compared c = compare(run, 1, model, both);
  EXPECT_EQ(c.wrong, 0);
  EXPECT_GT(c.all, 300);
}

TEST(ThEyes, LossOfZeroIsExactBitForBit) {
  const Model model = test::random_model(93, 3000, 1);
  const auto eyes = rig().views;
  const std::vector views(eyes.begin(), eyes.end());
  const auto exact = test::draw(model, views);
  for (const int th_eyes : {TH_EYES_SHARED_MIN, TH_EYES_CYCLOPEAN}) {
    for (const int th : {TH_PERIPHERAL, TH_SQUARED}) {
      const auto drawn = test::draw(model, views, {.th = th, .th_eyes = th_eyes});
      for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(test::same_bits(drawn[eye], exact[eye]));
    }
  }
}

TEST(ThEyes, ViewsWithoutAPartnerAreRefused) {
  const Model model = test::random_model(94, 10, 0);
  const shared::View view = make_view(test::front_camera(32, 32, 32));
  EXPECT_TRUE(test::fails_saying(
      [&] { test::draw(model, view, {.th = TH_SQUARED, .th_eyes = TH_EYES_CYCLOPEAN, .loss = 1}); },
      {"--th-eyes cyclopean", "both eyes"}));
}

TEST(DepthTable, EachDepthHasItsTransmittance) {
  const Model model = test::random_model(95, 3000, 0);
  const shared::View view = make_view(test::front_camera(120, 90, 110));
  // Depths reach 6: what lies beyond 4 gets all light, and so does an empty bin; 0.001 is floored.
  const render::DepthTable table{4.0f, {0.5f, 0.001f, 0.0f, 0.8f}};
  std::vector<double> upper, shifted;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const double z = reference::project(model, i, view).depth;
    const double of_bin[] = {0.5, UPPER_FLOOR, 1.0, 0.8, 1.0, 1.0, 1.0};
    upper.push_back(of_bin[static_cast<int>(z)]);
    shifted.push_back(of_bin[static_cast<int>(z) + 1]);
  }
  const FrameSettings settings = {.th = TH_PERIPHERAL,
                                  .transmittance = TRANSMITTANCE_DEPTH,
                                  .depth_table = table,
                                  .loss = static_cast<float>(loss)};
  test::StageRun run(model, {view}, settings);
  run.run_until(render::Stage::project);
  const Compared c = compare(run, 0, model, thresholds(model, view, TH_PERIPHERAL, upper));
  EXPECT_EQ(c.wrong, 0) << "of " << c.all;
  EXPECT_GT(c.all, 300);
  EXPECT_GT(compare(run, 0, model, thresholds(model, view, TH_PERIPHERAL, shifted)).wrong, c.all / 5);

  reference::Settings judged = {.th = TH_PERIPHERAL, .loss = loss, .upper = upper};
  EXPECT_GT(test::psnr(test::draw(model, view, settings), reference::render(model, view, judged)), 60.0);
  judged.upper = shifted;
  EXPECT_LT(test::psnr(test::draw(model, view, settings), reference::render(model, view, judged)), 60.0);
}

TEST(DepthTable, OneThatMakesNoSenseIsNamed) {
  const Model model = test::random_model(96, 10, 0);
  const shared::View view = make_view(test::front_camera(32, 32, 32));
  for (const render::DepthTable& table :
       {render::DepthTable{}, render::DepthTable{0.0f, {1.0f}}, render::DepthTable{5.0f, {0.5f, 1.5f}},
        render::DepthTable{5.0f, {std::nanf("")}}}) {
    const FrameSettings settings = {
        .th = TH_SQUARED, .transmittance = TRANSMITTANCE_DEPTH, .depth_table = table, .loss = 1};
    EXPECT_TRUE(test::fails_saying([&] { test::draw(model, view, settings); }, {"--transmittance depth"}));
  }
}

}  // namespace
}  // namespace binosplat
