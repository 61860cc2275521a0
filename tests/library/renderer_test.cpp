// binosplat in another program: views as OpenXR gives them, that program's state, and whose errors are whose.

#include "stereo/embed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/gtc/quaternion.hpp>

#include "gl/state.h"
#include "stereo/embed_fixture.h"
#include "support/caller.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

/// One bright ball at (right, up, forward) of the head, in metres.
Model ball(const glm::dvec3& at, double units = 1.0) {
  Model model;
  test::add(model, glm::vec3(glm::dvec3(at.x, -at.y, at.z) * units),
            glm::vec3(0.01f * static_cast<float>(units)), 0.99f);
  return model;
}

/// Centre of what is bright in pixels from OpenGL's lower left.
glm::dvec2 centre_of_pixels(const std::vector<float>& pixels) {
  glm::dvec2 sum(0.0);
  double weight = 0.0;
  for (int k = 0; k < size.x * size.y; ++k) {
    const double v = pixels[4 * static_cast<std::size_t>(k)];
    sum += v * glm::dvec2(k % size.x, k / size.x);
    weight += v;
  }
  return sum / weight;
}

/// Where the angles put a direction (right, up, forward) of an eye, in the same pixels.
glm::dvec2 expected_centre(const Fov& fov, const glm::dvec3& v) {
  const auto along = [](double low, double high, double tangent, int pixels) {
    return (tangent - std::tan(low)) / (std::tan(high) - std::tan(low)) * pixels - 0.5;
  };
  return {along(fov.left, fov.right, v.x / v.z, size.x), along(fov.down, fov.up, v.y / v.z, size.y)};
}

TEST_F(Embed, AnglesAndPosesAreOpenXrs) {
  for (const double cant : {0.0, 10.0}) {
    for (const double units : {1.0, 4.0}) {
      const glm::dvec3 at(0.3, 0.2, 1.5);
      const Model model = ball(at, units);
      EmbeddedRenderer renderer(caller.get_proc_address(), model);
      const auto eyes = quest_eyes(cant);
      Stage there = stage;
      there.origin *= units;
      there.units_per_metre = units;
      const EyePair pair = eyes_from_xr(eyes, there, sizes);
      EXPECT_EQ(pair.parallel, cant == 0.0);
      renderer.draw(pair.views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f));
      for (std::size_t k = 0; k < 2; ++k) {
        const double side = k == 0 ? -1.0 : 1.0, turn = glm::radians(side * cant);
        const glm::dvec3 v(at.x - side * 0.0315, at.y, at.z);
        const glm::dvec3 turned(std::cos(turn) * v.x - std::sin(turn) * v.z, v.y,
                                std::sin(turn) * v.x + std::cos(turn) * v.z);
        EXPECT_LT(glm::length(centre_of_pixels(read(k)) - expected_centre(eyes[k].fov, turned)), 0.1)
            << cant << " " << k;
        EXPECT_GT(glm::length(centre_of_pixels(read(k)) - expected_centre(eyes[1 - k].fov, turned)), 1.0)
            << "the other eye's angles go unnoticed";
        EXPECT_GT(glm::length(centre_of_pixels(read(k)) -
                              expected_centre(eyes[k].fov, turned * glm::dvec3(1, -1, 1))),
                  1.0)
            << "a picture on its head goes unnoticed";
      }
    }
  }
}

TEST_F(Embed, EachEyeIsTheSameAlone) {
  const Model model = test::random_model(3, 400, 2);
  for (const double cant : {0.0, 10.0}) {
    EmbeddedRenderer renderer(caller.get_proc_address(), model);
    const EyePair pair = eyes_from_xr(quest_eyes(cant), stage, sizes);
    const EmbeddedReport report = renderer.draw(pair.views, targets);
    EXPECT_EQ(report.order_groups, cant == 0.0 ? 1u : 2u);
    const std::array<std::vector<float>, 2> both = {read(0), read(1)};
    for (std::size_t k = 0; k < 2; ++k) {
      renderer.draw(std::span(&pair.views[k], 1), std::span(&targets[k], 1));
      EXPECT_EQ(std::memcmp(both[k].data(), read(k).data(), both[k].size() * sizeof(float)), 0) << cant << k;
    }
    EXPECT_NE(both[0], both[1]) << "one eye twice goes unnoticed";
  }
}

TEST_F(Embed, ModelsKnowWhichWayIsUp) {
  // One ball to the upper right, in the frame of trained models and in that of OpenGL.
  Model down = ball({0.3, 0.2, 1.5}), up = down;
  up.axes = "RUB";
  up.position[0] = {0.3f, 0.2f, -1.5f};
  std::vector<std::vector<float>> seen;
  for (const Model* model : {&down, &up}) {
    EmbeddedRenderer renderer(caller.get_proc_address(), *model);
    renderer.draw(eyes_from_xr(quest_eyes(), stage_of(*model, {0, 1.6, 0}), sizes).views, targets,
                  LAYOUT_SEPARATE, glm::vec3(0.0f));
    seen.push_back(read(0));
  }
  EXPECT_LT(glm::length(centre_of_pixels(seen[0]) - centre_of_pixels(seen[1])), 1e-3);
  EmbeddedRenderer renderer(caller.get_proc_address(), up);
  renderer.draw(eyes_from_xr(quest_eyes(), stage, sizes).views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f));
  EXPECT_NE(read(0), seen[0]) << "the model's axes go unnoticed";
}

TEST_F(Embed, RoundedPosesAreStillParallel) {
  auto eyes = quest_eyes();
  eyes[1].position.z += 1e-7;  // as floats have it
  const EyePair pair = eyes_from_xr(eyes, stage, sizes);
  EXPECT_TRUE(pair.parallel);
  eyes[1].position.z += 1e-3;
  EXPECT_FALSE(eyes_from_xr(eyes, stage, sizes).parallel);
}

TEST_F(Embed, LayoutsGoIntoOneTarget) {
  const Model model = test::random_model(3, 400, 2);
  EmbeddedRenderer renderer(caller.get_proc_address(), model);
  const EyePair pair = eyes_from_xr(quest_eyes(), stage, sizes);
  renderer.draw(pair.views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f));
  const std::uint32_t wide = caller.texture(GL_RGBA32F, 2 * size.x, size.y);
  renderer.draw(pair.views, std::array{Target{.texture = wide}}, LAYOUT_PARALLEL, glm::vec3(0.0f));
  const auto pixels = caller.read<float>(wide, 2 * size.x, size.y);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto alone = read(eye);
    for (int y = 0; y < size.y; ++y) {
      const std::size_t row = 4 * static_cast<std::size_t>(y) * size.x;
      ASSERT_EQ(std::memcmp(&pixels[2 * row + 4 * eye * size.x], &alone[row], 4 * sizeof(float) * size.x), 0);
    }
  }
  EXPECT_TRUE(
      test::fails_saying([&] { renderer.draw(pair.views, targets, LAYOUT_PARALLEL); }, {"2 targets"}));
  EXPECT_TRUE(
      test::fails_saying([&] { renderer.draw(pair.views, std::span(targets).first(1)); }, {"1 targets"}));
}

TEST_F(Embed, BadEyesAreRefused) {
  auto eyes = quest_eyes();
  eyes[0].orientation = glm::dvec4(0.0);
  EXPECT_TRUE(test::fails_saying([&] { eyes_from_xr(eyes, stage, sizes); }, {"quaternion"}));
  eyes = quest_eyes();
  std::swap(eyes[1].fov.left, eyes[1].fov.right);
  EXPECT_TRUE(test::fails_saying([&] { eyes_from_xr(eyes, stage, sizes); }, {"field of view of right"}));
  EXPECT_TRUE(test::fails_saying(
      [&] {
        eyes_from_xr(quest_eyes(), stage, {glm::ivec2(0, 4), size});
      },
      {"0 x 4"}));
}

TEST_F(Embed, TheCallersErrorsAreTheCallers) {
  const Model model = ball({0, 0, 1});
  EmbeddedRenderer renderer(caller.get_proc_address(), model);
  const EyePair pair = eyes_from_xr(quest_eyes(), stage, sizes);
  caller.gl.Enable(0xDEAD);
  const EmbeddedReport report = renderer.draw(pair.views, targets);
  EXPECT_EQ(report.callers_errors, std::vector<GLenum>{GL_INVALID_ENUM});
  EXPECT_GT(report.pairs, 0u) << "the frame was not drawn";
  EXPECT_TRUE(renderer.draw(pair.views, targets).callers_errors.empty());
  EXPECT_EQ(caller.gl.GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

/// A driver whose GPU is reset when the test says so.
struct LostGpu {
  static inline gl::GetProcAddress driver = nullptr;
  static inline GLenum status = GL_NO_ERROR;
  static GLenum reset_status() { return status; }
  static void (*get_proc_address(const char* name))() {
    if (std::strcmp(name, "glGetGraphicsResetStatus") == 0) return reinterpret_cast<void (*)()>(reset_status);
    return driver(name);
  }
};

TEST_F(Embed, ALostGpuIsSaid) {
  const Model model = ball({0, 0, 1});
  LostGpu::driver = caller.get_proc_address();
  EmbeddedRenderer renderer(LostGpu::get_proc_address, model);
  const EyePair pair = eyes_from_xr(quest_eyes(), stage, sizes);
  EXPECT_NO_THROW(renderer.draw(pair.views, targets));
  LostGpu::status = GL_INNOCENT_CONTEXT_RESET;
  try {
    renderer.draw(pair.views, targets);
    ADD_FAILURE() << "a frame of a lost GPU was handed out";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_gl);
    EXPECT_NE(std::string(error.what()).find("was reset, the driver says by another program"),
              std::string::npos)
        << error.what();
  }
}

// Both eyes and an inset in each, as headsets with four views have them.
TEST_F(Embed, FourViewsOfParallelEyesShareOneOrder) {
  const Model model = test::random_model(3, 200, 0);
  render::Frame frame(*caller.context, model);
  auto eyes = quest_eyes();
  XrEye left = eyes[0], right = eyes[1];
  left.fov = right.fov = {-0.2, 0.2, 0.2, -0.2};
  const std::array four = {eyes[0], left, eyes[1], right};
  const std::array<glm::ivec2, 4> of_four = {size, size, size, size};
  const HeadViews head = views_from_xr(four, stage, of_four);
  EXPECT_TRUE(head.parallel);
  EXPECT_EQ(frame.draw(head.views).order_groups, 1u);
  const EyePair pair = eyes_from_xr(eyes, stage, sizes);
  EXPECT_EQ(std::memcmp(&head.views[0], &pair.views[0], sizeof(shared::View)), 0);
  EXPECT_EQ(std::memcmp(&head.views[2], &pair.views[1], sizeof(shared::View)), 0);
  const auto canted = quest_eyes(8.0);
  const std::array turned = {canted[0], canted[0], canted[1], canted[1]};
  const HeadViews apart = views_from_xr(turned, stage, of_four);
  EXPECT_FALSE(apart.parallel);
  EXPECT_EQ(frame.draw(apart.views).order_groups, 2u) << "an eye's views share theirs";
  EXPECT_EQ(frame.draw(apart.views, {.order = ORDER_DISTANCE}).order_groups, 1u);
}

}  // namespace
}  // namespace binosplat::stereo
