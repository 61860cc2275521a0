#include "reference/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "reference/render.h"
#include "support/models.h"

namespace binosplat::reference {
namespace {

using test::front_camera;

shared::View view_of(int width, int height) { return make_view(front_camera(width, height, width)); }

/// A splat by its covariance in px^2 and mean in px.
Splat make_splat(const glm::dvec2& mean, const glm::dvec3& covariance, double opacity) {
  Splat splat;
  splat.mean = mean;
  splat.depth = 1.0;
  splat.opacity = opacity;
  splat.covariance = covariance;
  splat.det = covariance.x * covariance.z - covariance.y * covariance.y;
  splat.conic = glm::dvec3(covariance.z, -covariance.y, covariance.x) / splat.det;
  splat.colour = glm::dvec3(1.0);
  splat.drawn = true;
  return splat;
}

std::vector<Splat> random_splats(std::uint32_t seed, int count, int width, int height) {
  test::Uniform uniform(seed);
  std::vector<Splat> splats;
  for (int i = 0; i < count; ++i) {
    const double a = std::exp(uniform(-1.0, 3.5)), b = std::exp(uniform(-1.0, 3.5)), turn = uniform(0, M_PI);
    const double c = std::cos(turn), s = std::sin(turn);
    const glm::dvec3 covariance(a * a * c * c + b * b * s * s + 0.3, (a * a - b * b) * c * s,
                                a * a * s * s + b * b * c * c + 0.3);
    const double opacity = uniform(0, 1);
    Splat splat =
        make_splat({uniform(-30, width + 30), uniform(-30, height + 30)}, covariance, opacity * opacity);
    splat.depth = uniform(1, 9);
    splat.colour = {uniform(0, 1), uniform(0, 1), uniform(0, 1)};
    splats.push_back(splat);
  }
  return splats;
}

/// The columns of tiles, as 'first..last', that a splat of variance `variance` at x touches in row 1 of 64 x
/// 64 px.
std::string columns(double x, double variance, int tiles, double opacity = 1.0, int tile_size = 16) {
  const shared::View view = view_of(64, 64);
  const Splat splat = make_splat({x, 24}, {variance, 0, variance}, opacity);
  std::string text;
  for (int tx = 0; tx * tile_size < 64; ++tx) {
    if (touches(splat, tiles, tile_size, tx, 24 / tile_size, view)) text += std::to_string(tx);
  }
  return text;
}

TEST(Tiles, AabbByHand) {
  // lambda1 = 4 + sqrt(0.1), the floor: R = ceil(3 * 2.0776) = 7, where 3 sigma would be 6.
  EXPECT_EQ(columns(24, 4.0, TILES_AABB), "1");     // int(17 / 16) up to, not including, int(46 / 16)
  EXPECT_EQ(columns(22.9, 4.0, TILES_AABB), "01");  // int(15.9 / 16)
  EXPECT_EQ(columns(23, 4.0, TILES_AABB), "1");     // int(16 / 16)
  // Up to x + R = 32 the right neighbour is not taken, although its first pixel centre lies at 32.
  EXPECT_EQ(columns(25, 4.0, TILES_AABB), "1");      // int(47 / 16)
  EXPECT_EQ(columns(26, 4.0, TILES_AABB), "12");     // int(48 / 16)
  EXPECT_EQ(columns(25.9, 4.0, TILES_AABB), "1");    // int(47.9 / 16)
  EXPECT_EQ(columns(-6.5, 4.0, TILES_AABB), "");     // int(15.5 / 16)
  EXPECT_EQ(columns(-6, 4.0, TILES_AABB), "0");      // int(16 / 16)
  EXPECT_EQ(columns(70.9, 4.0, TILES_AABB), "3");    // int(63.9 / 16)
  EXPECT_EQ(columns(71, 4.0, TILES_AABB), "");       // int(64 / 16), the end of the grid
  EXPECT_EQ(columns(1e30, 4.0, TILES_AABB), "");     // far beyond what an int can hold
  EXPECT_EQ(columns(30, 1e30, TILES_AABB), "0123");  // one Gaussian over all tiles
  EXPECT_EQ(columns(24, 4.0, TILES_AABB, 0.0), "1") << "opacities below tau are not left out";
  EXPECT_EQ(columns(24, 4.0, TILES_AABB, 1.0, 8), "23");  // int(17 / 8) up to int(38 / 8)
}

TEST(Tiles, EllipseByHand) {
  // sigma 1, variance 4: q reaches 2 ln 255 at sqrt(4 * 11.0825) = 6.6581 px.
  EXPECT_EQ(columns(24, 4.0, TILES_ELLIPSE), "1");
  EXPECT_EQ(columns(15 + 6.66, 4.0, TILES_ELLIPSE), "1");  // tile 0 ends with the centre at 15
  EXPECT_EQ(columns(15 + 6.65, 4.0, TILES_ELLIPSE), "01");
  EXPECT_EQ(columns(32 - 6.65, 4.0, TILES_ELLIPSE), "12");
  EXPECT_EQ(columns(32 - 6.66, 4.0, TILES_ELLIPSE), "1");
  EXPECT_EQ(columns(-6.66, 4.0, TILES_ELLIPSE), "");
  EXPECT_EQ(columns(-6.65, 4.0, TILES_ELLIPSE), "0");
  EXPECT_EQ(columns(24, 4.0, TILES_ELLIPSE, 0.0), "");
  EXPECT_EQ(columns(24, 4.0, TILES_ELLIPSE, 0.00392), "") << "just below tau";
  EXPECT_EQ(columns(24, 4.0, TILES_ELLIPSE, 0.003922), "1") << "just above tau";
  EXPECT_EQ(columns(15.5, 4.0, TILES_ELLIPSE, 0.003922), "") << "between the pixel centres of two tiles";
  EXPECT_EQ(columns(24, 4.0, TILES_ALL, 0.0), "0123");
}

TEST(Tiles, EllipseStopsAtThePicturesEdge) {
  // 50 px wide: the last tile's centres end at 49, not at 63.
  const shared::View view = view_of(50, 50);
  const double reach = std::sqrt(4.0 * 2 * std::log(255.0));
  EXPECT_TRUE(touches(make_splat({49 + reach - 0.01, 40}, {4, 0, 4}, 1.0), TILES_ELLIPSE, 16, 3, 2, view));
  EXPECT_FALSE(touches(make_splat({49 + reach + 0.01, 40}, {4, 0, 4}, 1.0), TILES_ELLIPSE, 16, 3, 2, view));
}

/// Smallest q over a dense grid of points on the tile's rectangle of pixel centres.
double dense_smallest_q(const Splat& splat, int tx, int ty, const shared::View& view, int steps) {
  const double x0 = tx * 16, x1 = std::min(x0 + 16, double(view.width)) - 1;
  const double y0 = ty * 16, y1 = std::min(y0 + 16, double(view.height)) - 1;
  double smallest = std::numeric_limits<double>::infinity();
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      const double dx = x0 + (x1 - x0) * i / steps - splat.mean.x,
                   dy = y0 + (y1 - y0) * j / steps - splat.mean.y;
      smallest =
          std::min(smallest, splat.conic.x * dx * dx + 2 * splat.conic.y * dx * dy + splat.conic.z * dy * dy);
    }
  }
  return smallest;
}

/// How many (splat, tile) answers disagree with a dense search; `shift` plants a tile that is off by so many.
int disagreements(int shift) {
  const shared::View view = view_of(75, 53);
  int wrong = 0;
  for (const Splat& splat : random_splats(3, 400, 75, 53)) {
    const double rho = 2 * std::log(splat.opacity / ALPHA_MIN);
    if (rho < 0) continue;
    // sqrt(q) is a norm: no point of the rectangle is farther from the grid than half a cell's diagonal in
    // it.
    const double half_trace = 0.5 * (splat.conic.x + splat.conic.z);
    const double steepest = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - 1 / splat.det));
    const double slack = std::sqrt(steepest) * 15.0 / 60 * std::sqrt(0.5);
    for (int ty = 0; ty < 4; ++ty) {
      for (int tx = 0; tx < 5; ++tx) {
        const double q = dense_smallest_q(splat, tx, ty, view, 60);
        const bool answer = touches(splat, TILES_ELLIPSE, 16, tx + shift, ty, view);
        if (q <= rho ? !answer : answer && std::sqrt(q) > std::sqrt(rho) + slack) ++wrong;
      }
    }
  }
  return wrong;
}

TEST(Tiles, EllipseAgreesWithADenseSearch) {
  EXPECT_EQ(disagreements(0), 0);
  EXPECT_GT(disagreements(1), 100) << "a tile off by one goes unnoticed";
}

TEST(Tiles, DepthOrderBreaksTiesByIndex) {
  std::vector<Splat> splats(6, make_splat({0, 0}, {4, 0, 4}, 1.0));
  const double depths[] = {2.0, 1.0, 2.0, 3.0, 1.0, 0.5};
  for (int i = 0; i < 6; ++i) splats[i].depth = depths[i];
  splats[3].drawn = false;
  EXPECT_EQ(depth_order(splats), (std::vector<std::uint32_t>{5, 1, 4, 0, 2}));
}

TEST(Tiles, ListsHoldWhatTouchesInDepthOrder) {
  for (const int tiles : {TILES_AABB, TILES_ELLIPSE, TILES_ALL}) {
    for (const int size : {8, 16, 32}) {
      const shared::View view = view_of(75, 53);
      const std::vector<Splat> splats = random_splats(5, 300, 75, 53);
      const std::vector<std::uint32_t> order = depth_order(splats);
      const TileLists lists = make_lists(splats, order, view, tiles, size);
      ASSERT_EQ(lists.tiles_x, (75u + size - 1) / size);
      ASSERT_EQ(lists.tiles_y, (53u + size - 1) / size);
      for (std::uint32_t ty = 0; ty < lists.tiles_y; ++ty) {
        for (std::uint32_t tx = 0; tx < lists.tiles_x; ++tx) {
          std::vector<std::uint32_t> wanted;
          for (const std::uint32_t i : order) {
            if (touches(splats[i], tiles, size, tx, ty, view)) wanted.push_back(i);
          }
          const auto list = lists.tile(tx, ty);
          EXPECT_EQ(std::vector<std::uint32_t>(list.begin(), list.end()), wanted)
              << "tile " << tx << ", " << ty << " of " << size << " px, test " << tiles;
        }
      }
      EXPECT_EQ(lists.at_pixel(74, 52).data(), lists.tile(74 / size, 52 / size).data());
    }
  }
}

bool equal_bits(const Picture& a, const Picture& b) {
  return a.colour.size() == b.colour.size() && a.z_sum.size() == b.z_sum.size() &&
         std::memcmp(a.colour.data(), b.colour.data(), a.colour.size() * sizeof(glm::vec4)) == 0 &&
         std::memcmp(a.z_sum.data(), b.z_sum.data(), a.z_sum.size() * sizeof(float)) == 0;
}

Picture picture_of(const std::vector<Splat>& splats, const shared::View& view, int tiles,
                   int tile_size = 16) {
  return blend(splats, make_lists(splats, depth_order(splats), view, tiles, tile_size), view);
}

/// Splats for a picture of any size: random ones, some exactly on tile edges and some centred beyond the
/// picture.
std::vector<Splat> splats_for(int width, int height) {
  std::vector<Splat> splats = random_splats(11, 250, width, height);
  for (int i = 0; i < 40; ++i) {
    splats[i].mean = {16 * (i % 8) - (i % 2), 16 * (i / 8) - (i % 3)};
    splats[i + 40].mean = {i % 2 == 0 ? -4.0 - i : width + 3.0 + i, height * i / 40.0};
  }
  return splats;
}

TEST(Tiles, EllipseMakesTheBruteForcePictureBitForBit) {
  const int sizes[][2] = {{75, 53}, {1, 1}, {16, 16}, {17, 15}, {301, 5}, {3, 257}, {64, 48}};
  for (const auto& [width, height] : sizes) {
    const shared::View view = view_of(width, height);
    const std::vector<Splat> splats = splats_for(width, height);
    const Picture brute_force = picture_of(splats, view, TILES_ALL);
    EXPECT_TRUE(equal_bits(picture_of(splats, view, TILES_ELLIPSE), brute_force)) << width << " x " << height;
    EXPECT_TRUE(equal_bits(picture_of(splats, view, TILES_ELLIPSE, 8), brute_force))
        << width << " x " << height;
    EXPECT_TRUE(equal_bits(picture_of(splats, view, TILES_ELLIPSE, 32), brute_force))
        << width << " x " << height;
    // Tiles that are off by one must be seen.
    std::vector<Splat> moved = splats;
    for (Splat& splat : moved) splat.mean.x += 16;
    const TileLists off_by_a_tile = make_lists(moved, depth_order(moved), view, TILES_ELLIPSE);
    EXPECT_FALSE(equal_bits(blend(splats, off_by_a_tile, view), brute_force)) << width << " x " << height;
  }
}

TEST(Tiles, AabbCutsVisibleTails) {
  const shared::View view = view_of(75, 53);
  const std::vector<Splat> splats = splats_for(75, 53);
  EXPECT_FALSE(equal_bits(picture_of(splats, view, TILES_AABB), picture_of(splats, view, TILES_ALL)));
}

TEST(Tiles, RenderIsItsStagesInOrder) {
  const Model model = test::random_model(2, 400, 2);
  const shared::View view = view_of(75, 53);
  for (const int tiles : {TILES_AABB, TILES_ELLIPSE, TILES_ALL}) {
    const Picture rendered = render(model, view, {tiles, 16});
    EXPECT_TRUE(equal_bits(rendered, picture_of(project_all(model, view), view, tiles)));
    EXPECT_TRUE(equal_bits(rendered, render(model, view, {tiles, 16}))) << "two runs differ";
  }
  Model flipped = model;
  for (std::size_t i = 0; i < flipped.count(); ++i) {
    for (int c = 0; c < 3; ++c) flipped.sh[(i * 9 + 1) * 3 + c] *= -1;
  }
  EXPECT_FALSE(equal_bits(render(model, view), render(flipped, view))) << "a swapped SH sign goes unnoticed";
}

TEST(Tiles, AnEmptyModelLeavesTheBackground) {
  const Picture picture = render(Model{}, view_of(20, 10));
  for (const glm::vec4& c : picture.colour) EXPECT_EQ(c, glm::vec4(0, 0, 0, 1));
}

}  // namespace
}  // namespace binosplat::reference
