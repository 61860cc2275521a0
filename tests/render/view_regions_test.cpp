// View regions equal the same pixels of whole pictures, bit for bit.

#include <gtest/gtest-spi.h>

#include <algorithm>

#include "base/choices.h"
#include "render/faulty_shaders.h"
#include "render/stages.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::ViewRegion;
using test::draw;
using test::same_bits;

constexpr glm::ivec2 size{200, 150};

shared::View view_of_centre(double cx) {
  Camera camera = test::front_camera(size.x, size.y, 180);
  camera.cx = cx;
  return make_view(camera);
}

Picture cut(const Picture& whole, const glm::uvec2& corner, const glm::uvec2& extent) {
  Picture out(static_cast<int>(extent.x), static_cast<int>(extent.y));
  for (std::uint32_t y = 0; y < extent.y; ++y) {
    for (std::uint32_t x = 0; x < extent.x; ++x) {
      const std::size_t from = (corner.y + y) * static_cast<std::size_t>(whole.width) + corner.x + x;
      out.colour[y * extent.x + x] = whole.colour[from];
      out.z_sum[y * extent.x + x] = whole.z_sum[from];
    }
  }
  return out;
}

FrameSettings with(FrameSettings settings, std::vector<ViewRegion> parts) {
  settings.regions = std::move(parts);
  return settings;
}

// Returns whether windows of a picture, drawn in one frame, equal the same pixels of the whole picture.
testing::AssertionResult windows_are_right(const Model& model, const FrameSettings& settings) {
  const shared::View view = view_of_centre(87.3);
  const Picture whole = draw(model, view, settings);
  struct Window {
    glm::uvec2 corner, size, extent;
  };
  const Window windows[] = {
      {{64, 32}, {64, 96}, {64, 96}}, {{0, 96}, {96, 0}, {96, 54}}, {{160, 0}, {40, 32}, {40, 32}}};
  std::vector<ViewRegion> parts;
  for (const Window& window : windows) parts.push_back({.corner = window.corner, .size = window.size});
  const std::vector<Picture> drawn =
      draw(model, std::vector(std::size(windows), view), with(settings, parts));
  for (std::size_t k = 0; k < std::size(windows); ++k) {
    const auto same = same_bits(drawn[k], cut(whole, windows[k].corner, windows[k].extent));
    if (!same) return testing::AssertionFailure() << "window " << k << ": " << same.message();
  }
  return testing::AssertionSuccess();
}

TEST(ViewRegions, WindowsEqualWholePicture) {
  const Model model = test::random_model(41, 3000, 1, 0.75);
  EXPECT_TRUE(windows_are_right(model, test::squared(0.05f)));
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles)
    EXPECT_TRUE(windows_are_right(model, {.tiles = tiles})) << tiles_choices[tiles].name;
  EXPECT_TRUE(windows_are_right(
      model, {{.order = Order::distance, .projection = Projection::tangent}, TILES_ELLIPSE, PRECISION_HALF}));
  // Injected: a window beside its position.
  const test::FaultyShaders faulty("tiles/places.glsl", "view.shift_x, view.shift_y",
                                   "view.shift_x + 1u, view.shift_y");
  EXPECT_FALSE(windows_are_right(model, {}));
}

// Returns a region with a different range of columns in each row of tiles, some empty, and a hole.
ViewRegion ragged() {
  ViewRegion part{{.hole_begin = {50, 40}, .hole_end = {130, 150}}};
  const auto tiles = (size + TILE_SIZE - 1) / TILE_SIZE;
  for (int row = 0; row < tiles.y; ++row) {
    const std::uint32_t begin = row % 3, end = static_cast<std::uint32_t>(tiles.x - row % 4);
    part.columns.emplace_back(begin, row == 2 ? begin : std::max(begin, end));
  }
  return part;
}

// Returns whether a region shows a tile, computed differently than in the shaders.
bool shows(const ViewRegion& part, int x, int y) {
  const glm::uvec2 at(x / TILE_SIZE, y / TILE_SIZE), columns = part.columns[at.y];
  if (at.x < columns.x || at.x >= columns.y) return false;
  const glm::uvec2 first = at * std::uint32_t{TILE_SIZE};
  const glm::uvec2 end = glm::min(first + std::uint32_t{TILE_SIZE}, glm::uvec2(size));
  return glm::any(glm::lessThan(first, part.hole_begin)) || glm::any(glm::greaterThan(end, part.hole_end));
}

Picture masked(Picture whole, const ViewRegion& part) {
  for (int y = 0; y < whole.height; ++y) {
    for (int x = 0; x < whole.width; ++x) {
      const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * whole.width + x);
      if (shows(part, x, y)) continue;
      whole.colour[k] = {0, 0, 0, 1};
      whole.z_sum[k] = 0;
    }
  }
  return whole;
}

TEST(ViewRegions, HiddenPartsAreBackground) {
  const Model model = test::random_model(42, 3000, 1, 0.75);
  const std::vector views = {view_of_centre(100), view_of_centre(70)};
  for (const FrameSettings& settings :
       {FrameSettings{}, FrameSettings{.tiles = TILES_ALL},
        FrameSettings{
            {.tolerance = 0.05f, .threshold = Threshold::squared, .projection = Projection::tangent}}}) {
    const ViewRegion part = ragged();
    const std::vector<Picture> whole = draw(model, views, settings);
    const auto drawn = draw(model, views, with(settings, {part, {}}));
    EXPECT_TRUE(same_bits(drawn[0], masked(whole[0], part)));
    EXPECT_TRUE(same_bits(drawn[1], whole[1]));
    EXPECT_FALSE(same_bits(drawn[0], whole[0]));
  }
}

// Returns the lengths of the lists of a view's tiles, except of tiles in the hole.
std::vector<std::size_t> list_sizes(const Model& model, const FrameSettings& settings,
                                    const ViewRegion& shown) {
  test::StageRun run(model, {view_of_centre(100)}, settings);
  run.run_until(render::Stage::sort);
  const std::uint32_t across = run.plan.views.front().tiles_x;
  std::vector<std::size_t> sizes;
  for (const auto& list : run.lists()) {
    const auto x = static_cast<std::uint32_t>(sizes.size()) % across;
    const auto y = static_cast<std::uint32_t>(sizes.size()) / across;
    const auto in_span = shown.columns[y].x <= x && x < shown.columns[y].y;
    const bool is_shown = shows(shown, static_cast<int>(x) * TILE_SIZE, static_cast<int>(y) * TILE_SIZE);
    sizes.push_back(is_shown ? list.size() : 0);
    if (!is_shown && !in_span && !settings.regions.empty()) {
      EXPECT_EQ(list.size(), 0u) << x << " " << y;
    }
  }
  return sizes;
}

TEST(ViewRegions, HiddenPartsMakeNoPairs) {
  const Model model = test::random_model(43, 3000, 1, 0.75);
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    const FrameSettings whole{.tiles = tiles};
    const ViewRegion part = ragged();
    EXPECT_EQ(list_sizes(model, with(whole, {part}), part), list_sizes(model, whole, part))
        << tiles_choices[tiles].name;
  }
}

TEST(ViewRegions, MissingColumnIsDetected) {
  const Model model = test::random_model(43, 3000, 1, 0.75);
  const ViewRegion part = ragged();
  const auto right = list_sizes(model, {}, part);
  const test::FaultyShaders faulty("tiles/regions.glsl", "min(columns.y, drawn.y)",
                                   "min(columns.y, drawn.y - 1u)");
  testing::TestPartResultArray said;
  const bool same = [&] {
    const testing::ScopedFakeTestPartResultReporter caught(&said);
    return list_sizes(model, with({}, {part}), part) == right;
  }();
  EXPECT_FALSE(same && said.size() == 0);
}

TEST(ViewRegions, OnlyCrossingSplatsPairWithHole) {
  const Model model = test::random_model(44, 3000, 0, 0.75);
  render::Frame frame(test::gl_context(), model);
  const std::vector views = {view_of_centre(100)};
  const auto whole = frame.draw(views).pairs;
  const auto holed = frame.draw(views, with({}, {{{.hole_begin = {32, 32}, .hole_end = {176, 128}}}})).pairs;
  const double left = static_cast<double>(holed) / static_cast<double>(whole);
  EXPECT_LT(left, 0.75);  // the hole is 0.46 of the picture
  EXPECT_GT(left, 0.4);
}

// Splats in the earlier hole were not measured.
TEST(ViewRegions, MovedHoleIsCut) {
  const Model model = test::random_model(48, 3000, 0, 0.75);
  const FrameSettings last = test::squared(0.3f, Transmittance::last);
  const FrameSettings before = with(last, {{{.hole_begin = {32, 32}, .hole_end = {96, 96}}}});
  const FrameSettings now = with(last, {{{.hole_begin = {64, 32}, .hole_end = {128, 96}}}});
  const std::vector views = {view_of_centre(100)};
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 3; ++n) frame.draw(views, before);
  EXPECT_TRUE(frame.draw(views, before).used_last);
  const FrameSettings same_tiles = with(last, {{{.hole_begin = {30, 31}, .hole_end = {97, 98}}}});
  EXPECT_TRUE(frame.draw(views, same_tiles).used_last) << "of which only whole tiles count";
  EXPECT_FALSE(frame.draw(views, now).used_last);
  EXPECT_TRUE(same_bits(frame.read_pictures().front(), draw(model, views[0], now)));
  EXPECT_FALSE(frame.draw(views, last).used_last) << "nor where there is none";
}

TEST(ViewRegions, ViewsUseShareOfTolerance) {
  const Model model = test::random_model(45, 4000, 1, 0.75);
  const std::vector views = {view_of_centre(100), view_of_centre(100), view_of_centre(100)};
  for (const Threshold threshold : test::tolerant_rules) {
    FrameSettings settings{{.tolerance = 0.1f, .threshold = threshold}};
    const auto drawn =
        draw(model, views,
             with(settings,
                  {{{.tolerance_share = 0.0f}}, {{.tolerance_share = 1.0f}}, {{.tolerance_share = 4.0f}}}));
    EXPECT_TRUE(same_bits(drawn[0], draw(model, views[0])));
    EXPECT_TRUE(same_bits(drawn[1], draw(model, views[0], settings)));
    settings.tolerance = 0.4f;
    EXPECT_TRUE(same_bits(drawn[2], draw(model, views[0], settings)));
    EXPECT_FALSE(same_bits(drawn[1], drawn[2]));
    EXPECT_FALSE(same_bits(drawn[0], drawn[1]));
  }
}

// Returns the coverage of one small Gaussian in the middle of a picture that is `width` px wide.
float middle_coverage(const Model& model, int width, const ViewRegion& part, Projection projection) {
  const Camera camera = test::front_camera(width, width, 3.0 * width);
  const Picture drawn = draw(model, make_view(camera), with({{.projection = projection}}, {part}));
  const auto middle = static_cast<std::size_t>(std::ptrdiff_t{width} / 2 * width + width / 2);
  return 1.0f - drawn.colour[middle].a;
}

TEST(ViewRegions, SmallerViewsKeepBrightness) {
  constexpr double scale = 0.004, opacity = 0.8;
  Model model;
  test::add(model, {0, 0, 2}, glm::vec3(scale), opacity);
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    // In odd sizes the Gaussian's mean is a pixel's centre. Its variance in px^2, with 41 px instead of 101:
    const double small = std::pow(41 * 3.0 * scale / 2, 2), share = std::pow(41.0 / 101, 2);
    const ViewRegion part{{.low_pass_share = static_cast<float>(share)}};
    const double expected = opacity * (small + share * KERNEL_PX2) / (small + KERNEL_PX2);
    EXPECT_NEAR(middle_coverage(model, 41, part, projection), expected, 1e-5) << name_of(projection);
    // Injected: the low-pass as trained, for 101 px.
    EXPECT_NEAR(middle_coverage(model, 41, {}, projection), opacity, 1e-5);
    EXPECT_GT(opacity, 1.5 * expected);
    model.antialiased = true;  // antialiased models compensate the low-pass themselves
    EXPECT_EQ(middle_coverage(model, 41, part, projection), middle_coverage(model, 41, {}, projection));
    model.antialiased = false;
  }
}

// Returns two views of each eye: one with fewer pixels, and one for a window.
std::vector<shared::View> four_views(double cant) {
  const Camera head = test::front_camera(size.x, size.y, 180);
  const auto rig = stereo::make_rig(head, {.ipd = 0.1, .cant_degrees = cant});
  std::vector<shared::View> views;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    views.push_back(rig.views[eye]);
    set_lens(views.back(), resized(rig.cameras[eye], 80, 60));
    views.push_back(rig.views[eye]);
  }
  return views;
}

TEST(ViewRegions, InsetsShareDepthOrderOfTheirEye) {
  const Model model = test::random_model(46, 3000, 1, 0.75);
  const ViewRegion inset{.corner = {64, 32}, .size = {64, 64}};
  for (const double cant : {0.0, 6.0}) {
    for (const Order order : {Order::depth, Order::distance}) {
      const FrameSettings settings = with({{.order = order}}, {{}, inset, {}, inset});
      const auto views = four_views(cant);
      render::Frame frame(test::gl_context(), model);
      const auto report = frame.draw(views, settings);
      EXPECT_EQ(report.order_groups, cant != 0.0 && order == Order::depth ? 2u : 1u)
          << cant << " " << name_of(order);
      const auto drawn = frame.read_pictures();
      for (std::size_t v = 0; v < views.size(); ++v) {
        const Picture alone = draw(model, views[v], {{.order = order}});
        EXPECT_TRUE(same_bits(drawn[v], v % 2 == 0 ? alone : cut(alone, inset.corner, inset.size))) << v;
      }
    }
  }
  // Injected: an inset with the other eye's view.
  auto views = four_views(6.0);
  std::swap(views[1], views[3]);
  render::Frame frame(test::gl_context(), model);
  EXPECT_EQ(frame.draw(views, with({}, {{}, inset, {}, inset})).order_groups, 3u);
}

TEST(ViewRegions, ProbeMeasuresShownPart) {
  const Model model = test::random_model(97, 3000, 1);
  const std::vector views = {view_of_centre(100)};
  const ViewRegion part = ragged();
  const auto exact = draw(model, views[0], with({}, {part}));
  render::Frame frame(test::gl_context(), model);
  frame.draw_until(render::Stage::probe, views, with(test::squared(2.0f), {part}), {}, render::Probe{});
  const auto shown = [](const Picture& picture) { return quantised(composite(picture, glm::vec3(0.0f))); };
  const double db = measure::psnr(shown(frame.read_pictures().front()), shown(exact));
  const auto counters = frame.buffers().counters.read<shared::Counters>(1).front();
  const render::ProbeResult probe = render::probe_result(frame.plan(), counters);
  EXPECT_NEAR(-10.0 * std::log10(probe.squared_error), db, 0.01);
  EXPECT_LT(db, 50.0);
  EXPECT_LT(probe.pairs, probe.exact_pairs);
}

TEST(ViewRegions, RejectInvalidRegions) {
  const Model model = test::random_model(47, 10, 0);
  const auto said = [&](const ViewRegion& part, const FrameSettings& settings = {}) {
    return [=, &model] { draw(model, view_of_centre(100), with(settings, {part})); };
  };
  EXPECT_TRUE(test::fails_saying(
      [&] {
        draw(model, view_of_centre(100), with({}, {{}, {}}));
      },
      {"2 regions for 1 views"}));
  EXPECT_TRUE(test::fails_saying(said({.corner = {16, 0}}), {"from (16, 0)", "multiples of 32"}));
  EXPECT_TRUE(test::fails_saying(said({.size = {40, 32}}), {"40 x 32", "multiples of 32"}));
  EXPECT_TRUE(test::fails_saying(said({.corner = {224, 0}}), {"from (224, 0) of 200 x 150"}));
  EXPECT_TRUE(test::fails_saying(said({.corner = {64, 0}, .size = {0xFFFFFFE0u, 32}}), {"a window of"}));
  EXPECT_TRUE(
      test::fails_saying(said({{.columns = {{0, 1}}}}), {"columns for 1 rows", "10 (tiles of 16 px)"}));
  EXPECT_TRUE(
      test::fails_saying(said({{.columns = std::vector<glm::uvec2>(10, {0, 14})}}), {"0 to 14", "13"}));
  EXPECT_TRUE(test::fails_saying(said({{.columns = std::vector<glm::uvec2>(10, {3, 2})}}), {"3 to 2"}));
  EXPECT_TRUE(
      test::fails_saying(said({{.hole_begin = {0, 0}, .hole_end = {8, 151}}}), {"hole", "200 x 150"}));
  EXPECT_TRUE(test::fails_saying(said({{.tolerance_share = -1.0f}}), {"tolerance_share -1"}));
  EXPECT_TRUE(test::fails_saying(said({{.low_pass_share = 0.0f}}), {"low_pass_share 0"}));
  EXPECT_TRUE(test::fails_saying(
      said({{.tolerance_share = 2.0f}}, {{.quality = 40, .threshold = Threshold::squared}}),
      {"a quality excludes windows"}));
  EXPECT_TRUE(test::fails_saying(
      [&] {
        draw(model, view_of_centre(100), with({}, {{.corner = {32, 0}}}),
             test::given(render::Stage::project));
      },
      {"reference-until", "draws only whole views"}));
}

}  // namespace
}  // namespace binosplat
