// Orders and projections: each against the reference, and what turning the head does to each.

#include <fmt/format.h>

#include "measure/rays.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/scenes.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::draw;
using test::psnr;
using test::same_bits;

// Gaussians on all sides of the origin, behind it, too; some near and as wide as the view.
Model surrounding_model(std::uint32_t seed, int count) {
  test::Uniform uniform(seed);
  Model model;
  model.name = "surrounding";
  for (int i = 0; i < count; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 6.2831853), across = std::sqrt(1 - z * z);
    const double distance = std::exp(uniform(-1.2, 2.0));
    const glm::vec3 position(distance * across * std::cos(angle), distance * across * std::sin(angle), distance * z);
    const auto scale = [&] { return static_cast<float>(distance * std::exp(uniform(-6.5, i % 20 == 0 ? 0.0 : -2.5))); };
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

constexpr Perspective perspectives[] = {{ORDER_DEPTH, PROJECTION_AFFINE},
                                        {ORDER_DISTANCE, PROJECTION_AFFINE},
                                        {ORDER_DEPTH, PROJECTION_TANGENT},
                                        {ORDER_DISTANCE, PROJECTION_TANGENT}};
constexpr Perspective steady{ORDER_DISTANCE, PROJECTION_TANGENT};

// 110 degrees across, a lens that is neither centred nor square.
Camera wide_camera() {
  Camera camera = test::front_camera(180, 130, 63);
  camera.fy = 70;
  camera.cx = 97;
  camera.cy = 58;
  return camera;
}

std::string name_of(const Perspective& p) {
  return std::string(order_choices[p.order].name) + "_" + projection_choices[p.projection].name;
}

class InPerspective : public testing::TestWithParam<Perspective> {};

TEST_P(InPerspective, EqualsTheReference) {
  const shared::View view = make_view(wide_camera());
  for (const Model& plain : {test::random_model(61, 3000, 1), surrounding_model(62, 4000)}) {
    const Model model = in(GetParam(), plain);
    SCOPED_TRACE(model.name);
    const Picture expected = reference::render(model, view);
    const Picture drawn = draw(model, view);
    EXPECT_GE(psnr(drawn, expected), 80.0) << model.name;
    EXPECT_GE(psnr(draw(model, view, {.precision = PRECISION_HALF}), expected), 60.0) << model.name;
    for (const Perspective& other : perspectives) {
      if (other == GetParam()) continue;
      EXPECT_LT(psnr(drawn, reference::render(model, view, {.perspective = other})), 50.0) << name_of(other);
      const Picture by_settings = draw(model, view, {.order = other.order, .projection = other.projection});
      EXPECT_TRUE(same_bits(by_settings, draw(in(other, plain), view))) << name_of(other);
    }
  }
}

TEST_P(InPerspective, DepthIsTheReferences) {
  const Model model = in(GetParam(), surrounding_model(63, 4000));
  const shared::View view = make_view(wide_camera());
  const Picture drawn = draw(model, view), expected = reference::render(model, view);
  double worst = 0.0;
  for (std::size_t k = 0; k < drawn.z_sum.size(); ++k)
    worst = std::max(worst, std::abs(double(drawn.z_sum[k]) - expected.z_sum[k]));
  EXPECT_LE(worst, 0.05);  // a Gaussian at tau
  EXPECT_GT(worst, 0.0);
}

TEST_P(InPerspective, EllipseAndSnugEqualBruteForceBitForBit) {
  const Model model = in(GetParam(), surrounding_model(64, 3000));
  const shared::View view = make_view(wide_camera());
  for (const int precision : {PRECISION_FULL, PRECISION_HALF}) {
    const Picture brute = draw(model, view, {.tiles = TILES_ALL, .precision = precision});
    for (const int tile_size : {8, 16, 32}) {
      for (const int tiles : {TILES_ELLIPSE, TILES_SNUG}) {
        EXPECT_TRUE(same_bits(draw(model, view, {.tiles = tiles, .tile_size = tile_size, .precision = precision}), brute))
            << tiles_choices[tiles].name << ", tiles of " << tile_size;
      }
    }
    EXPECT_FALSE(same_bits(draw(model, view, {.tiles = TILES_AABB, .precision = precision}), brute));
    EXPECT_FALSE(same_bits(draw(model, view, {.tiles = TILES_OBB, .precision = precision}), brute));
  }
}

// PSNR of what turned heads see along the same rays against what the head sees that is not turned.
double consistency(const Model& model, const Perspective& perspective, const Camera& camera, double field_degrees,
                   int count, const glm::dvec3& axis, double degrees) {
  render::Frame frame(test::gl_context(), model);
  const FrameSettings settings{.order = perspective.order, .projection = perspective.projection};
  const Camera turned = measure::turned(camera, axis, glm::radians(degrees));
  test::Uniform uniform(7);
  std::vector<glm::dvec2> at, there;
  const double reach = camera.fx * std::tan(glm::radians(0.5 * field_degrees));
  while (count-- > 0) {
    const glm::dvec2 pixel(std::floor(camera.cx + uniform(-reach, reach)), std::floor(camera.cy + uniform(-reach, reach)));
    const glm::dvec2 other = measure::pixel_of(turned, measure::ray_through(camera, pixel));
    if (!measure::is_inside(camera, pixel) || !measure::is_inside(turned, other)) continue;
    at.push_back(pixel);
    there.push_back(other);
  }
  const auto a = measure::colours_at(frame, camera, at, settings), b = measure::colours_at(frame, turned, there, settings);
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += glm::dot(glm::dvec3(a[k] - b[k]), glm::dvec3(a[k] - b[k])) / 3.0;
  return -10.0 * std::log10(sum / static_cast<double>(a.size()));
}

TEST(Turn, Scenes) {
  for (const char* which : {"fox", "garden"}) {
  const std::string scene = which;
  REQUIRE_SCENE(scene, folder);
  const Model model = load_model(folder / (scene + ".ply"));
  for (Camera camera : load_cameras(folder / "cameras.json")) {
    if (camera.name != "0042" && camera.name != "DSC08116") continue;
    camera = stereo::apply_preset(camera, "headset");
    camera.width /= 2; camera.height /= 2; camera.fx /= 2; camera.fy /= 2; camera.cx /= 2; camera.cy /= 2;
    for (const Perspective& p : {perspectives[0], perspectives[3]})
      for (double degrees : {0.25, 5.0, 15.0, 45.0})
        fmt::print("{} {} {}: {:.1f}\n", scene, name_of(p), degrees, consistency(model, p, camera, 60, std::getenv("RAYS")?atoi(std::getenv("RAYS")):200, {0, 1, 0}, degrees)), std::fflush(stdout);
  }
  }
}

INSTANTIATE_TEST_SUITE_P(All, InPerspective, testing::ValuesIn(perspectives),
                         [](const auto& one) { return name_of(one.param); });

}  // namespace
}  // namespace binosplat
