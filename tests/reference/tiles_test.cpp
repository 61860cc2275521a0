#include "reference/tiles.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "reference/splats.h"

namespace binosplat::reference {
namespace {

/// Returns the columns of tiles that a splat of variance `variance` at x touches in row 1 of 64 x 64 px, as a
/// string of digits.
std::string columns(double x, double variance, int tiles, double opacity = 1.0,
                    double threshold = ALPHA_MIN) {
  const shared::View view = view_of(64, 64);
  Splat splat = make_splat({x, 24}, {variance, 0, variance}, opacity);
  splat.threshold = threshold;
  std::string text;
  for (int tx = 0; tx * TILE_SIZE < 64; ++tx) {
    if (touches(splat, tiles, tx, 24 / TILE_SIZE, view)) text += std::to_string(tx);
  }
  return text;
}

TEST(Tiles, AabbMatchesHandCalculation) {
  // lambda1 = 4 + sqrt(0.1), because of the floor: R = ceil(3 * 2.0776) = 7, while 3 sigma is 6.
  EXPECT_EQ(columns(24, 4.0, TILES_AABB), "1");     // from int(17 / 16) to int(46 / 16), exclusive
  EXPECT_EQ(columns(22.9, 4.0, TILES_AABB), "01");  // int(15.9 / 16)
  EXPECT_EQ(columns(23, 4.0, TILES_AABB), "1");     // int(16 / 16)
  // For x + R up to 32 the right neighbour is not included, although its first pixel centre lies at 32.
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
}

TEST(Tiles, SnugAndEllipseMatchHandCalculation) {
  // In the row of tiles that contains the mean, snug and ellipse have the same columns. With opacity 1 and
  // variance 4, q reaches 2 ln 255 at sqrt(4 * 11.0825) = 6.6581 px.
  for (const int tiles : {TILES_SNUG, TILES_ELLIPSE}) {
    EXPECT_EQ(columns(24, 4.0, tiles), "1");
    EXPECT_EQ(columns(15 + 6.66, 4.0, tiles), "1");  // tile 0 ends with the centre at 15
    EXPECT_EQ(columns(15 + 6.65, 4.0, tiles), "01");
    EXPECT_EQ(columns(32 - 6.65, 4.0, tiles), "12");
    EXPECT_EQ(columns(32 - 6.66, 4.0, tiles), "1");
    EXPECT_EQ(columns(-6.66, 4.0, tiles), "");
    EXPECT_EQ(columns(-6.65, 4.0, tiles), "0");
    EXPECT_EQ(columns(1e30, 4.0, tiles), "");
    EXPECT_EQ(columns(30, 1e30, tiles), "0123");
    EXPECT_EQ(columns(24, 4.0, tiles, 0.0), "");
    EXPECT_EQ(columns(24, 4.0, tiles, 0.00392), "") << "just below tau";
    // If the opacity is just above tau, alpha reaches tau only within 0.02 px of the mean.
    EXPECT_EQ(columns(24.01, 4.0, tiles, 0.003922), "1");
    EXPECT_EQ(columns(24.5, 4.0, tiles, 0.003922), "") << "between pixel centres of one tile";
    EXPECT_EQ(columns(15.5, 4.0, tiles, 0.003922), "") << "between the pixel centres of two tiles";
    // Th = 1/e^2: q reaches 4 at 4 px.
    EXPECT_EQ(columns(15 + 3.99, 4.0, tiles, 1.0, std::exp(-2.0)), "01");
    EXPECT_EQ(columns(15 + 4.01, 4.0, tiles, 1.0, std::exp(-2.0)), "1");
    EXPECT_EQ(columns(32 - 3.99, 4.0, tiles, 1.0, std::exp(-2.0)), "12");
    EXPECT_EQ(columns(24, 4.0, tiles, 0.5, 0.51), "") << "Th exceeds it";
  }
  EXPECT_EQ(columns(24, 4.0, TILES_ALL, 0.0), "0123");
}

TEST(Tiles, ObbMatchesHandCalculation) {
  // A variance of 4 gives three standard deviations of 6 px. Touching counts.
  EXPECT_EQ(columns(24, 4.0, TILES_OBB), "1");
  EXPECT_EQ(columns(15 + 6, 4.0, TILES_OBB), "01");
  EXPECT_EQ(columns(15 + 6.01, 4.0, TILES_OBB), "1");
  EXPECT_EQ(columns(32 - 6, 4.0, TILES_OBB), "12");
  EXPECT_EQ(columns(32 - 6.01, 4.0, TILES_OBB), "1");
  EXPECT_EQ(columns(-6.01, 4.0, TILES_OBB), "");
  EXPECT_EQ(columns(30, 1e30, TILES_OBB), "0123");
  EXPECT_EQ(columns(24, 4.0, TILES_OBB, 0.00392), "") << "just below tau";
  EXPECT_EQ(columns(24, 4.0, TILES_OBB, 0.003922), "1") << "the shape does not depend on the opacity";
  EXPECT_EQ(columns(21, 4.0, TILES_OBB, 0.003922), "01");
  EXPECT_EQ(columns(21, 4.0, TILES_OBB, 0.5, 0.49), "01") << "nor on Th";
  EXPECT_EQ(columns(21, 4.0, TILES_OBB, 0.5, 0.51), "") << "but leaves out what Th exceeds";
}

/// Returns the tiles of 64 x 64 px that a splat touches, row by row.
std::string map_of(const Splat& splat, int tiles) {
  std::string text;
  for (int t = 0; t < 16; ++t) text += touches(splat, tiles, t % 4, t / 4, view_of(64, 64)) ? '#' : '.';
  return text;
}

TEST(Tiles, NeedlesMatchHandCalculation) {
  // Standard deviations are 10 and 1 px along the two diagonals. The upright box of 3 sigma extends 21.3 px
  // from the mean, and the one of alpha >= tau 23.7 px: from (24, 24) to 47.7 and 0.3. The needle passes
  // between the corners of four tiles.
  const double long2 = 100, short2 = 1;
  const glm::dvec3 down((long2 + short2) / 2, (long2 - short2) / 2, (long2 + short2) / 2);
  const glm::dvec3 up(down.x, -down.y, down.z);
  EXPECT_EQ(map_of(make_splat({24, 24}, down, 1.0), TILES_OBB), "##..###..##.....");
  EXPECT_EQ(map_of(make_splat({24, 24}, up, 1.0), TILES_OBB), ".##.###.##......");
  EXPECT_EQ(map_of(make_splat({24, 24}, down, 1.0), TILES_ELLIPSE), "##..###..##.....");
  EXPECT_EQ(map_of(make_splat({24, 24}, down, 1.0), TILES_SNUG), "###.###.###.....");
  EXPECT_EQ(map_of(make_splat({24, 24}, up, 1.0), TILES_SNUG), "###.###.###.....");
  // Standard deviations of 10 px across and 1 px down.
  EXPECT_EQ(map_of(make_splat({24, 24}, {100, 0, 1}, 1.0), TILES_OBB), "....####........");
  EXPECT_EQ(map_of(make_splat({24, 24}, {100, 0, 1}, 1.0), TILES_SNUG), "....####........");
  EXPECT_EQ(map_of(make_splat({24, 24}, {1, 0, 100}, 1.0), TILES_OBB), ".#...#...#...#..");
}

TEST(Tiles, ShapesStopAtPictureEdge) {
  // The picture is 50 px wide: the last tile's pixel centres end at 49, not at 63.
  const shared::View view = view_of(50, 50);
  const double to_tau = std::sqrt(4.0 * 2 * std::log(255.0));
  for (const auto& [tiles, reach] :
       {std::pair(TILES_ELLIPSE, to_tau), {TILES_SNUG, to_tau}, {TILES_OBB, 6.0}}) {
    EXPECT_TRUE(touches(make_splat({49 + reach - 0.01, 40}, {4, 0, 4}, 1.0), tiles, 3, 2, view));
    EXPECT_FALSE(touches(make_splat({49 + reach + 0.01, 40}, {4, 0, 4}, 1.0), tiles, 3, 2, view));
  }
}

/// A shape around a mean: a point at d from the mean belongs to it if norm(d) <= limit. `steepest` is the
/// largest norm of a unit vector.
struct Shape {
  std::function<double(const glm::dvec2&)> norm;
  double limit, steepest;
};

Shape ellipse_of(const Splat& splat) {
  const glm::dvec3 c = splat.conic;
  const double half_trace = 0.5 * (c.x + c.z);
  const double largest = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - 1 / splat.det));
  return {
      [c](const glm::dvec2& d) { return std::sqrt(c.x * d.x * d.x + 2 * c.y * d.x * d.y + c.z * d.y * d.y); },
      std::sqrt(2 * std::log(splat.opacity / splat.threshold)), std::sqrt(largest)};
}

/// Returns the box of three standard deviations along the eigenvectors, from the textbook: (lambda - C2.yy,
/// C2.xy).
Shape oriented_box_of(const Splat& splat) {
  const glm::dvec3 c = splat.covariance;
  const double half_trace = 0.5 * (c.x + c.z), spread = std::sqrt(half_trace * half_trace - splat.det);
  const glm::dvec2 axis = glm::normalize(glm::dvec2(half_trace + spread - c.z, c.y));
  const double sigma1 = std::sqrt(half_trace + spread), sigma2 = std::sqrt(half_trace - spread);
  return {[=](const glm::dvec2& d) {
            return std::max(std::abs(glm::dot(axis, d)) / sigma1,
                            std::abs(axis.x * d.y - axis.y * d.x) / sigma2);
          },
          3.0, std::hypot(1 / sigma1, 1 / sigma2)};
}

/// Returns the smallest norm over a dense grid of points on the tile's rectangle of pixel centres.
double dense_smallest(const Shape& shape, const glm::dvec2& mean, int tx, int ty, const shared::View& view,
                      int steps) {
  const double x0 = tx * 16, x1 = std::min(x0 + 16, double(view.width)) - 1;
  const double y0 = ty * 16, y1 = std::min(y0 + 16, double(view.height)) - 1;
  double smallest = std::numeric_limits<double>::infinity();
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      const glm::dvec2 point(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * j / steps);
      smallest = std::min(smallest, shape.norm(point - mean));
    }
  }
  return smallest;
}

/// Returns the splats with different thresholds, from tau to beyond their opacity.
std::vector<Splat> with_thresholds(std::vector<Splat> splats) {
  test::Uniform uniform(8);
  for (Splat& splat : splats) splat.threshold = std::max(ALPHA_MIN, splat.opacity * uniform(-0.5, 1.1));
  return splats;
}

/// Returns the number of (splat, tile) answers that differ from a dense search. `shift` injects a fault:
/// tiles that are off by `shift`.
int disagreements(int tiles, int shift) {
  const shared::View view = view_of(75, 53);
  int wrong = 0;
  for (const Splat& splat : with_thresholds(random_splats(3, 400, 75, 53))) {
    if (splat.opacity < splat.threshold) continue;
    const Shape shape = tiles == TILES_OBB ? oriented_box_of(splat) : ellipse_of(splat);
    // No point of the rectangle is farther from a grid point than half of a cell's diagonal.
    const double slack = shape.steepest * 15.0 / 60 * std::sqrt(0.5);
    for (int ty = 0; ty < 4; ++ty) {
      for (int tx = 0; tx < 5; ++tx) {
        const double smallest = dense_smallest(shape, splat.mean, tx, ty, view, 60);
        const bool answer = touches(splat, tiles, tx + shift, ty, view);
        if (smallest <= shape.limit ? !answer : answer && smallest > shape.limit + slack) ++wrong;
      }
    }
  }
  return wrong;
}

TEST(Tiles, EllipseAndObbMatchDenseSearch) {
  for (const int tiles : {TILES_ELLIPSE, TILES_OBB}) {
    EXPECT_EQ(disagreements(tiles, 0), 0);
    EXPECT_GT(disagreements(tiles, 1), 100) << "a tile off by one goes unnoticed";
  }
}

/// Returns the number of snug's answers that differ from a test of every pixel centre of the tile. `scale`
/// injects a fault: scaled half extents.
int snug_disagreements(double scale) {
  const shared::View view = view_of(75, 53);
  int wrong = 0;
  for (const Splat& splat : with_thresholds(random_splats(4, 1000, 75, 53))) {
    const double rho = 2 * std::log(splat.opacity / splat.threshold) * scale;
    for (int t = 0; t < 20; ++t) {
      const int tx = t % 5, ty = t / 5;
      bool wanted = false;
      for (int y = ty * 16; y < std::min(ty * 16 + 16, 53); ++y) {
        for (int x = tx * 16; x < std::min(tx * 16 + 16, 75); ++x) {
          const glm::dvec2 d = glm::dvec2(x, y) - splat.mean;
          wanted |= d.x * d.x <= rho * splat.covariance.x && d.y * d.y <= rho * splat.covariance.z;
        }
      }
      if (touches(splat, TILES_SNUG, tx, ty, view) != wanted) ++wrong;
    }
  }
  return wrong;
}

TEST(Tiles, SnugMatchesPixelCentres) {
  EXPECT_EQ(snug_disagreements(1.0), 0);
  EXPECT_GT(snug_disagreements(0.98), 20) << "a box that is too small goes unnoticed";
}

TEST(Tiles, DepthOrderBreaksTiesByIndex) {
  std::vector<Splat> splats(6, make_splat({0, 0}, {4, 0, 4}, 1.0));
  const double depths[] = {2.0, 1.0, 2.0, 3.0, 1.0, 0.5};
  for (int i = 0; i < 6; ++i) splats[i].order = depths[i];
  splats[3].drawn = false;
  EXPECT_EQ(depth_order(splats), (std::vector<std::uint32_t>{5, 1, 4, 0, 2}));
}

TEST(Tiles, ListsHoldTouchingSplatsInOrder) {
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    const shared::View view = view_of(75, 53);
    const std::vector<Splat> splats = with_thresholds(random_splats(5, 300, 75, 53));
    const std::vector<std::uint32_t> order = depth_order(splats);
    const TileLists lists = make_lists(splats, order, view, tiles);
    ASSERT_EQ(lists.tiles_x, 5u);
    ASSERT_EQ(lists.tiles_y, 4u);
    for (std::uint32_t ty = 0; ty < lists.tiles_y; ++ty) {
      for (std::uint32_t tx = 0; tx < lists.tiles_x; ++tx) {
        std::vector<std::uint32_t> wanted;
        for (const std::uint32_t i : order) {
          if (touches(splats[i], tiles, tx, ty, view)) wanted.push_back(i);
        }
        const auto list = lists.tile(tx, ty);
        EXPECT_EQ(std::vector<std::uint32_t>(list.begin(), list.end()), wanted)
            << "tile " << tx << ", " << ty << ", test " << tiles;
      }
    }
    EXPECT_EQ(lists.at_pixel(74, 52).data(), lists.tile(4, 3).data());
  }
}

/// Returns splats for a picture of any size: random ones, some exactly on tile edges, and some centred beyond
/// the picture.
std::vector<Splat> splats_for(int width, int height) {
  std::vector<Splat> splats = random_splats(11, 250, width, height);
  for (int i = 0; i < 40; ++i) {
    splats[i].mean = {16 * (i % 8) - (i % 2), 16 * (i / 8) - (i % 3)};
    splats[i + 40].mean = {i % 2 == 0 ? -4.0 - i : width + 3.0 + i, height * i / 40.0};
  }
  return splats;
}

TEST(Tiles, SnugAndEllipseEqualBruteForce) {
  const int sizes[][2] = {{75, 53}, {1, 1}, {16, 16}, {17, 15}, {301, 5}, {3, 257}, {64, 48}};
  for (const auto& [width, height] : sizes) {
    const shared::View view = view_of(width, height);
    const std::vector<Splat> splats = splats_for(width, height);
    const Picture brute_force = picture_of(splats, view, TILES_ALL);
    for (const int tiles : {TILES_SNUG, TILES_ELLIPSE}) {
      EXPECT_TRUE(equal_bits(picture_of(splats, view, tiles), brute_force)) << width << " x " << height;
      // Injected: tiles that are off by one.
      std::vector<Splat> moved = splats;
      for (Splat& splat : moved) splat.mean.x += 16;
      const TileLists off_by_a_tile = make_lists(moved, depth_order(moved), view, tiles);
      EXPECT_FALSE(equal_bits(blend(splats, off_by_a_tile, view), brute_force)) << width << " x " << height;
    }
  }
}

TEST(Tiles, AabbAndObbCutVisibleTails) {
  const shared::View view = view_of(75, 53);
  const std::vector<Splat> splats = splats_for(75, 53);
  EXPECT_FALSE(equal_bits(picture_of(splats, view, TILES_AABB), picture_of(splats, view, TILES_ALL)));
  EXPECT_FALSE(equal_bits(picture_of(splats, view, TILES_OBB), picture_of(splats, view, TILES_ALL)));
}

TEST(Tiles, RenderEqualsStages) {
  const Model model = test::random_model(2, 400, 2);
  const shared::View view = view_of(75, 53);
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    const Picture rendered = render(model, view, {tiles});
    EXPECT_TRUE(equal_bits(rendered, picture_of(project_all(model, view), view, tiles)));
    EXPECT_TRUE(equal_bits(rendered, render(model, view, {tiles}))) << "two runs differ";
  }
  Model flipped = model;
  for (std::size_t i = 0; i < flipped.count(); ++i) {
    for (int c = 0; c < 3; ++c) flipped.sh[(i * 9 + 1) * 3 + c] *= -1;
  }
  EXPECT_FALSE(equal_bits(render(model, view), render(flipped, view))) << "a swapped SH sign goes unnoticed";
}

TEST(Tiles, EmptyModelLeavesBackground) {
  const Picture picture = render(Model{}, view_of(20, 10));
  for (const glm::vec4& c : picture.colour) EXPECT_EQ(c, glm::vec4(0, 0, 0, 1));
}

}  // namespace
}  // namespace binosplat::reference
