// Panoramas (half a sphere around each eye): compares pixels with pictures from cameras with other
// orientations.

#include "stereo/panorama.h"

#include <gtest/gtest.h>

#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/turns.h"

namespace binosplat {
namespace {

using stereo::Panorama;

constexpr int side = 32;
constexpr std::size_t every = 7;  // one pixel in 7 is compared, since each needs a picture
constexpr double near_plane = 0.05;

// Returns Gaussians on all sides, also small ones, which few rays meet.
Model around(std::uint32_t seed, int count) {
  test::Uniform uniform(seed);
  Model model;
  model.name = "around";
  for (int i = 0; i < count; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 6.2831853), across = std::sqrt(1 - z * z);
    const double distance = std::exp(uniform(-0.5, 2.0));
    const glm::vec3 place(distance * across * std::cos(angle), distance * across * std::sin(angle),
                          distance * z);
    const auto scale = [&] { return static_cast<float>(distance * std::exp(uniform(-6.5, -2.0))); };
    test::add(model, place, glm::vec3(scale(), scale(), scale()), static_cast<float>(uniform(0.2, 1)),
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)),
              glm::vec4(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
  }
  return model;
}

std::array<Camera, 2> eyes_of_head() {
  Camera head = test::front_camera(side, side, 20);
  head.position = {0.1, -0.2, 0.05};
  head.rotation = test::turned(head, glm::normalize(glm::dvec3(1, 2, 3)), 0.4).rotation;
  return stereo::make_rig(head, {.ipd = 0.1, .near_plane = near_plane}).cameras;
}

std::vector<Picture> drawn(const Model& model, const std::vector<Camera>& of_eyes) {
  Panorama panorama(std::make_shared<render::GpuModel>(test::gl_context(), model), side);
  panorama.draw(of_eyes, near_plane);
  return panorama.read_pictures();
}

// Returns the panorama of a single eye. One of four turned cameras draws each ray; none of them is a face of
// Panorama.
Picture expected_panorama(const Model& model, const Camera& eye) {
  render::Frame frame(test::gl_context(), model);
  Picture picture(side, side);
  std::vector<bool> is_seen(picture.colour.size());
  for (const glm::dvec2& turn :
       {glm::dvec2(-0.8, -0.7), glm::dvec2(0.8, -0.7), glm::dvec2(-0.8, 0.7), glm::dvec2(0.8, 0.7)}) {
    Camera camera = test::turned(test::turned(eye, {0, 1, 0}, turn.x), {1, 0, 0}, turn.y);
    camera.fx = camera.fy = side / 3.14159265358979;
    camera.width = camera.height = 4 * side;
    camera.cx = camera.cy = 2.0 * side;
    std::vector<glm::dvec2> pixels;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < is_seen.size(); k += every) {
      const glm::dvec3 ray =
          eye.rotation * stereo::panorama_ray(side, static_cast<int>(k % side), static_cast<int>(k / side));
      const glm::dvec2 at = test::pixel_of(camera, ray);
      if (is_seen[k] || !test::is_inside(camera, at)) continue;
      is_seen[k] = true;
      pixels.push_back(at);
      places.push_back(k);
    }
    const auto colours = test::colours_at(
        frame, camera, pixels, {{.order = Order::distance, .projection = Projection::tangent}}, near_plane);
    for (std::size_t n = 0; n < places.size(); ++n) picture.colour[places[n]] = glm::vec4(colours[n], 0.0f);
  }
  EXPECT_EQ(std::ranges::count(is_seen, true), (side * side - 1) / every + 1);
  return picture;
}

// Returns the PSNR of the compared pixels, over black.
double psnr(const Picture& a, const Picture& b) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < a.colour.size(); k += every, count += 3.0) {
    const glm::vec3 off = glm::vec3(a.colour[k]) - glm::vec3(b.colour[k]);
    sum += glm::dot(off, off);
  }
  return -10.0 * std::log10(sum / count);
}

TEST(Panoramas, MatchCamerasAlongRays) {
  const Model model = around(7, 1500);
  const Picture wanted = expected_panorama(model, eyes_of_head()[1]);
  EXPECT_GE(psnr(drawn(model, {eyes_of_head()[1]})[0], wanted), 100.0);
  EXPECT_LE(psnr(drawn(model, {eyes_of_head()[0]})[0], wanted), 40.0) << "the other eye's place";
  const test::FaultyShaders faulty("tiles/tiles.glsl", "#define REACH 0.5", "#define REACH 0.0");
  EXPECT_LE(psnr(drawn(model, {eyes_of_head()[1]})[0], wanted), 80.0)
      << "what lies between pixels' centres is lost";
}

TEST(Panoramas, RaysCoverFrontHemisphere) {
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const glm::dvec3 ray = stereo::panorama_ray(side, i, j);
      EXPECT_NEAR(glm::length(ray), 1.0, 1e-12);
      EXPECT_GT(ray.z, 0.0);
    }
  }
  EXPECT_LT(stereo::panorama_ray(side, 0, side / 2).x, -0.99) << "the left edge is to the left";
  EXPECT_LT(stereo::panorama_ray(side, side / 2, 0).y, -0.99) << "the upper edge is up";
}

TEST(Panoramas, DrawBothEyesTogether) {
  const Model model = around(8, 800);
  const auto [left, right] = eyes_of_head();
  const std::vector<Picture> both = drawn(model, {left, right});
  ASSERT_EQ(both.size(), 2U);
  // Both panoramas are sorted from the point between the eyes, and still nearly equal the panorama of one
  // eye.
  const Image of_left = on_black(drawn(model, {left})[0]), of_right = on_black(drawn(model, {right})[0]);
  EXPECT_GE(measure::psnr(on_black(both[0]), of_left), 50.0);
  EXPECT_GE(measure::psnr(on_black(both[1]), of_right), 50.0);
  EXPECT_LE(measure::psnr(on_black(both[0]), of_right), 28.0);
}

TEST(Panoramas, ReportTimeOfAllStages) {
  const Model few = around(9, 200);
  Panorama panorama(std::make_shared<render::GpuModel>(test::gl_context(), few), side);
  const std::vector<Camera> eye = {eyes_of_head()[0]};
  const Report report = panorama.draw(eye, near_plane);
  double sum = 0.0;
  for (const StageTime& stage : report.stages) sum += stage.ms;
  EXPECT_EQ(report.stages.back().name, "blend");
  EXPECT_GT(report.stages.back().ms, 0.0);
  EXPECT_NEAR(report.gpu_ms, sum, 1e-9);
}

// A tile of a small panorama sees much of a scene, and drivers end loops after 65,535 iterations.
TEST(Panoramas, HandleLongLists) {
  Model model;  // most are beside the pixel but in its tile
  for (int k = 0; k < 70000; ++k)
    test::add(model, glm::vec3(-1.4f, 0, 3), glm::vec3(0.05f), 0.5f, glm::vec3(1.0f));
  test::add(model, glm::vec3(0, 0, 4), glm::vec3(2.0f), 0.5f, glm::vec3(1.0f));
  const Picture picture = drawn(model, {test::front_camera(side, side, 20)})[0];
  EXPECT_NEAR(picture.colour[static_cast<std::size_t>(side) * side / 2 + side / 2].r, 0.5f, 0.05f)
      << "the last of the list is lost";
}

TEST(Panoramas, ReportDistances) {
  Model model;
  for (const glm::vec3& place : {glm::vec3(0, 0, 3), glm::vec3(2, 0, 0.05), glm::vec3(0, -4, 0.05)})
    test::add(model, place, glm::vec3(0.4f), 0.99f, glm::vec3(1.0f));
  const Picture picture = drawn(model, {test::front_camera(side, side, 20)})[0];
  const Image depth = depth_map(picture);
  EXPECT_NEAR(depth.at(side / 2, side / 2, 0), 3.0, 0.01);
  EXPECT_NEAR(depth.at(side - 1, side / 2, 0), 2.0, 0.01);
  EXPECT_NEAR(depth.at(side / 2, 0, 0), 4.0, 0.01);
}

TEST(Panoramas, RejectInvalidSizes) {
  const Model few = around(9, 10);
  const auto model = std::make_shared<render::GpuModel>(test::gl_context(), few);
  EXPECT_ERROR(Panorama(model, 41), "41 x 41", "even");
  EXPECT_ERROR(Panorama(model, 0), "from 2 to");
}

}  // namespace
}  // namespace binosplat
