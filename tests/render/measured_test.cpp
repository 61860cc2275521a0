// The largest transmittance of each Gaussian, which one frame measures for the next.

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/history.h"
#include "render/support.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::same_bits;

// Returns a wall of opaque splats at depth 2, and three more walls, which the first one hides.
Model wall_of_layers() {
  Model model;
  for (const float z : {2.0f, 4.0f, 5.0f, 6.0f}) {
    for (int y = -12; y <= 12; ++y) {
      for (int x = -12; x <= 12; ++x) {
        const glm::vec3 colour = z == 2.0f ? glm::vec3(0.7f, 0.5f, 0.3f) : glm::vec3(0.1f, 0.2f, 0.9f);
        test::add(model, {0.05f * z * static_cast<float>(x), 0.05f * z * static_cast<float>(y), z},
                  glm::vec3(0.04f * z), 0.98f, colour);
      }
    }
  }
  return model;
}

shared::View wall_view() { return make_view(test::front_camera(96, 80, 90)); }

TEST(MeasuredTransmittance, ReloadedModelStartsAnew) {
  const FrameSettings settings = test::squared(0.5f, Transmittance::last);
  const Model other = test::random_model(83, 1500, 1);
  for (const std::size_t at_first : {std::size_t{400}, std::size_t{5000}}) {
    Model model = test::random_model(82, static_cast<int>(at_first), 1);
    render::Frame frame(test::gl_context(), model);
    for (int n = 0; n < 3; ++n) frame.draw(std::vector{wall_view()}, settings);
    model = other;
    frame.model()->reload();
    EXPECT_FALSE(frame.draw(std::vector{wall_view()}, settings).used_last);
    EXPECT_TRUE(same_bits(frame.read_pictures().front(), test::draw(other, wall_view(), settings)));
    EXPECT_TRUE(frame.draw(std::vector{wall_view()}, settings).used_last);
    // Injected: the model changes, but is not uploaded.
    model.position[700] += 0.5f;
    frame.draw(std::vector{wall_view()}, settings);
    EXPECT_FALSE(same_bits(frame.read_pictures().front(), test::draw(model, wall_view(), settings)));
  }
}

TEST(MeasuredTransmittance, KeepsPictureUnchanged) {
  const Model model = test::random_model(81, 4000, 1);
  const shared::View view = make_view(test::front_camera(160, 96, 160));
  const Picture exact = test::draw(model, view);
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 3; ++n) frame.draw(std::vector{view}, {{.transmittance = Transmittance::last}});
  EXPECT_TRUE(same_bits(frame.read_pictures().front(), exact));
}

TEST(MeasuredTransmittance, MatchesReference) {
  for (const Model& model : {test::random_model(86, 4000, 0), wall_of_layers()}) {
    const std::vector<float> measured = test::measured_on_gpu(model, wall_view());
    // With fp32, a few Gaussians may be blended in one pixel more or less.
    const std::size_t few = model.count() / 500;
    EXPECT_LE(test::differing(measured, model, wall_view()), few);
    EXPECT_GT(std::count_if(measured.begin(), measured.end(), [](float m) { return m < 0.5f; }), 100);
    Model fainter = model;  // injected: transmittances that are slightly off
    for (float& opacity : fainter.opacity) opacity *= 0.98f;
    EXPECT_GT(test::differing(measured, fainter, wall_view()), 10 * few);
  }
}

TEST(MeasuredTransmittance, StillCameraMeasuresSomeFrames) {
  const Model model = wall_of_layers();
  FrameSettings settings = test::squared(0.05f, Transmittance::last);
  settings.measure_every = 4;
  FrameSettings every = settings;
  every.measure_every = 1;
  render::Frame frame(test::gl_context(), model), measured(test::gl_context(), model);
  std::string recorded;
  for (int n = 0; n < 16; ++n) {
    recorded += frame.draw(std::vector{wall_view()}, settings).measured ? 'r' : '-';
    // A frame that does not measure equals the next one that does.
    if (n < 4 || n % 4 == 0) measured.draw(std::vector{wall_view()}, every);
    EXPECT_TRUE(same_bits(frame.read_pictures().front(), measured.read_pictures().front())) << n;
  }
  EXPECT_EQ(recorded, "rrrr---r---r---r");
  frame.forget();
  EXPECT_TRUE(frame.draw(std::vector{wall_view()}, settings).measured);
}

TEST(MeasuredTransmittance, LargeMotionMeasuresAnew) {
  const Model model = wall_of_layers();
  FrameSettings settings = test::squared(0.05f, Transmittance::last);
  settings.measure_every = 6;
  render::Frame frame(test::gl_context(), model);
  std::string recorded;
  for (int n = 0; n < 16; ++n) {
    Camera camera = test::front_camera(96, 80, 90);
    const double turned = glm::radians(n < 8 ? 0.0 : 2.0 * (n - 7));
    camera.rotation = glm::dmat3(glm::rotate(glm::dmat4(1.0), turned, glm::dvec3(0, 1, 0)));
    recorded += frame.draw(std::vector{make_view(camera)}, settings).measured ? 'r' : '-';
  }
  EXPECT_EQ(recorded.substr(0, 8), "rrrrrr--");
  EXPECT_EQ(recorded.substr(8), "--r--r--");
}

TEST(MeasuredTransmittance, FirstFrameAssumesFullTransmittance) {
  const Model model = wall_of_layers();
  const FrameSettings one = test::squared(0.05f);
  const FrameSettings last = test::squared(0.05f, Transmittance::last);
  const Picture expected = test::draw(model, wall_view(), one);
  render::Frame frame(test::gl_context(), model);
  frame.draw(std::vector{wall_view()}, last);
  EXPECT_TRUE(same_bits(frame.read_pictures().front(), expected));
  frame.draw(std::vector{wall_view()}, last);
  EXPECT_FALSE(same_bits(frame.read_pictures().front(), expected));  // the second frame knows what is hidden
  Camera elsewhere = test::front_camera(96, 80, 90);
  elsewhere.position = {1.5, 0, 0};
  frame.draw(std::vector{make_view(elsewhere)}, last);
  EXPECT_TRUE(same_bits(frame.read_pictures().front(), test::draw(model, make_view(elsewhere), one)));
}

TEST(MeasuredTransmittance, RemovesHiddenPairs) {
  const Model model = wall_of_layers();
  const Picture exact = test::draw(model, wall_view());
  for (const Threshold threshold : {Threshold::adagscale, Threshold::squared}) {
    const FrameSettings settings = {{.tolerance = threshold == Threshold::squared ? 1e-3f : 0.3f,
                                     .threshold = threshold,
                                     .transmittance = Transmittance::last}};
    render::Frame frame(test::gl_context(), model);
    const auto first = frame.draw(std::vector{wall_view()}, settings);
    auto report = first;
    for (int n = 0; n < 10; ++n) report = frame.draw(std::vector{wall_view()}, settings);
    EXPECT_LT(static_cast<double>(report.pairs), 0.8 * static_cast<double>(first.pairs))
        << name_of(threshold);
    EXPECT_GT(test::psnr(frame.read_pictures().front(), exact), 45.0) << name_of(threshold);
  }
}

TEST(MeasuredTransmittance, RevealedSplatsReturn) {
  // The front wall disappears in the next frame. Within a few frames, the measurements of the splats that it
  // hid must recover.
  const Model model = wall_of_layers();
  const FrameSettings settings = test::squared(0.01f, Transmittance::last);
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 5; ++n) frame.draw(std::vector{wall_view()}, settings);
  // The near plane removes the wall: splats nearer than 3 are not drawn.
  const shared::View opened = make_view(test::front_camera(96, 80, 90), 3.0);
  const Picture exact = test::draw(model, opened);
  double db = 0;
  for (int n = 0; n < 25; ++n) {
    frame.draw(std::vector{opened}, settings);
    db = test::psnr(frame.read_pictures().front(), exact);
  }
  EXPECT_GT(db, 35.0);
}

TEST(MeasuredTransmittance, RedrawnFrameMeasuresSame) {
  const Model model = test::random_model(83, 4000, 1);
  const std::vector views = {make_view(test::front_camera(120, 90, 110))};
  const FrameSettings settings = test::squared(0.05f, Transmittance::last);
  render::Frame ample(test::gl_context(), model);
  render::Frame tight(test::gl_context(), model);
  for (int n = 0; n < 3; ++n) {
    ample.draw(views, settings);
    tight.draw(views, settings, {.slots = 10 + n});
    EXPECT_TRUE(same_bits(ample.read_pictures().front(), tight.read_pictures().front())) << n;
  }
}

TEST(Continuity, DistinguishesMotionFromCut) {
  const Model model = test::random_model(85, 10, 0);
  const FrameSettings settings = {{.transmittance = Transmittance::last}};
  const auto plan = [&](const Camera& camera) {
    return render::make_plan(std::vector{make_view(camera)}, settings, model);
  };
  const Camera before = test::front_camera(64, 64, 64);
  const auto turned = [&](double degrees) {
    Camera camera = before;
    const double a = glm::radians(degrees);
    camera.rotation = glm::dmat3(std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a));
    return camera;
  };
  const auto moved = [&](double by) {
    Camera camera = before;
    camera.position.x += by;
    return camera;
  };
  const auto motion = [&](const Camera& camera) { return render::motion(plan(before), plan(camera), 2.0); };
  EXPECT_EQ(motion(before), 0.0);
  EXPECT_NEAR(motion(turned(12)), 0.8, 1e-4);
  EXPECT_NEAR(motion(turned(16)), 16.0 / 15.0, 1e-4);
  EXPECT_NEAR(motion(moved(0.15)), 0.75, 1e-4);
  EXPECT_NEAR(motion(moved(0.21)), 1.05, 1e-4);
  EXPECT_TRUE(std::isinf(motion(test::front_camera(64, 65, 64))));
  EXPECT_TRUE(std::isinf(render::motion(render::FramePlan(), plan(before), 2.0)));
}

}  // namespace
}  // namespace binosplat
