// The library's settings and report equal those of a render::Frame.

#include "library/conversions.h"

#include <cmath>

#include "library/renderer_fixture.h"
#include "stereo/eyes.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

TEST(LibrarySettings, MatchFrameSettings) {
  const std::array<View, 2> views;
  const auto of = [&](const Settings& settings) { return library::frame_settings(settings, views); };
  const render::FrameSettings plain = of({});
  EXPECT_TRUE(render::is_exact(render::chosen_threshold(plain)));
  EXPECT_FALSE(plain.has_depths) << "nobody asked for depths";
  EXPECT_FALSE(plain.order || plain.projection);
  EXPECT_TRUE(plain.regions.empty());
  EXPECT_EQ(render::chosen_threshold(of({.quality = 40.0f})), Threshold::squared);
  EXPECT_EQ(of({.quality = 40.0f}).quality, 40.0f);
  EXPECT_EQ(render::chosen_threshold(of({.tolerance = 0.5f})), Threshold::adagscale);
  EXPECT_EQ(of({.tolerance = 0.5f}).tolerance, 0.5f);
  EXPECT_EQ(of({.quality = 40.0f, .transmittance = Transmittance::last}).transmittance, Transmittance::last);
  EXPECT_EQ(of({.order = Order::distance}).order, Order::distance);
  EXPECT_EQ(of({.projection = Projection::tangent}).projection, Projection::tangent);
  EXPECT_EQ(of(Settings::headset()).order, Order::distance);
  EXPECT_EQ(of(Settings::headset()).projection, Projection::tangent);
  EXPECT_EQ(of({.background = glm::vec3(0.5f)}).background, glm::vec3(0.5f));
  std::array<View, 2> with_depth;
  for (View& view : with_depth) view.depth = DepthTarget{};
  EXPECT_TRUE(library::frame_settings({}, with_depth).has_depths);
  EXPECT_EQ(library::frame_settings({.depth = DepthKind::median}, with_depth).depth, DepthKind::median);
}

TEST(LibrarySettings, RejectContradictions) {
  const std::pair<Settings, const char*> cases[] = {
      {{.quality = 40.0f, .tolerance = 1.0f}, "leave one of them out"},
      {{.quality = 40.0f, .threshold = Threshold::exact}, "an exact settings.threshold"},
      {{.tolerance = 1.0f, .threshold = Threshold::exact}, "settings.tolerance"},
      {{.threshold = Threshold::squared}, "settings.tolerance, settings.quality or a calibration"},
      {{.quality = 0.0f}, "settings.quality 0: expected decibels"},
      {{.quality = 400.0f}, "settings.quality 400: expected decibels from 10 to 100"},
      {{.tolerance = NAN}, "zero or more"},
      {{.transmittance = Transmittance::last}, "settings.transmittance last has no effect"},
      {{.threshold = static_cast<Threshold>(77)}, "settings.threshold 77"},
      {{.transmittance = static_cast<Transmittance>(77)}, "settings.transmittance 77"},
      {{.order = static_cast<Order>(-1)}, "settings.order -1"},
      {{.projection = static_cast<Projection>(2)}, "settings.projection 2"},
      {{.depth = static_cast<DepthKind>(77)}, "settings.depth 77"},
  };
  for (const auto& [settings, said] : cases)
    EXPECT_TRUE(test::fails_saying([&, s = settings] { library::frame_settings(s, {}); }, {said}));
  for (const int none : {77, LAYOUT_MULTI_VIEW})
    EXPECT_ERROR(library::layout_of(static_cast<Layout>(none)), "layout ");
  EXPECT_ERROR(library::precision_of(static_cast<Precision>(2)), "precision 2");
}

// tests/render/half_test.cpp compares half with full precision.
TEST_F(Library, HalfPrecisionTakesLessMemory) {
  const SplatModel model = in_memory(test::random_model(3, 4000, 3));
  Renderer full(caller.get_proc_address(), model), half(caller.get_proc_address(), model, Precision::half);
  const auto bytes = full.draw(views(), placement, over_black).gpu_bytes;
  const std::vector<float> drawn = read(0);
  EXPECT_LT(half.draw(views(), placement, over_black).gpu_bytes, bytes);
  EXPECT_NE(read(0), drawn);
}

TEST_F(Library, RegionsAndReportsMatchFrame) {
  const Model model = test::random_model(3, 400, 2);
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  std::vector<View> pair = views();
  const Settings settings = {.tolerance = 0.5f, .threshold = Threshold::squared};
  pair[1].region.hole_begin = {16, 16};
  pair[1].region.hole_end = {48, 32};
  pair[1].region.tolerance_share = 0.0f;
  const Report report = renderer.draw(pair, placement, settings);
  const std::vector<float> with_hole = read(1);
  const auto row = [](int from_top) {
    return 4 * static_cast<std::size_t>((size.y - 1 - from_top) * size.x);
  };
  for (int x = 16; x < 48; ++x)
    EXPECT_EQ(with_hole[row(20) + 4 * static_cast<std::size_t>(x) + 3], 0.0f) << x;

  render::Frame frame(*caller.context, model);
  render::FrameSettings same;
  same.threshold = Threshold::squared;
  same.tolerance = 0.5f;
  same.has_depths = false;
  same.regions = {render::ViewRegion{}, render::ViewRegion{}};
  same.regions[1].hole_begin = pair[1].region.hole_begin;
  same.regions[1].hole_end = pair[1].region.hole_end;
  same.regions[1].tolerance_share = 0.0f;
  const auto drawn = stereo::views_from_xr(quest_eyes(), placement, std::array{size, size});
  const Report expected = frame.draw(drawn, same);
  EXPECT_EQ(report.pairs, expected.pairs);
  EXPECT_EQ(report.visible, expected.visible);
  EXPECT_EQ(report.tolerance, 0.5f);
  EXPECT_GT(report.gpu_bytes, 0);
  EXPECT_EQ(report.stages.size(), expected.stages.size());
  const Report whole = renderer.draw(views(), placement, settings);
  EXPECT_GT(whole.pairs, 0u);
  EXPECT_NE(whole.pairs, report.pairs) << "regions go unnoticed";
  EXPECT_NE(read(1), with_hole);
}

TEST_F(Library, ReportsHaveOverlayValues) {
  const Model model = test::random_model(3, 400, 2);
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const Report first = renderer.draw(views(), placement, {.quality = 40.0f});
  EXPECT_EQ(first.exact, ExactReason::small);
  EXPECT_GT(first.new_programs, 0);
  Report next;
  for (int n = 0; n < 8; ++n) next = renderer.draw(views(), placement, {.quality = 40.0f});
  EXPECT_EQ(next.new_programs, 0);
  for (const Report& report : {first, next}) {
    double of_spans = 0.0;
    for (const StageSpan& span : report.spans) of_spans += span.ms();
    EXPECT_NEAR(of_spans, report.gpu_ms, 1e-6) << "nothing overflowed";
    EXPECT_GE(report.spans.size(), 4u);
    for (const double ms : {report.plan_ms, report.upload_ms, report.submit_ms, report.read_ms})
      EXPECT_GT(ms, 0.0);
    EXPECT_GE(report.wait_ms, 0.0);
  }
}

}  // namespace
}  // namespace binosplat
