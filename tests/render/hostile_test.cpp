// Models that break renderers: each right against the reference, with a fault that the comparison catches. A
// tile of 70,000 splats is in frame_test.cpp.

#include <cmath>

#include "render/support.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

constexpr float tau = static_cast<float>(ALPHA_MIN);

TEST(Hostile, OneGaussianOverEveryTileOfAHeadsetPair) {
  Model model;
  test::add(model, {0.3f, -0.2f, 2}, glm::vec3(6.0f, 4.0f, 5.0f), 0.8f, {0.9f, 0.4f, 0.2f},
            {1, 0.2f, 0.1f, 0.3f});
  const Camera head = stereo::apply_preset(test::front_camera(1280, 720, 600), "headset");
  const auto rig = stereo::make_rig(head, {.ipd = 0.064});
  render::Frame frame(test::gl_context(), model);
  const auto report = frame.draw(rig.views);
  EXPECT_EQ(report.pairs, 2u * 229 * 200);
  const std::vector<Picture> eyes = frame.read_pictures();
  for (const int eye : {0, 1}) {
    const Picture expected = reference::render(model, rig.views[static_cast<std::size_t>(eye)]);
    EXPECT_GE(test::psnr(eyes[static_cast<std::size_t>(eye)], expected), 90.0);
    EXPECT_LT(test::psnr(eyes[static_cast<std::size_t>(1 - eye)], expected),
              60.0);  // the other eye's is told apart
  }
}

TEST(Hostile, ManyGaussiansAtEqualDepthAreInTheOrderOfTheirIndices) {
  Model model;
  test::Uniform uniform(91);
  for (int i = 0; i < 300; ++i) {
    test::add(model, {uniform(-0.5, 0.5), uniform(-0.5, 0.5), 2}, glm::vec3(0.1f), 0.7f,
              glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)));
  }
  const shared::View view = make_view(test::front_camera(96, 96, 96));
  const Picture drawn = test::draw(model, view);
  EXPECT_GE(test::psnr(drawn, reference::render(model, view)), 90.0);
  Model reversed;  // any other order is another picture
  for (std::size_t i = model.count(); i-- > 0;) {
    const glm::vec3 colour(model.sh[3 * i], model.sh[3 * i + 1], model.sh[3 * i + 2]);
    test::add(reversed, model.position[i], model.scale[i], model.opacity[i],
              colour * static_cast<float>(test::sh_c0) + 0.5f);
  }
  EXPECT_LT(test::psnr(drawn, reference::render(reversed, view)), 40.0);
}

TEST(Hostile, OutliersTwentyMillionUnitsAwayLeaveTheRestAlone) {
  const Model scene = test::random_model(92, 200, 0);
  Model model = scene;
  const float far = 2e7f;
  for (const glm::vec3& p : {glm::vec3(far, 0, far), glm::vec3(-far, far, 1), glm::vec3(0, 0, far),
                             glm::vec3(far, far, -far), glm::vec3(0, -far, 0.3f)}) {
    test::add(model, p, glm::vec3(1e6f, 1e3f, 1e6f), 0.9f, {0.2f, 0.9f, 0.3f});
    test::add(model, p, glm::vec3(1e-3f), 0.9f);
  }
  const shared::View view = make_view(test::front_camera(160, 120, 150));
  const Picture drawn = test::draw(model, view);
  const Picture expected = reference::render(model, view);
  EXPECT_GE(test::psnr(drawn, expected), 80.0);
  EXPECT_LT(test::psnr(test::draw(scene, view), expected), 60.0);  // some of them are seen
}

TEST(Hostile, AModelOfWhatCannotBeSeenIsAllBackground) {
  Model model;
  test::Uniform uniform(93);
  for (int i = 0; i < 500; ++i) {
    const float opacity = i % 2 == 0 ? 0.0f : std::nextafter(tau, 0.0f);
    test::add(model, {uniform(-0.5, 0.5), uniform(-0.5, 0.5), 2}, glm::vec3(0.1f), opacity);
  }
  const shared::View view = make_view(test::front_camera(64, 64, 64));
  for (const int tiles : {TILES_AABB, TILES_ELLIPSE, TILES_ALL}) {
    for (const glm::vec4& c : test::draw(model, view, {.tiles = tiles}).colour)
      EXPECT_EQ(c, glm::vec4(0, 0, 0, 1));
  }
}

TEST(Hostile, AModelThatCanBarelyBeSeenIsSeenEverywhere) {
  // 400 layers over the whole picture, each a shade above tau.
  Model model;
  for (int i = 0; i < 400; ++i) {
    const float z = 1.0f + 0.01f * static_cast<float>(i);
    test::add(model, {0, 0, z}, glm::vec3(1e3f), tau * 1.01f, glm::vec3(i % 2 == 0 ? 1.0f : 0.25f));
  }
  const shared::View view = make_view(test::front_camera(64, 48, 64));
  const Picture drawn = test::draw(model, view);
  EXPECT_GE(test::psnr(drawn, reference::render(model, view)), 80.0);
  const double left = std::pow(1.0 - 1.01 / 255.0, 400);
  for (const glm::vec4& c : drawn.colour) EXPECT_NEAR(c.a, left, 1e-4);
}

}  // namespace
}  // namespace binosplat
