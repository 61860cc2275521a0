#include "reference/blend.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "reference/splats.h"

namespace binosplat::reference {
namespace {

/// Returns a round splat of variance 4 px^2 at pixel (8, 8).
Splat round_splat(double depth, double opacity, const glm::dvec3& colour) {
  Splat splat;
  splat.mean = {8, 8};
  splat.depth = splat.order = depth;
  splat.opacity = opacity;
  splat.covariance = {4, 0, 4};
  splat.conic = {0.25, 0, 0.25};
  splat.det = 16;
  splat.colour = colour;
  splat.drawn = true;
  return splat;
}

struct Blended {
  Picture picture;
  BlendCounts counts;
  glm::vec4 at(int x, int y) const { return picture.colour[y * picture.width + x]; }
  float z_at(int x, int y) const { return picture.z_sum[y * picture.width + x]; }
};

Blended blend_all(const std::vector<Splat>& splats, Faults faults = {}) {
  const shared::View view = view_of(16, 16);
  Blended result;
  result.picture =
      blend(splats, make_lists(splats, depth_order(splats), view, TILES_ALL), view, faults, &result.counts);
  return result;
}

void expect_colour(const glm::vec4& got, const glm::dvec4& wanted) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(got[i], wanted[i], 1e-7) << "channel " << i;
}

TEST(Blend, OneGaussianMatchesHandCalculation) {
  const Blended result = blend_all({round_splat(5, 0.75, {1.0, 0.5, 0.25})});
  expect_colour(result.at(8, 8), {0.75, 0.375, 0.1875, 0.25});
  EXPECT_FLOAT_EQ(result.z_at(8, 8), 3.75f);
  // At a distance of 2 px, q = 4 / 4.
  const double alpha = 0.75 * std::exp(-0.5);
  expect_colour(result.at(10, 8), {alpha, alpha / 2, alpha / 4, 1 - alpha});
  expect_colour(result.at(8, 6), {alpha, alpha / 2, alpha / 4, 1 - alpha});
  // alpha falls below 1/255 where q > 2 ln(0.75 * 255) = 10.5075, that is beyond 6.483 px.
  EXPECT_LT(result.at(14, 10).a, 1.0f);  // q = (36 + 4) / 4 = 10
  EXPECT_EQ(result.at(2, 11).a, 1.0f);   // q = (36 + 9) / 4 = 11.25
  EXPECT_EQ(result.at(2, 11), glm::vec4(0, 0, 0, 1));
  EXPECT_EQ(result.counts.evaluated, 256u);
}

TEST(Blend, AlphaIsCapped) {
  expect_colour(blend_all({round_splat(5, 1.0, {1, 1, 1})}).at(8, 8), {0.99, 0.99, 0.99, 0.01});
}

TEST(Blend, NearerIsBlendedOverFarther) {
  // The first splat is the farther one.
  const Blended result = blend_all({round_splat(6, 0.5, {0, 1, 0}), round_splat(2, 0.75, {1, 0, 0})});
  expect_colour(result.at(8, 8), {0.75, 0.25 * 0.5, 0.0, 0.25 * 0.5});
  EXPECT_FLOAT_EQ(result.z_at(8, 8), 0.75f * 2 + 0.125f * 6);
  EXPECT_EQ(result.counts.evaluated, 512u);
}

TEST(Blend, EqualDepthsBlendByIndex) {
  const Blended result = blend_all({round_splat(2, 0.5, {0, 1, 0}), round_splat(2, 0.5, {1, 0, 0})});
  expect_colour(result.at(8, 8), {0.25, 0.5, 0.0, 0.25});
}

TEST(Blend, NegativeExponentsAreSkipped) {
  Splat broken = round_splat(2, 0.5, {1, 1, 1});
  broken.conic = {-0.25, 0, 0.25};
  const Blended result = blend_all({broken});
  EXPECT_EQ(result.at(10, 8).a, 1.0f);
  expect_colour(result.at(8, 8), {0.5, 0.5, 0.5, 0.5});
}

TEST(Blend, StopsBeforeTransmittanceLimit) {
  // Five splats of alpha 0.8 leave T = 0.2^5 = 3.2e-4; the sixth would leave 6.4e-5.
  std::vector<Splat> splats(8);
  for (int i = 0; i < 8; ++i) splats[i] = round_splat(1 + i, 0.8, {1, i == 5 ? 1 : 0, i == 6 ? 1 : 0});
  const Blended right = blend_all(splats);
  expect_colour(right.at(8, 8), {1 - 3.2e-4, 0, 0, 3.2e-4});
  const Blended late = blend_all(splats, {.stop_late = true});
  expect_colour(late.at(8, 8), {1 - 6.4e-5, 0.8 * 3.2e-4, 0, 6.4e-5});
}

TEST(Blend, CountsMatchTraces) {
  const Model model = test::random_model(4, 600, 1);
  const shared::View view = view_of(40, 30);
  const std::vector<Splat> splats = project_all(model, view);
  const TileLists lists = make_lists(splats, depth_order(splats), view, TILES_ELLIPSE);
  BlendCounts counts;
  blend(splats, lists, view, {}, &counts);
  // A tile evaluates its list until its last pixel ends.
  BlendCounts traced;
  std::vector<std::uint64_t> most(lists.begin.size() - 1);
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const PixelTrace pixel = trace(splats, lists.at_pixel(x, y), x, y);
        std::uint64_t& of_tile = most[y / 16 * lists.tiles_x + x / 16];
        of_tile = std::max(of_tile, pixel.walked);
        if (pass == 0) traced.visible += pixel.visible;
        if (pass == 1) traced.evaluated += of_tile;
      }
    }
  }
  EXPECT_EQ(counts.evaluated, traced.evaluated);
  EXPECT_EQ(counts.visible, traced.visible);
  EXPECT_GT(counts.visible, 1200u);
  EXPECT_GT(counts.evaluated, counts.visible);
}

/// Returns the largest change of a channel at (8, 8) between two sets of splats.
double change_between(const std::vector<Splat>& a, const std::vector<Splat>& b) {
  const glm::vec4 change = glm::abs(blend_all(a).at(8, 8) - blend_all(b).at(8, 8));
  return std::max({change.r, change.g, change.b});
}

PixelTrace trace_centre(const std::vector<Splat>& splats) {
  return trace(splats, make_lists(splats, depth_order(splats), view_of(16, 16), TILES_ALL).at_pixel(8, 8), 8,
               8);
}

TEST(Trace, FindsAlphaNearTau) {
  for (const double side : {-1e-9, 1e-9}) {
    std::vector<Splat> splats = {round_splat(1, 0.5, {0.1, 0.2, 0.3}),
                                 round_splat(2, ALPHA_MIN * (1 + side), {1, 1, 0}),
                                 round_splat(3, 0.6, {0.2, 0.3, 0.4})};
    const PixelTrace pixel = trace_centre(splats);
    EXPECT_EQ(pixel.alpha.gaussian, 1u);
    EXPECT_NEAR(pixel.alpha.distance, 1e-9, 1e-12);
    std::vector<Splat> turned = splats;
    turned[1].opacity = ALPHA_MIN * (1 - side);
    EXPECT_NEAR(pixel.alpha.change, change_between(splats, turned), 1e-6);
    EXPECT_GT(pixel.alpha.change, 1e-3);
    EXPECT_NE(pixel.explain().find("alpha misses tau by a relative 1.0e-09 (Gaussian 1)"), std::string::npos)
        << pixel.explain();
    // An alpha far from tau is no near decision.
    turned[1].opacity = 0.3;
    EXPECT_GT(trace_centre(turned).alpha.distance, 1.0);
    EXPECT_NE(trace_centre(turned).explain().find("no decision"), std::string::npos);
  }
}

TEST(Trace, FindsEarlyStopNearLimit) {
  for (const double side : {-1e-9, 1e-9}) {
    // T is 0.005 in front of the third splat, which would leave 1e-4 (1 + side).
    const auto with = [](double offset) {
      return std::vector<Splat>{round_splat(1, 0.95, {0.1, 0.2, 0.3}), round_splat(2, 0.9, {0.3, 0.2, 0.1}),
                                round_splat(3, 1 - 0.02 * (1 + offset), {1, 0.8, 0.5}),
                                round_splat(4, 0.5, {1, 1, 1})};
    };
    const PixelTrace pixel = trace_centre(with(side));
    EXPECT_EQ(pixel.visible, side < 0 ? 2u : 3u);
    EXPECT_EQ(pixel.stop.gaussian, 2u);
    EXPECT_NEAR(pixel.stop.distance, 1e-9, 1e-12);
    EXPECT_NEAR(pixel.stop.change, change_between(with(side), with(-side)), 1e-6);
    EXPECT_GT(pixel.stop.change, 4e-3);
    EXPECT_NE(pixel.explain().find("early stop by a relative 1.0e-09 (Gaussian 2)"), std::string::npos)
        << pixel.explain();
    EXPECT_GT(trace_centre(with(0.5)).stop.distance, 0.1);
  }
}

TEST(Trace, FindsNearTieInDepth) {
  // In each case the last splat is behind the one before it by a small gap. Both blend, or the pixel stops at
  // the former, or both lie behind the stop.
  const struct {
    std::vector<Splat> splats;
    std::size_t visible;
    double at_least;  // least change that the tie causes
  } cases[] = {
      {{round_splat(1, 0.3, {0.1, 0.2, 0.3}), round_splat(2, 0.5, {1, 0, 0}), round_splat(2, 0.6, {0, 1, 0})},
       3,
       0.1},
      {{round_splat(1, 0.99, {0.1, 0.2, 0.3}), round_splat(2, 0.98, {1, 0, 0}),
        round_splat(2, 0.6, {0, 1, 0})},
       2,
       5e-3},
      {{round_splat(1, 0.95, {0.1, 0.2, 0.3}), round_splat(1.5, 0.9, {0.3, 0.2, 0.1}),
        round_splat(2, 0.985, {1, 0, 0}), round_splat(2, 0.5, {0, 1, 0})},
       2,
       2e-3}};
  for (const auto& [splats, visible, at_least] : cases) {
    const auto with = [&, of = splats](double gap) {
      std::vector<Splat> moved = of;
      moved.back().depth = moved.back().order = 2 + gap;
      return moved;
    };
    const std::size_t last = splats.size() - 1;
    const PixelTrace pixel = trace_centre(with(2e-9));
    EXPECT_EQ(pixel.visible, visible);
    EXPECT_EQ(pixel.depth.gaussian, last);
    EXPECT_NEAR(pixel.depth.distance, 1e-9, 1e-12);
    EXPECT_NEAR(pixel.depth.change, change_between(with(2e-9), with(-2e-9)), 1e-6);
    EXPECT_GT(pixel.depth.change, at_least);
    EXPECT_NE(pixel.explain().find(fmt::format("(Gaussian {})", last)), std::string::npos);
  }
  std::vector<Splat> apart = cases[0].splats;
  apart.back().depth = apart.back().order = 2.2;
  EXPECT_NEAR(trace_centre(apart).depth.distance, 0.2 / 2.2, 1e-12);
}

TEST(Trace, ReportsMostVisibleDecision) {
  std::vector<Splat> splats = {round_splat(1, ALPHA_MIN * (1 - 1e-5), {1, 1, 1}),
                               round_splat(2, 0.99, {0, 0, 0}),
                               round_splat(3, ALPHA_MIN * (1 - 1e-9), {1, 1, 1})};
  EXPECT_EQ(trace_centre(splats).alpha.gaussian, 0u) << "the nearer one to tau lies behind and hardly shows";
  EXPECT_EQ(trace({}, {}, 3, 4).explain(), "no decision is close enough for fp32 to change it");
}

}  // namespace
}  // namespace binosplat::reference
