// Compares the blend's debug views (Frame::read_debug_view) with the reference's counts for the same lists.

#include "base/choices.h"
#include "base/error.h"
#include "reference/blend_pixel.h"
#include "render/support.h"

namespace binosplat {
namespace {

constexpr int show_width = 96, show_height = 80;

/// Returns layers dense enough that some pixels end early.
Model layers_to_show() {
  Model model = test::random_model(61, 1500, 0);
  for (int i = 0; i < 40; ++i)
    test::add(model, {0, 0.2, 0.8 + 0.001 * i}, glm::vec3(0.08f), 0.6f, glm::vec3(0.5f));
  return model;
}

struct ShowTest : testing::Test {
  const Model model = layers_to_show();
  shared::View view = make_view(test::front_camera(show_width, show_height, 60));
  std::vector<reference::Splat> splats;
  reference::TileLists lists;
  std::vector<double> light;
  render::Frame frame{test::gl_context(), model};

  ShowTest() {
    splats = reference::project_all(model, view);
    lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
    light = reference::measure_transmittance(splats, lists, view);
  }

  double median_depth(std::span<const std::uint32_t> list, int x, int y) const {
    double depth = -1.0;
    reference::blend_pixel(splats, list, {x, y}, {},
                           [&](std::uint32_t i, double alpha, const auto& before, auto verdict) {
                             const bool is_half = before.transmittance * (1.0 - alpha) < 0.5;
                             if (verdict == reference::Verdict::blended && is_half && depth < 0.0)
                               depth = reference::depth_at(splats[i], x, y);
                           });
    return depth;
  }

  double expected(int what, int x, int y) const {
    const auto list = lists.at_pixel(x, y);
    if (what == SHOW_PAIRS) return static_cast<double>(list.size());
    const reference::PixelTrace trace = reference::trace(splats, list, x, y);
    if (what == SHOW_ALPHAS) return static_cast<double>(trace.walked);
    if (what == SHOW_VISIBLE) return static_cast<double>(trace.visible);
    if (what == SHOW_MEDIAN_DEPTH) return median_depth(list, x, y);
    double sum = 0.0;
    const auto blended = reference::blend_pixel(
        splats, list, {x, y}, {}, [&](std::uint32_t i, double alpha, const auto& before, auto verdict) {
          if (verdict == reference::Verdict::blended) sum += alpha * before.transmittance * light[i];
        });
    return blended.transmittance < 1.0 ? sum / (1.0 - blended.transmittance) : -1.0;
  }

  /// Returns the share of pixels of `told` that differ from the reference's debug view `what`.
  double differing(const Image& told, int what) const {
    int count = 0;
    for (int y = 0; y < show_height; ++y) {
      for (int x = 0; x < show_width; ++x)
        count += std::abs(told.at(x, y, 0) - expected(what, x, y)) > 1e-3 ? 1 : 0;
    }
    return count / double{show_width * show_height};
  }
};

TEST_F(ShowTest, MatchesReferenceCounts) {
  frame.draw(std::vector{view}, {}, test::given(render::Stage::sort));
  for (int what = SHOW_ALPHAS; what <= SHOW_MEDIAN_DEPTH; ++what) {
    const Image told = frame.read_debug_view(what).at(0);
    // In a few pixels, rounding decides differently about an alpha near tau or about an early stop.
    EXPECT_LE(differing(told, what), 0.002) << show_choices[what].name;
    for (int other = SHOW_ALPHAS; other <= SHOW_MEDIAN_DEPTH; ++other) {
      if (other == what) continue;
      EXPECT_GT(differing(told, other), 0.05) << show_choices[other].name << " goes unnoticed";
    }
  }
}

TEST_F(ShowTest, LeavesNextFramesUnchanged) {
  const std::vector views = {view};
  const render::FrameSettings settings = test::squared(0.1f, Transmittance::last);
  render::Frame other(test::gl_context(), model);
  for (int n = 0; n < 3; ++n) {
    frame.draw(views, settings);
    other.draw(views, settings);
    for (int what = SHOW_ALPHAS; what <= SHOW_MEDIAN_DEPTH; ++what) frame.read_debug_view(what);
  }
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], other.read_pictures()[0]));
}

TEST_F(ShowTest, CoversEyePairs) {
  const shared::View right = make_view(test::front_camera(33, 50, 40));
  frame.draw(std::vector{view, right});
  const auto told = frame.read_debug_view(SHOW_VISIBLE);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_LE(differing(told[0], SHOW_VISIBLE), 0.002);
  EXPECT_EQ(told[1].width, 33);
  EXPECT_EQ(told[1].height, 50);
}

// With a median depth, the blend handles several splats at a time before it finds the depth.
TEST_F(ShowTest, MedianDepthKeepsColours) {
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    render::FrameSettings settings{{.projection = projection}};
    frame.draw(std::vector{view}, settings);
    const Picture mean = frame.read_pictures()[0];
    const Image told = frame.read_debug_view(SHOW_MEDIAN_DEPTH)[0];
    settings.depth = DepthKind::median;
    frame.draw(std::vector{view}, settings);
    const Picture median = frame.read_pictures()[0];
    EXPECT_EQ(median.colour, mean.colour);
    std::size_t differ = 0, from_mean = 0;
    for (std::size_t k = 0; k < told.data.size(); ++k) {
      const float expected = (1.0f - mean.colour[k].a) * std::max(told.data[k], 0.0f);
      // Equal but for rounding: the factor from distance to depth along the axis has a square root.
      const auto is = [&](const Picture& p) { return std::abs(p.z_sum[k] - expected) <= 1e-6f * expected; };
      differ += is(median) ? 0 : 1;
      from_mean += is(mean) ? 0 : 1;
    }
    EXPECT_EQ(differ, 0u) << name_of(projection);
    EXPECT_GT(from_mean, told.data.size() / 10) << "the mean goes unnoticed";
  }
}

TEST_F(ShowTest, ReferenceBlendHasNoDebugView) {
  frame.draw(std::vector{view}, {}, test::given(render::Stage::blend));
  EXPECT_THROW(frame.read_debug_view(SHOW_ALPHAS), Error);
}

}  // namespace
}  // namespace binosplat
