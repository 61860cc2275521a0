// Sort orders and projections, each compared with the reference, and the changes when the head turns.

#include <algorithm>

#include "adagscale/depth_table.h"
#include "base/choices.h"
#include "demo/demo.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/scenes.h"
#include "support/turns.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::draw;
using test::psnr;
using test::same_bits;

// Returns Gaussians on all sides of the origin, also behind it; some are near and as wide as the view.
Model surrounding_model(std::uint32_t seed, int count) {
  test::Uniform uniform(seed);
  Model model;
  model.name = "surrounding";
  for (int i = 0; i < count; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 6.2831853), across = std::sqrt(1 - z * z);
    const double distance = std::exp(uniform(-1.2, 2.0));
    const glm::vec3 position(distance * across * std::cos(angle), distance * across * std::sin(angle),
                             distance * z);
    const auto scale = [&] {
      return static_cast<float>(distance * std::exp(uniform(-6.5, i % 20 == 0 ? 0.0 : -2.5)));
    };
    const glm::vec3 scales(scale(), scale(), scale());
    const glm::vec4 rotation(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const double opacity = uniform(0, 1);
    test::add(model, position, scales, static_cast<float>(opacity * opacity),
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)), rotation);
  }
  return model;
}

Model in(const Perspective& perspective, Model model) {
  model.perspective = perspective;
  return model;
}

constexpr Perspective perspectives[] = {{Order::depth, Projection::affine},
                                        {Order::distance, Projection::affine},
                                        {Order::depth, Projection::tangent},
                                        {Order::distance, Projection::tangent}};
constexpr Perspective steady{Order::distance, Projection::tangent};

// Returns a camera of 110 degrees, with a lens that is neither centred nor square.
Camera wide_camera() {
  Camera camera = test::front_camera(180, 130, 63);
  camera.fy = 70;
  camera.cx = 97;
  camera.cy = 58;
  return camera;
}

std::string name_of_perspective(const Perspective& p) {
  return std::string(name_of(p.order)) + "_" + name_of(p.projection);
}

class InPerspective : public testing::TestWithParam<Perspective> {};

TEST_P(InPerspective, EqualsReference) {
  const shared::View view = make_view(wide_camera());
  for (const Model& plain : {test::random_model(61, 3000, 1), surrounding_model(62, 4000)}) {
    const Model model = in(GetParam(), plain);
    SCOPED_TRACE(model.name);
    const Picture expected = reference::render(model, view);
    const Picture drawn = draw(model, view);
    EXPECT_GE(psnr(drawn, expected), 80.0);
    double depth_off = 0.0;
    for (std::size_t k = 0; k < drawn.z_sum.size(); ++k)
      depth_off = std::max(depth_off, std::abs(double{drawn.z_sum[k]} - expected.z_sum[k]));
    EXPECT_LE(depth_off, 0.05);  // a Gaussian near tau
    EXPECT_GT(depth_off, 0.0);
    EXPECT_GE(psnr(draw(model, view, {.precision = PRECISION_HALF}), expected), 60.0);
    const Perspective& mine = GetParam();
    const Perspective opposed{
        mine.order == Order::depth ? Order::distance : Order::depth,
        mine.projection == Projection::affine ? Projection::tangent : Projection::affine};
    const Perspective other{opposed.order, mine.projection}, another{mine.order, opposed.projection};
    EXPECT_LT(psnr(drawn, reference::render(model, view, {.perspective = other})), 50.0);
    EXPECT_LT(psnr(drawn, reference::render(model, view, {.perspective = another})), 50.0);
    const Model opposite = in(opposed, plain);
    EXPECT_TRUE(
        same_bits(draw(opposite, view, {{.order = mine.order, .projection = mine.projection}}), drawn))
        << "settings go before what a model was trained with";
  }
}

// frame_test.cpp tests the affine projection. Tiles do not depend on the sort order.
TEST(Perspectives, ExactTilesEqualBruteForce) {
  const Model model = in(steady, surrounding_model(64, 1000));
  const shared::View view = make_view(wide_camera());
  const Picture brute = draw(model, view, {.tiles = TILES_ALL});
  for (const int tiles : test::exact_tiles)
    EXPECT_TRUE(same_bits(draw(model, view, {.tiles = tiles}), brute)) << tiles_choices[tiles].name;
  for (const int tiles : test::clipping_tiles)
    EXPECT_FALSE(same_bits(draw(model, view, {.tiles = tiles}), brute)) << tiles_choices[tiles].name;
  const Picture half = draw(model, view, {.tiles = TILES_ALL, .precision = PRECISION_HALF});
  EXPECT_TRUE(same_bits(draw(model, view, {.precision = PRECISION_HALF}), half));
  EXPECT_FALSE(same_bits(half, brute));
}

// Wide views with Gaussians anywhere around the eye: some as wide as the view, some near the plane through
// the eye parallel to the picture. The pictures have few pixels, so one tile holds rays that see a Gaussian
// and rays that look away from it.
struct WideView {
  explicit WideView(std::uint32_t n)
      : model(in(steady, surrounding_model(900 + n, 30 + 5 * static_cast<int>(n)))) {
    for (std::size_t i = 0; i < model.count(); i += 4) {
      const float distance = glm::length(model.position[i]);
      model.scale[i] = glm::max(model.scale[i], glm::vec3(0.2f, 0.4f, 0.7f) * distance);
      if (i % 8 == 0) model.position[i].z *= std::pow(0.1f, static_cast<float>(i % 5));
    }
    const double half = glm::radians(0.5 * (90.0 + 85.0 * n / 39.0));
    view = make_view(test::front_camera(72, 54, 36.0 / std::tan(half)));
  }

  double worst_psnr() const { return psnr(draw(model, view), reference::render(model, view)); }

  Model model;
  shared::View view;
};

TEST(Perspectives, TilesAreExactForAnyFov) {
  const std::uint32_t step = test::switched_on("BINOSPLAT_LONG") ? 1 : 3;
  for (std::uint32_t n = 0; n < 40; n += step) EXPECT_GE(WideView(n).worst_psnr(), 65.0) << n;
  const test::FaultyShaders faulty("blend_tangent.glsl", "ray) >= 0.0) continue;", "ray) >= -9.0) continue;");
  EXPECT_LT(WideView(39).worst_psnr(), 60.0);
}

TEST_P(InPerspective, PairsEqualReference) {
  const Model model = in(GetParam(), surrounding_model(65, 3000));
  const shared::View view = make_view(wide_camera());
  const bool every_test = test::switched_on("BINOSPLAT_LONG") || !test::gl_context().software();
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    if (tiles == TILES_ALL) continue;
    if (!every_test && tiles != TILES_ELLIPSE && GetParam().order != Order::depth)
      continue;  // tiles do not depend on the sort order
    test::StageRun run(model, {view}, {.tiles = tiles});
    run.run_until(render::Stage::sort);
    std::vector<std::uint32_t> on_gpu(model.count()), expected(model.count());
    for (const auto& list : run.lists())
      for (const std::uint32_t i : list) ++on_gpu[i];
    const auto splats = reference::project_all(model, view);
    for (const std::uint32_t i :
         reference::make_lists(splats, reference::depth_order(splats), view, tiles).gaussians)
      ++expected[i];
    std::size_t all = 0, other = 0, wide = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      all += expected[i];
      other += static_cast<std::size_t>(std::abs(int(on_gpu[i]) - int(expected[i])));
      wide += expected[i] > 0 && splats[i].cone && reference::is_wide(*splats[i].cone) ? 1 : 0;
    }
    EXPECT_GT(all, 1500u);
    EXPECT_LE(other, all / 2000 + 1) << tiles_choices[tiles].name;
    EXPECT_EQ(wide > 20, GetParam().projection == Projection::tangent) << wide;
  }
}

TEST_P(InPerspective, ThresholdsAndStagesEqualReference) {
  const Model model = in(GetParam(), surrounding_model(66, 2000));
  const auto eyes = stereo::make_rig(wide_camera(), {.ipd = 0.06});
  for (const Threshold threshold : test::tolerant_rules) {
    const FrameSettings settings{{.tolerance = 0.5f, .threshold = threshold}};
    const std::vector<Picture> drawn = draw(model, {eyes.views.begin(), eyes.views.end()}, settings);
    for (const std::size_t eye : {0, 1}) {
      const Picture expected =
          reference::render(model, eyes.views[eye], {.threshold = threshold, .tolerance = 0.5});
      EXPECT_GE(psnr(drawn[eye], expected), 68.0);
      EXPECT_LT(psnr(drawn[eye], reference::render(model, eyes.views[eye])), 60.0);
    }
  }
  const std::vector<Picture> own = draw(model, {eyes.views.begin(), eyes.views.end()});
  for (const render::Stage until : {render::Stage::project, render::Stage::bin, render::Stage::sort}) {
    const auto given = draw(model, {eyes.views.begin(), eyes.views.end()}, {}, test::given(until));
    for (const std::size_t eye : {0, 1})
      EXPECT_GE(psnr(given[eye], own[eye]), 80.0) << render::name_of(until);
  }
}

TEST_P(InPerspective, DepthTableUsesThresholdDepth) {
  const Model model = in(GetParam(), surrounding_model(71, 2000));
  const shared::View view = make_view(wide_camera());
  render::Frame frame(test::gl_context(), model);
  const DepthTable table =
      adagscale::measure_depth_table(frame, std::span(&view, 1), {.bins = 40, .far = 8.0f});
  const auto splats = reference::project_all(model, view);
  const auto measured = frame.read_measured(0);
  ASSERT_GT(measured.size(), 200u);
  std::size_t apart = 0;
  for (const render::MeasuredGaussian& gaussian : measured) {
    const double depth = splats[gaussian.index].depth;
    EXPECT_NEAR(gaussian.depth, depth, 1e-4);
    EXPECT_GE(gaussian.depth, 0.0f);
    const auto bin = static_cast<std::size_t>(gaussian.depth / table.far * 40);
    if (bin < 40) {
      EXPECT_GE(table.bounds[bin], gaussian.transmittance);
    }
    apart += std::abs(splats[gaussian.index].order - depth) > 1e-3 ? 1 : 0;
  }
  // Distance and view depth differ here.
  EXPECT_EQ(apart > 100,
            (GetParam().order == Order::distance) != (GetParam().projection == Projection::tangent));
}

TEST_P(InPerspective, EachEyeEqualsMono) {
  const Model model = in(GetParam(), surrounding_model(67, 3000));
  render::Frame frame(test::gl_context(), model);
  for (const double cant : {0.0, 5.0}) {
    const auto rig = stereo::make_rig(wide_camera(), {.ipd = 0.06, .cant_degrees = cant});
    frame.draw(rig.views);
    EXPECT_EQ(frame.plan().groups.size(), cant == 0.0 || GetParam().order == Order::distance ? 1u : 2u);
    const auto both = frame.read_pictures();
    for (const std::size_t eye : {0, 1}) {
      frame.draw(std::span(&rig.views[eye], 1));
      EXPECT_TRUE(same_bits(both[eye], frame.read_pictures().front())) << cant;
      EXPECT_FALSE(same_bits(both[1 - eye], both[eye])) << cant;
    }
  }
}

// Returns the PSNR between the colours that a turned head and the original head see along the same rays.
double consistency(render::Frame& frame, const Camera& camera, const glm::dvec3& axis, double degrees,
                   int count) {
  const Camera turned = test::turned(camera, axis, glm::radians(degrees));
  test::Uniform uniform(7);
  std::vector<glm::dvec2> here, there;
  while (count > 0) {
    const glm::dvec2 pixel(std::floor(uniform(0, camera.width)), std::floor(uniform(0, camera.height)));
    const glm::dvec2 other = test::pixel_of(turned, ray_through(camera, pixel + 0.5));
    if (!test::is_inside(turned, other)) continue;
    here.push_back(pixel);
    there.push_back(other);
    --count;
  }
  const auto a = test::colours_at(frame, camera, here, {}), b = test::colours_at(frame, turned, there, {});
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += glm::dot(glm::dvec3(a[k] - b[k]), glm::dvec3(a[k] - b[k]));
  return -10.0 * std::log10(sum / (3.0 * static_cast<double>(a.size())));
}

void expect_unchanged_by_turning(const Model& plain, const Camera& camera, int rays) {
  const bool is_long = test::switched_on("BINOSPLAT_LONG");
  const Model model = in(steady, plain);
  render::Frame frame(test::gl_context(), model);
  const Model trained = in({}, plain);
  render::Frame other(test::gl_context(), trained);
  for (const glm::dvec3& axis : {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)}) {
    for (const double degrees : is_long ? std::vector{0.25, 1.0, 5.0, 15.0, 45.0} : std::vector{15.0})
      EXPECT_GE(consistency(frame, camera, axis, degrees, rays), 100.0) << plain.name << " " << degrees;
    // A rotation about the viewing axis changes no depth.
    if (axis.z == 0.0) {
      EXPECT_LT(consistency(other, camera, axis, 15.0, rays), 60.0) << plain.name;
    }
  }
}

TEST(HeadTurn, ChangesNothingInSurroundingModel) {
  expect_unchanged_by_turning(surrounding_model(68, 2000), wide_camera(), 24);
}

TEST(HeadTurn, ChangesNothingInScenes) {
  if (!test::switched_on("BINOSPLAT_LONG") && test::gl_context().software())
    GTEST_SKIP() << "two minutes on llvmpipe: set BINOSPLAT_LONG=1";
  for (const Demo& demo : {demo_room(), demo_city({.count = 20'000})})
    expect_unchanged_by_turning(demo.model, stereo::apply_preset(demo.cameras.front(), "headset"), 8);
  for (const auto& [scene, view] : {std::pair("fox", "0042"), std::pair("garden", "DSC08116")}) {
    REQUIRE_SCENE(std::string(scene), folder);
    const auto cameras = load_cameras(folder / "cameras.json");
    const auto camera =
        std::find_if(cameras.begin(), cameras.end(),
                     [&, name = std::string(view)](const Camera& c) { return c.name == name; });
    ASSERT_NE(camera, cameras.end());
    const int rays = test::gl_context().software() ? 16 : 2000;
    expect_unchanged_by_turning(load_model(folder / (std::string(scene) + ".ply")),
                                stereo::apply_preset(*camera, "headset"), rays);
  }
}

// Frames of one pixel each equal the pixels of a whole picture.
TEST(HeadTurn, SinglePixelsEqualPicture) {
  for (const Perspective& perspective : perspectives) {
    const Model model = in(perspective, surrounding_model(69, 2000));
    render::Frame frame(test::gl_context(), model);
    const Camera camera = wide_camera();
    const Picture whole = draw(model, make_view(camera));
    std::vector<glm::dvec2> pixels;
    for (int k = 0; k < 16; ++k) pixels.emplace_back((37 * k) % camera.width, (53 * k) % camera.height);
    const auto colours = test::colours_at(frame, camera, pixels, {});
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const auto at = static_cast<std::size_t>(pixels[k].y * camera.width + pixels[k].x);
      EXPECT_LE(glm::length(glm::vec3(whole.colour[at]) - colours[k]), 1e-4)
          << name_of_perspective(perspective) << " " << k;
    }
  }
}

TEST(Perspectives, ComparisonDetectsFault) {
  const shared::View view = make_view(wide_camera());
  const Model model = in(steady, surrounding_model(70, 3000));
  const Picture expected = reference::render(model, view);
  EXPECT_GE(psnr(draw(model, view), expected), 80.0);
  const test::FaultyShaders faulty("blend_tangent.glsl", "fma(ray.x, ray.x, 1.0)",
                                   "0.99 * fma(ray.x, ray.x, 1.0)");
  EXPECT_LT(psnr(draw(model, view), expected), 75.0);
}

INSTANTIATE_TEST_SUITE_P(All, InPerspective, testing::ValuesIn(perspectives),
                         [](const auto& one) { return name_of_perspective(one.param); });

}  // namespace
}  // namespace binosplat
