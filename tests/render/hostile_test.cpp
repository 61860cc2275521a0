// Models that break renderers. Each equals the reference, and the comparison catches an injected fault.

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "reference/blend_pixel.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "shared/limits.h"
#include "stereo/rig.h"
#include "support/models.h"

namespace binosplat {
namespace {

using test::add;
using test::draw;
using test::psnr;
using test::Uniform;

// All models are for a camera at the origin that looks along z (front_camera), and for the eyes of a rig
// around it.

/// The largest opacity that draws nothing, and the smallest that draws something: the float nearest to 1/255
/// is a little larger than 1/255, so it draws in single and in double precision alike.
constexpr float tau = 1.0f / 255.0f;
const float just_below_tau = std::nextafter(tau, 0.0f);
const float just_above_tau = std::nextafter(tau, 1.0f);

/// Returns the position at this depth that projects to pixel (x, y). Pixel centres are at integers from 0.
glm::vec3 behind_pixel(const Camera& camera, double x, double y, double depth) {
  return glm::vec3((x + 0.5 - camera.cx) / camera.fx * depth, (y + 0.5 - camera.cy) / camera.fy * depth,
                   depth);
}

/// Faint grey specks in one tile, and one opaque red Gaussian behind them that covers the tile.
///
/// The list is longer than the 65,535 iterations of llvmpipe's loops, than 16-bit counters and than a batch
/// in shared memory. A list cut short has no red; a blend that stops early has too little.
Model crowded_tile(const Camera& camera, int tile_x, int tile_y, int count = 70'000) {
  Uniform uniform(70);
  Model model;
  model.name = "crowded tile";
  for (int i = 0; i < count; ++i) {
    const double depth = 2.0 + 6.0 * i / count;
    // A speck's radius is half a pixel: it stays in the tile.
    const double x = TILE_SIZE * tile_x + std::floor(uniform(0.0, TILE_SIZE));
    const double y = TILE_SIZE * tile_y + std::floor(uniform(0.0, TILE_SIZE));
    add(model, behind_pixel(camera, x, y, depth), glm::vec3(1e-4f), 0.0042f, glm::vec3(0.5f));
  }
  const double middle = 0.5 * TILE_SIZE - 0.5, depth = 9.0;
  const auto reach = static_cast<float>(TILE_SIZE * depth / camera.fx);
  add(model, behind_pixel(camera, TILE_SIZE * tile_x + middle, TILE_SIZE * tile_y + middle, depth),
      {reach, reach, 0.01f}, 0.9f, {1.0f, 0.0f, 0.0f});
  return model;
}

/// One Gaussian over all tiles of any picture up to 120 degrees across. Every pixel has nearly its opacity of
/// 0.8 times its colour. It breaks 16-bit screen extents, and limited loops over a splat's tiles.
Model blanket() {
  Model model;
  model.name = "blanket";
  add(model, {0.0f, 0.0f, 5.0f}, {50.0f, 50.0f, 0.01f}, 0.8f, {0.2f, 0.6f, 0.9f});
  return model;
}

/// Gaussians of equal depth, alternately black and white. All overlap in the middle, more than a workgroup of
/// 256. Equal depths are drawn in the order of their indices. Any other order, such as `backwards`, makes
/// another picture.
Model equal_depths(int count = 300, bool backwards = false) {
  Uniform uniform(300);
  Model model;
  model.name = "equal depths";
  struct Place {
    glm::vec3 position;
    float colour;
  };
  std::vector<Place> places;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(-0.4, 0.4), y = uniform(-0.4, 0.4);
    // 37 neighbours have one colour, so that the errors of swapped neighbours do not cancel out.
    places.push_back({glm::vec3(x, y, 3.0), i / 37 % 2 == 0 ? 1.0f : 0.0f});
  }
  if (backwards) std::reverse(places.begin(), places.end());
  for (const Place& place : places)
    add(model, place.position, glm::vec3(0.5f), 0.05f, glm::vec3(place.colour));
  return model;
}

/// 60 ordinary Gaussians, and outliers as captures have them: positions 2e7 away, and scales up to 2e7.
///
/// Those beside and behind the camera leave no mark; the one ahead is a sky behind everything. No sum, square
/// or sort key overflows, and the ordinary ones look as they do alone in front of that sky.
Model far_outliers(bool outliers = true) {
  Uniform uniform(20);
  Model model;
  model.name = "far outliers";
  constexpr float far = 2e7f;
  if (outliers) {
    for (const float size : {1e-3f, 1.0f, 1e5f}) {
      for (const float side : {-far, far}) {
        add(model, {side, 0.0f, 3.0f}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
        add(model, {0.0f, side, 3.0f}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
      }
      add(model, {0.0f, 0.0f, -far}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
      add(model, {far, far, 0.2f * far}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
    }
    add(model, {0.0f, 0.0f, -far}, glm::vec3(far), 0.9f, {1.0f, 0.0f, 1.0f});
  }
  for (int i = 0; i < 60; ++i) {
    const double z = uniform(2.0, 6.0);
    const double x = uniform(-0.4, 0.4) * z, y = uniform(-0.4, 0.4) * z;
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    add(model, glm::vec3(x, y, z), glm::vec3(0.12f), 0.8f, colour);
  }
  if (outliers) add(model, {0.0f, 0.0f, far}, glm::vec3(far), 0.9f, {0.4f, 0.6f, 0.9f});
  return model;
}

/// Gaussians of one opacity with their means at centres of pixels. At an opacity of just_below_tau or 0,
/// nothing is drawn. At tau or just_above_tau, each changes only the pixel of its mean, by 1/255.
Model transparent(const Camera& camera, float opacity, int count = 200) {
  Uniform uniform(255);
  Model model;
  model.name = "transparent";
  for (int i = 0; i < count; ++i) {
    const double x = std::floor(uniform(0, camera.width)), y = std::floor(uniform(0, camera.height));
    add(model, behind_pixel(camera, x, y, uniform(2.0, 6.0)), glm::vec3(0.1f), opacity, glm::vec3(1.0f));
  }
  return model;
}

/// One white Gaussian of opacity exactly tau in the middle of a pixel, without any rounding. That pixel is
/// 1/255, all others 0, and there is one pair. With TILES_ELLIPSE its ellipse is a single point.
Model exactly_tau(const Camera& camera) {
  Model model;
  model.name = "exactly tau";
  add(model, behind_pixel(camera, 0.5 * camera.width, 0.5 * camera.height, 2.0), glm::vec3(0.25f), tau,
      glm::vec3(1.0f));
  return model;
}

TEST(HostileModels, CrowdedTileIsComplete) {
  const Camera camera = test::front_camera(48, 48, 64);
  const Model model = crowded_tile(camera, 1, 1);
  const shared::View view = make_view(camera);
  const Picture drawn = draw(model, view);
  EXPECT_GE(psnr(drawn, reference::render(model, view)), 80.0);
  // Injected: the list that llvmpipe's 65,535 iterations would leave.
  const auto splats = reference::project_all(model, view);
  auto order = reference::depth_order(splats);
  ASSERT_GT(order.size(), 70000u);
  order.resize(65535);
  const auto lists = reference::make_lists(splats, order, view, TILES_ELLIPSE);
  EXPECT_LT(psnr(drawn, reference::blend(splats, lists, view)), 60.0);
}

// llvmpipe of Mesa 22 ends lists of this length early, so they are drawn in parts (LIST_PART). Mesa 25 ends
// none.
TEST(HostileModels, LongListIsContinued) {
  const Camera camera = test::front_camera(48, 48, 64);
  const Model model = crowded_tile(camera, 1, 1, 250'000);
  const shared::View view = make_view(camera);
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    const DepthKind depth = projection == Projection::affine ? DepthKind::mean : DepthKind::median;
    SCOPED_TRACE(name_of(projection));
    const Picture expected =
        reference::render(model, view, {.perspective = Perspective{Order::depth, projection}});
    std::uint32_t parts = 1;
    const auto drawn = [&] {
      render::Frame frame(test::gl_context(), model);
      frame.draw(std::vector{view}, {{.projection = projection, .depth = depth}});
      parts = frame.plan().list_parts;
      return frame.read_pictures().front();
    };
    EXPECT_GE(psnr(drawn(), expected), 80.0);
    EXPECT_TRUE(parts == 1 || test::gl_context().software()) << "no driver of a GPU ends loops early";
    if (parts == 1) continue;
    const test::FaultyShaders faulty("blend_parts.glsl", "transmittance[p] = unfinished[at].a;", "");
    EXPECT_LT(psnr(drawn(), expected), 60.0);
  }
}

// A frame remembers the number of parts, and the next frame's lists may be longer.
TEST(HostileModels, GrowingListIsContinued) {
  if (!test::gl_context().software()) GTEST_SKIP() << "no driver of a GPU ends loops early";
  const Camera camera = test::front_camera(48, 48, 64);
  const Model model = crowded_tile(camera, 1, 1, 450'000);
  render::Frame frame(test::gl_context(), model);
  const shared::View rear = make_view(camera, glm::vec3(0.0f), 5.0), view = make_view(camera);
  frame.draw(std::vector{rear});
  frame.draw(std::vector{view});
  EXPECT_GE(psnr(frame.read_pictures().front(), reference::render(model, view)), 80.0);
}

TEST(HostileModels, GaussianCoversEveryTile) {
  const Model model = blanket();
  const Camera head =
      resized(stereo::apply_preset(test::front_camera(1280, 720, 600), "headset"), 1830, 1600);
  const auto rig = stereo::make_rig(head, {.ipd = 0.064, .convergence = 1.0});
  render::Frame frame(test::gl_context(), model);
  EXPECT_EQ(frame.draw(rig.views).pairs, 2u * 115 * 100);
  const std::vector<Picture> eyes = frame.read_pictures();
  // The reference would take too long for all pixels: it computes some of them.
  for (const std::size_t eye : {0, 1}) {
    const reference::Splat splat = reference::project(model, 0, rig.views[eye]);
    double off = 0.0, off_other = 0.0;
    for (int y = 5; y < head.height; y += TILE_SIZE) {
      for (int x = 7; x < head.width; x += TILE_SIZE) {
        const double light = 1.0 - reference::alpha_at(splat, x, y);
        const glm::dvec4 expected((1.0 - light) * splat.colour, light);
        const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * head.width + x);
        off = std::max(off, glm::length(glm::dvec4(eyes[eye].colour[k]) - expected));
        off_other = std::max(off_other, glm::length(glm::dvec4(eyes[1 - eye].colour[k]) - expected));
      }
    }
    EXPECT_LE(off, 1e-5);
    EXPECT_GT(off_other, 1e-4) << "the other eye's goes unnoticed";
  }
}

TEST(HostileModels, EqualDepthsKeepIndexOrder) {
  const shared::View view = make_view(test::front_camera(96, 96, 96));
  const Picture drawn = draw(equal_depths(), view);
  EXPECT_GE(psnr(drawn, reference::render(equal_depths(), view)), 90.0);
  EXPECT_LT(psnr(drawn, reference::render(equal_depths(300, true), view)), 60.0);
}

TEST(HostileModels, FarOutliersLeaveRestUnchanged) {
  const shared::View view = make_view(test::front_camera(160, 120, 150));
  const Picture drawn = draw(far_outliers(), view);
  EXPECT_GE(psnr(drawn, reference::render(far_outliers(), view)), 80.0);
  EXPECT_LT(psnr(drawn, reference::render(far_outliers(false), view)), 60.0);
}

TEST(HostileModels, BelowTauIsInvisible) {
  const Camera camera = test::front_camera(64, 48, 64);
  const shared::View view = make_view(camera);
  for (const float opacity : {0.0f, just_below_tau}) {
    for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
      for (const glm::vec4& c : draw(transparent(camera, opacity), view, {.tiles = tiles}).colour) {
        EXPECT_EQ(c, glm::vec4(0, 0, 0, 1)) << tiles_choices[tiles].name << " " << opacity;
      }
    }
  }
}

TEST(HostileModels, AboveTauIsVisible) {
  const Camera camera = test::front_camera(64, 48, 64);
  const shared::View view = make_view(camera);
  const float opacity = 1.01f / 255.0f;
  const Picture drawn = draw(transparent(camera, opacity, 2000), view);
  EXPECT_GE(psnr(drawn, reference::render(transparent(camera, opacity, 2000), view)), 80.0);
  EXPECT_LT(psnr(drawn, Picture(64, 48)), 60.0);
}

TEST(HostileModels, ExactlyTauCoversOnePixel) {
  const Camera camera = test::front_camera(64, 48, 64);
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    if (!render::has_every_pair(tiles)) continue;
    const Picture drawn = draw(exactly_tau(camera), make_view(camera), {.tiles = tiles});
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double expected = x == 32 && y == 24 ? 1.0 / 255.0 : 0.0;
        EXPECT_NEAR(drawn.colour[static_cast<std::size_t>(y) * 64 + x].r, expected, 1e-7) << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace binosplat
