// Probes (error samples): tiles of a view that a frame draws a second time, to estimate the view's error.

#include "render/stages.h"
#include "render/support.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::Probe;

constexpr glm::vec3 background{0.2f, 0.4f, 0.6f};

// A frame with a probe, drawn up to the stage probe.
struct ProbeRun {
  ProbeRun(const Model& model, const std::vector<shared::View>& views, const FrameSettings& settings,
           const std::optional<Probe>& probe, bool exact = false)
      : run(model, views, settings, probe) {
    run.exact = exact;
    run.run_until(render::Stage::probe);
    const auto counters = run.frame.counters.read<shared::Counters>(1).front();
    EXPECT_EQ(counters.overflow, 0u);
    if (probe) error = render::probe_result(run.plan, counters).squared_error;
  }

  Picture picture(std::uint32_t v) const {
    const shared::View& view = run.plan.views.at(v);
    Picture out(static_cast<int>(view.width), static_cast<int>(view.height));
    out.colour = run.frame.pictures.colours.read<glm::vec4>(out.colour.size(), view.pixel_offset);
    return out;
  }

  test::StageRun run;
  double error = 0.0;
};

// Returns a picture as a screen shows it.
Image shown_image(const Picture& picture) { return quantised(composite(picture, background)); }

// Returns the mean squared error over a probe's tiles, which the probe must report.
double error_in(const Probe& probe, const Picture& drawn, const Picture& exact) {
  const Image a = shown_image(drawn), b = shown_image(exact);
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const auto column = static_cast<std::uint32_t>(x / TILE_SIZE),
                 row = static_cast<std::uint32_t>(y / TILE_SIZE);
      if (column % probe.step != probe.column || row % probe.step != probe.row) continue;
      for (int c = 0; c < 3; ++c, ++count) sum += std::pow(double{a.at(x, y, c)} - b.at(x, y, c), 2);
    }
  }
  return sum / static_cast<double>(count);
}

// Returns all probes with these steps that begin within a picture of `across` x `down` tiles; the views
// alternate.
std::vector<Probe> probes(std::initializer_list<std::uint32_t> steps, std::uint32_t across,
                          std::uint32_t down) {
  std::vector<Probe> all;
  for (const std::uint32_t step : steps) {
    for (std::uint32_t row = 0; row < std::min(step, down); ++row) {
      for (std::uint32_t column = 0; column < std::min(step, across); ++column)
        all.push_back({static_cast<std::uint32_t>(all.size() % 2), step, column, row});
    }
  }
  return all;
}

std::uint32_t tiles_along(int pixels) {
  return static_cast<std::uint32_t>((pixels + TILE_SIZE - 1) / TILE_SIZE);
}

std::vector<shared::View> eyes_for_probe(int width, int height, double cant = 0.0) {
  const auto rig = stereo::make_rig(test::front_camera(width, height, width),
                                    {.ipd = 0.1, .units_per_metre = 1.0, .cant_degrees = cant});
  return {rig.views.begin(), rig.views.end()};
}

// Draws with settings without tolerance: a probe must find no error.
void expect_no_error(const Model& model, const FrameSettings& settings, double cant) {
  constexpr int width = 100, height = 83;  // the last tiles of a row and a column are cut by the edge
  const auto views = eyes_for_probe(width, height, cant);
  for (const Probe& probe : probes({1, 2}, tiles_along(width), tiles_along(height))) {
    EXPECT_EQ(ProbeRun(model, views, settings, probe).error, 0.0)
        << tiles_choices[settings.tiles].name << ", cant " << cant << ", view " << probe.view << ", step "
        << probe.step << " from (" << probe.column << ", " << probe.row << ")";
  }
}

TEST(Probe, ExactTilesHaveNoError) {
  const Model model = test::random_model(101, 1500, 1);
  for (const double cant : {0.0, 4.0})
    expect_no_error(model, {{.background = background, .threshold = Threshold::squared}}, cant);
}

TEST(Probe, ExactTileTestsHaveNoError) {
  const Model model = test::random_model(102, 1500, 0);
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles)
    expect_no_error(model, {{.background = background, .threshold = Threshold::adagscale}, tiles},
                    4.0 * (tiles % 2));
}

TEST(Probe, MeasuresDisplayedErrorOfTiles) {
  const Model model = test::random_model(108, 2000, 1);
  constexpr int width = 100, height = 83;
  for (const double cant : {0.0, 4.0}) {
    const auto views = eyes_for_probe(width, height, cant);
    const FrameSettings settings = {
        {.background = background, .tolerance = 0.3f, .threshold = Threshold::squared}};
    const auto exact = test::draw(model, views, {{.background = background}});
    int differing = 0;
    const std::uint32_t across = tiles_along(width);
    const auto all = probes({1, 3}, across, tiles_along(height));
    for (const Probe& probe : all) {
      const ProbeRun run(model, views, settings, probe);
      const Picture drawn = run.picture(probe.view);
      const double expected = error_in(probe, drawn, exact[probe.view]);
      EXPECT_GT(expected, 1e-6);
      EXPECT_NEAR(run.error, expected, 2e-3 * expected)
          << cant << " " << probe.step << " " << probe.column << " " << probe.row;
      // Injected fault: the neighbouring tiles.
      Probe beside = probe;
      beside.column = (probe.column + 1) % std::min(probe.step, across);
      const double other = error_in(beside, drawn, exact[probe.view]);
      differing += std::abs(run.error - other) > 0.02 * expected ? 1 : 0;
    }
    EXPECT_GE(differing + 2, static_cast<int>(all.size()));  // step 1 has only one probe
  }
}

TEST(Probe, IsRightForLongLists) {
  const Model model = test::long_lists_model();
  const auto views = eyes_for_probe(64, 48);
  const auto exact = test::draw(model, views, {{.background = background}});
  for (const float tolerance : {0.0f, 0.02f}) {
    const FrameSettings settings = {
        {.background = background, .tolerance = tolerance, .threshold = Threshold::squared}};
    for (const Probe& probe : probes({1, 2}, 4, 3)) {
      const ProbeRun run(model, views, settings, probe);
      if (probe.step == 1) {
        EXPECT_GT(run.run.frame.counters.read<shared::Counters>(1).front().long_lists, 0u);
      }
      const double expected = error_in(probe, run.picture(probe.view), exact[probe.view]);
      EXPECT_NEAR(run.error, expected, 2e-3 * expected) << tolerance;
      EXPECT_EQ(expected > 0.0, tolerance > 0.0f);
    }
  }
}

TEST(Probe, LeavesPicturesAndMeasurementsUnchanged) {
  const Model model = test::random_model(105, 2000, 1);
  const auto views = eyes_for_probe(96, 80);
  for (const FrameSettings& settings :
       {FrameSettings{{.threshold = Threshold::squared, .transmittance = Transmittance::last}},
        FrameSettings{{.threshold = Threshold::adagscale, .transmittance = Transmittance::last}}}) {
    FrameSettings lossy = settings;
    lossy.tolerance = 0.05f;
    const ProbeRun without(model, views, lossy, {});
    for (const Probe& probe : probes({2}, 6, 5)) {
      const ProbeRun with(model, views, lossy, probe);
      for (std::uint32_t eye = 0; eye < 2; ++eye)
        EXPECT_TRUE(test::same_bits(with.picture(eye), without.picture(eye))) << probe.step;
      const std::size_t all = 2 * model.count();
      EXPECT_EQ(with.run.frame.transmittance.bounds->read<float>(all),
                without.run.frame.transmittance.bounds->read<float>(all));
    }
  }
}

// A front that hides nearly everything, so that blocks of the approximate blend end dark.
TEST(Probe, ExactFrameMeasuresSameError) {
  test::Uniform uniform(3);
  Model model;
  for (int i = 0; i < 3000; ++i) {
    const double z = uniform(1.0, 6.0);
    test::add(model, glm::vec3(uniform(-0.5, 0.5) * z, uniform(-0.5, 0.5) * z, z),
              glm::vec3(0.08f * static_cast<float>(z)), 0.5f,
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)));
  }
  const auto views = eyes_for_probe(96, 80);
  for (const float tolerance : {0.01f, 0.1f, 1.0f}) {
    const FrameSettings settings = test::squared(tolerance);
    for (const Probe& probe : probes({1, 2}, 6, 5)) {
      const ProbeRun frame(model, views, settings, probe), sample(model, views, settings, probe, true);
      EXPECT_EQ(frame.error, sample.error) << tolerance << " " << probe.step;
      EXPECT_GT(frame.error, 0.0);
    }
  }
}

TEST(Quality, FramesEqualReportedTolerance) {
  const Model model = test::random_model(99, 3000, 1);
  const auto views = eyes_for_probe(192, 160);
  FrameSettings settings{{.quality = 38, .threshold = Threshold::squared}};
  settings.probe_tiles = 24;
  render::Frame steered(test::gl_context(), model), given(test::gl_context(), model);
  int exact_with_probe = 0, inexact_with_probe = 0, inexact = 0;
  for (int n = 0; n < 40; ++n) {
    const Report report = steered.draw(views, settings);
    const bool exact = report.exact != ExactReason::not_exact;
    EXPECT_EQ(exact, report.tolerance == 0.0f);
    (exact ? exact_with_probe : inexact_with_probe) += report.sampled_error ? 1 : 0;
    inexact += exact ? 0 : 1;
    const FrameSettings same = exact ? FrameSettings{} : test::squared(report.tolerance);
    const Report other = given.draw(views, same);
    EXPECT_EQ(report.pairs > other.pairs, report.sampled_error) << n;  // includes the probe's pairs
    const auto a = steered.read_pictures(), b = given.read_pictures();
    ASSERT_EQ(a.size(), 2u);
    for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(test::same_bits(a[eye], b[eye])) << n;
  }
  EXPECT_GT(exact_with_probe, 0);
  EXPECT_GT(inexact_with_probe, 0);
  EXPECT_GT(inexact, inexact_with_probe);
}

TEST(Quality, UnseenModelIsUnmeasured) {
  const Model one = test::random_model(99, 3000, 1), other = test::random_model(98, 3000, 1);
  const auto first = std::make_shared<render::GpuModel>(test::gl_context(), one);
  const auto second = std::make_shared<render::GpuModel>(test::gl_context(), other);
  const auto views = eyes_for_probe(192, 160);
  FrameSettings settings{{.quality = 38, .threshold = Threshold::squared}};
  settings.probe_tiles = 24;
  render::Frame frame(first);
  const auto settle = [&] {
    for (int n = 0; n < 60; ++n)
      if (frame.draw(views, settings).exact == ExactReason::not_exact) return true;
    return false;
  };
  ASSERT_TRUE(settle());
  EXPECT_EQ(frame.draw(views, settings).exact, ExactReason::not_exact);
  frame.draw(views);  // a frame without a quality, of any motion
  EXPECT_EQ(frame.draw(views, settings).exact, ExactReason::unmeasured);
  ASSERT_TRUE(settle());
  frame.place({{.model = second}});
  EXPECT_EQ(frame.draw(views, settings).exact, ExactReason::unmeasured) << "another model";
}

}  // namespace
}  // namespace binosplat
