// Compares Th on the GPU with the reference's, for each eye and by depth.

#include <cmath>

#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;

constexpr double tolerance = 0.6;

// Returns Th of each Gaussian in one view, or 0 if the view does not draw it. `bounds` are by Gaussian.
std::vector<double> thresholds(const Model& model, const shared::View& view, Threshold threshold,
                               const std::vector<double>& bounds = {}) {
  std::vector<double> result(model.count());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const reference::Splat splat = reference::project(model, i, view);
    if (splat.drawn)
      result[i] = reference::threshold(threshold, tolerance, splat, bounds.empty() ? 1.0 : bounds[i]);
  }
  return result;
}

// The number of a view's splats whose Th is not the expected one, and the number of all compared splats.
// Splats beyond the picture's edge are not drawn and not compared.
struct Compared {
  int wrong = 0;
  int all = 0;
};
Compared compare_rho(const test::StageRun& run, std::uint32_t view, const Model& model,
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

TEST(ThresholdsByEye, EqualReferenceOfEachEye) {
  // The Gaussians are near and large, so that the eyes see different sizes.
  const Model model = test::random_model(91, 3000, 0);
  for (const double cant : {0.0, 5.0}) {
    const auto eyes =
        stereo::make_rig(test::front_camera(120, 90, 110), {.ipd = 0.3, .cant_degrees = cant}).views;
    for (const Threshold threshold : test::tolerant_rules) {
      const std::vector<double> expected[2] = {thresholds(model, eyes[0], threshold),
                                               thresholds(model, eyes[1], threshold)};
      test::StageRun run(model, {eyes[0], eyes[1]},
                         {{.tolerance = static_cast<float>(tolerance), .threshold = threshold}});
      run.run_until(render::Stage::project);
      // The stage runs once for each order group. Canted eyes are two groups, and the second one's splats
      // remain.
      for (std::uint32_t eye = cant == 0.0 ? 0 : 1; eye < 2; ++eye) {
        const Compared c = compare_rho(run, eye, model, expected[eye]);
        EXPECT_EQ(c.wrong, 0) << "of " << c.all;
        EXPECT_GT(c.all, 300);
        // Injected: the other eye's Th.
        EXPECT_GT(compare_rho(run, eye, model, expected[1 - eye]).wrong, c.all / 20);
      }
    }
  }
}

TEST(DepthTable, SetsTransmittanceByDepth) {
  const Model model = test::random_model(95, 3000, 0);
  const shared::View view = make_view(test::front_camera(120, 90, 110));
  // Depths reach 6. Beyond 4, and in an empty bin, the bound is 1. Equation 10 takes a small one as it is.
  const DepthTable table{4.0f, {0.5f, 0.003f, 0.0f, 0.8f}};
  std::vector<double> bounds, shifted;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const double z = reference::project(model, i, view).depth;
    const double of_bin[] = {0.5, 0.003, 1.0, 0.8, 1.0, 1.0, 1.0};
    bounds.push_back(of_bin[static_cast<int>(z)]);
    shifted.push_back(of_bin[static_cast<int>(z) + 1]);
  }
  const FrameSettings settings = {{.tolerance = static_cast<float>(tolerance),
                                   .threshold = Threshold::adagscale,
                                   .transmittance = Transmittance::depth,
                                   .depth_table = table}};
  test::StageRun run(model, {view}, settings);
  run.run_until(render::Stage::project);
  const Compared c = compare_rho(run, 0, model, thresholds(model, view, Threshold::adagscale, bounds));
  EXPECT_EQ(c.wrong, 0) << "of " << c.all;
  EXPECT_GT(c.all, 300);
  EXPECT_GT(compare_rho(run, 0, model, thresholds(model, view, Threshold::adagscale, shifted)).wrong,
            c.all / 5);

  reference::Settings reference_settings = {
      .threshold = Threshold::adagscale, .tolerance = tolerance, .bounds = bounds};
  EXPECT_GT(test::psnr(test::draw(model, view, settings), reference::render(model, view, reference_settings)),
            60.0);
  reference_settings.bounds = shifted;
  EXPECT_LT(test::psnr(test::draw(model, view, settings), reference::render(model, view, reference_settings)),
            60.0);
}

TEST(DepthTable, RejectsInvalidTables) {
  const Model model = test::random_model(96, 10, 0);
  const shared::View view = make_view(test::front_camera(32, 32, 32));
  for (const DepthTable& table : {DepthTable{}, DepthTable{0.0f, {1.0f}}, DepthTable{5.0f, {0.5f, 1.5f}},
                                  DepthTable{5.0f, {std::nanf("")}}}) {
    const FrameSettings settings = {{.tolerance = 1,
                                     .threshold = Threshold::squared,
                                     .transmittance = Transmittance::depth,
                                     .depth_table = table}};
    EXPECT_ERROR(test::draw(model, view, settings), "transmittance depth");
  }
}

}  // namespace
}  // namespace binosplat
