// Compares the reference with the numbers of docs/method.md 8 and INRIA's pictures of the shared scenes. One
// view of each model by default. With BINOSPLAT_LONG=1, all views that have a picture or a number.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "reference/splats.h"
#include "reference/trained.h"

namespace binosplat::reference {
namespace {

namespace fs = std::filesystem;

/// Numbers of pairs by tile test.
struct Pairs {
  std::size_t aabb = 0, obb = 0, snug = 0, ellipse = 0;
};

struct Case {
  Trained model;
  const char* view;
  bool always;               // also without BINOSPLAT_LONG
  Pairs pairs;               // 0: docs/method.md has no numbers
  double aabb_to_exact = 0;  // dB
  double obb_to_exact = 0;
  int evaluated = 0;  // alphas per pixel with `ellipse`
  int visible = 0;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.model.ply << ' ' << c.view; }

const Case cases[] = {
    {fox, "0001", true, {885634, 429637, 460218, 371596}, 77.0, 76.4, 186, 42},
    {fox, "0042", false, {866737, 358935, 423519, 308963}, 79.2, 73.6, 148, 44},
    {fox, "0012", false},
    {fox, "0027", false},
    {fox, "0073", false},
    {fox, "0089", false},
    {fox, "0110", false},
    {fox_pruned, "0001", true, {637863, 261959, 308840, 229701}},
    {fox_pruned, "0012", false},
    {fox_pruned, "0027", false},
    {fox_pruned, "0042", false},
    {fox_pruned, "0073", false},
    {fox_pruned, "0089", false},
    {fox_pruned, "0110", false},
    {garden, "DSC07956", true, {1827306, 823308, 906690, 728346}},
    {garden, "DSC07988", false},
    {garden, "DSC08020", false},
    {garden, "DSC08052", false},
    {garden, "DSC08084", false},
    {garden, "DSC08116", false},
};

Scene load_scene(const fs::path& folder, const Case& c) {
  return {load_ply(OpenedFile(folder / c.model.ply)), camera_named(folder / "cameras.json", c.view)};
}

class ReferenceOnScenes : public testing::TestWithParam<Case> {};

#define REQUIRE_CASE(folder)                                        \
  if (!GetParam().always && !test::switched_on("BINOSPLAT_LONG")) { \
    GTEST_SKIP() << "one of the longer runs: set BINOSPLAT_LONG=1"; \
  }                                                                 \
  REQUIRE_SCENE(GetParam().model.scene, folder)

TEST_P(ReferenceOnScenes, AabbMatchesInriaAndPhotos) {
  REQUIRE_CASE(folder);
  const Case& c = GetParam();
  const Scene scene = load_scene(folder, c);
  const Image aabb = quantised(on_black(blend(scene.splats, scene.lists(TILES_AABB), scene.view)));
  const fs::path inria = folder / c.model.inria / (std::string(c.view) + ".png");
  if (fs::exists(inria)) {
    EXPECT_GT(measure::psnr(aabb, load_image(inria)), c.model.inria_bound);
  }
  const double wanted = nlohmann::json::parse(std::ifstream(folder / c.model.psnr)).at(c.view);
  const Image photo = load_image(folder / "photos" / (std::string(c.view) + ".jpg"));
  EXPECT_NEAR(measure::psnr(aabb, photo), wanted, 0.005);
}

/// Rounding the camera to fp32 moves means by up to 1e-4 px, which changes a few pairs at tile edges.
void expect_pairs(const TileLists& lists, std::size_t wanted) {
  EXPECT_NEAR(double(lists.pairs()), double(wanted), 2e-5 * double(wanted));
}

TEST_P(ReferenceOnScenes, TileCountsAndLossMatchMethod) {
  REQUIRE_CASE(folder);
  const Case& c = GetParam();
  if (c.pairs.aabb == 0) GTEST_SKIP() << "docs/method.md has no figures for this view";
  const Scene scene = load_scene(folder, c);
  const TileLists aabb = scene.lists(TILES_AABB), obb = scene.lists(TILES_OBB),
                  snug = scene.lists(TILES_SNUG), ellipse = scene.lists(TILES_ELLIPSE);
  expect_pairs(aabb, c.pairs.aabb);
  expect_pairs(obb, c.pairs.obb);
  expect_pairs(snug, c.pairs.snug);
  expect_pairs(ellipse, c.pairs.ellipse);
  if (c.visible == 0) return;

  BlendCounts counts;
  const Picture picture = blend(scene.splats, ellipse, scene.view, {}, &counts);
  EXPECT_TRUE(equal_bits(blend(scene.splats, snug, scene.view), picture));
  EXPECT_EQ(std::lround(double(counts.evaluated) / scene.pixels()), c.evaluated);
  EXPECT_EQ(std::lround(double(counts.visible) / scene.pixels()), c.visible);
  const Image exact = on_black(picture);
  EXPECT_NEAR(measure::psnr(on_black(blend(scene.splats, aabb, scene.view)), exact), c.aabb_to_exact, 0.05);
  EXPECT_NEAR(measure::psnr(on_black(blend(scene.splats, obb, scene.view)), exact), c.obb_to_exact, 0.05);
}

TEST(ReferenceOnBench, HeadsetCountsMatchMethod) {
  const char* bench = std::getenv("BINOSPLAT_BENCH_VIEWS");
  if (bench == nullptr || !test::switched_on("BINOSPLAT_LONG")) {
    GTEST_SKIP()
        << "one of the longer runs: set BINOSPLAT_LONG=1, and BINOSPLAT_BENCH_VIEWS to the folder of "
           "fox_bench.json";
  }
  REQUIRE_SCENE("fox", folder);
  const Camera camera = camera_named(fs::path(bench) / "fox_bench.json", "0042_avp_left");
  const Scene scene(load_ply(OpenedFile(folder / fox.ply)), camera);
  expect_pairs(scene.lists(TILES_AABB), 10132252);
  expect_pairs(scene.lists(TILES_OBB), 3034474);
  expect_pairs(scene.lists(TILES_SNUG), 4379363);
  const TileLists ellipse = scene.lists(TILES_ELLIPSE);
  expect_pairs(ellipse, 2480984);
  BlendCounts counts;
  blend(scene.splats, ellipse, scene.view, {}, &counts);
  EXPECT_EQ(std::lround(double(counts.evaluated) / scene.pixels()), 50);
  EXPECT_EQ(std::lround(double(counts.visible) / scene.pixels()), 30);
}

/// Returns the splats with every number rounded to fp32, the least that a GPU does.
std::vector<Splat> rounded(std::vector<Splat> splats) {
  const auto round_each = [](auto& v) {
    for (int i = 0; i < v.length(); ++i) v[i] = static_cast<float>(v[i]);
  };
  for (Splat& s : splats) {
    round_each(s.mean);
    round_each(s.covariance);
    round_each(s.conic);
    round_each(s.colour);
    s.order = static_cast<float>(s.order);
    s.opacity = static_cast<float>(s.opacity);
  }
  return splats;
}

/// The number of pixels that differ from the exact picture by more than 0.3/255 in a channel, and the number
/// of unexplained ones: no near decision of the exact blend would change them by half as much.
struct Explained {
  int differing = 0;
  int unexplained = 0;
};
Explained explain_all(const Scene& scene, const TileLists& lists, const Image& exact, const Image& other) {
  Explained result;
  for (int y = 0; y < exact.height; ++y) {
    for (int x = 0; x < exact.width; ++x) {
      double error = 0.0;
      for (int c = 0; c < 3; ++c)
        error = std::max(error, std::abs(double(exact.at(x, y, c)) - other.at(x, y, c)));
      if (error < 0.3 / 255) continue;
      ++result.differing;
      const PixelTrace pixel = trace(scene.splats, lists.at_pixel(x, y), x, y);
      if (pixel.largest_change() < 0.5 * error) ++result.unexplained;
    }
  }
  return result;
}

TEST_P(ReferenceOnScenes, TraceExplainsRoundingDifferences) {
  REQUIRE_CASE(folder);
  // The effect of rounding does not depend on the scene: one scene represents the others.
  if (GetParam().model.ply != cases[0].model.ply && !test::switched_on("BINOSPLAT_LONG"))
    GTEST_SKIP() << "one of the longer runs: set BINOSPLAT_LONG=1";
  const Scene scene = load_scene(folder, GetParam());
  const TileLists lists = scene.lists(TILES_ELLIPSE);
  const Image exact = on_black(blend(scene.splats, lists, scene.view));
  const auto compare = [&](const std::vector<Splat>& splats) {
    const TileLists own = make_lists(splats, depth_order(splats), scene.view, TILES_ELLIPSE);
    return on_black(blend(splats, own, scene.view));
  };
  const Image fp32 = compare(rounded(scene.splats));
  EXPECT_GT(measure::psnr(exact, fp32), 80.0);
  const Explained by_rounding = explain_all(scene, lists, exact, fp32);
  EXPECT_EQ(by_rounding.unexplained, 0);
  // Injected: one splat in a hundred is slightly brighter. The trace must not explain that.
  std::vector<Splat> faulty = scene.splats;
  for (std::size_t i = 0; i < faulty.size(); i += 100) faulty[i].colour += 0.05;
  EXPECT_GT(explain_all(scene, lists, exact, compare(faulty)).unexplained, 1000);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ReferenceOnScenes, testing::ValuesIn(cases), [](const auto& named) {
  return fs::path(named.param.model.ply).stem().string() + "_" + named.param.view;
});

TEST(InriaBound, DetectsInjectedFaults) {
  REQUIRE_SCENE("fox", folder);
  const Case& c = cases[0];
  const Scene scene = load_scene(folder, c);
  const Image inria = load_image(folder / c.model.inria / (std::string(c.view) + ".png"));
  const auto against_inria = [&](const Picture& picture) {
    return measure::psnr(quantised(on_black(picture)), inria);
  };
  const TileLists lists = scene.lists(TILES_AABB);
  EXPECT_LT(against_inria(blend(scene.splats, lists, scene.view, {.stop_late = true})), c.model.inria_bound);
  EXPECT_LT(against_inria(blend(scene.splats, scene.lists(TILES_ELLIPSE), scene.view)), c.model.inria_bound)
      << "the tails that aabb cuts go unnoticed";
}

}  // namespace
}  // namespace binosplat::reference
