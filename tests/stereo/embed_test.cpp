// binosplat in another program: views as OpenXR gives them, that program's state, and whose errors are whose.

#include "stereo/embed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/gtc/quaternion.hpp>

#include "gl/state.h"
#include "support/caller.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

constexpr glm::ivec2 size(72, 64);
constexpr std::array<glm::ivec2, 2> sizes = {size, size};

/// Eyes as a Quest gives them: 49 degrees outwards and 37 inwards, each turned outwards by `cant` degrees.
std::array<XrEye, 2> quest_eyes(double cant = 0.0) {
  std::array<XrEye, 2> eyes;
  for (std::size_t k = 0; k < 2; ++k) {
    const double side = k == 0 ? -1.0 : 1.0;
    eyes[k].position = {side * 0.0315, 1.6, 0.0};
    const glm::dquat turn = glm::angleAxis(glm::radians(-side * cant), glm::dvec3(0, 1, 0));
    eyes[k].orientation = {turn.x, turn.y, turn.z, turn.w};
    eyes[k].fov = {glm::radians(k == 0 ? -49.0 : -37.0), glm::radians(k == 0 ? 37.0 : 49.0),
                   glm::radians(45.0), glm::radians(-48.0)};
  }
  return eyes;
}

/// The head of quest_eyes() is at the origin of the model's world, which looks along z with y down.
const Stage stage = {.origin = {0.0, 1.6, 0.0}};

/// One bright ball at (right, up, forward) of the head, in metres.
Model ball(const glm::dvec3& at, double units = 1.0) {
  Model model;
  test::add(model, glm::vec3(glm::dvec3(at.x, -at.y, at.z) * units),
            glm::vec3(0.01f * static_cast<float>(units)), 0.99f);
  return model;
}

/// Centre of what is bright in pixels from OpenGL's lower left.
glm::dvec2 centre(const std::vector<float>& pixels) {
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
glm::dvec2 expected(const Fov& fov, const glm::dvec3& v) {
  const auto along = [](double low, double high, double tangent, int pixels) {
    return (tangent - std::tan(low)) / (std::tan(high) - std::tan(low)) * pixels - 0.5;
  };
  return {along(fov.left, fov.right, v.x / v.z, size.x), along(fov.down, fov.up, v.y / v.z, size.y)};
}

struct Embed : testing::Test {
  test::Caller caller;
  const std::array<std::uint32_t, 2> textures = {caller.texture(GL_RGBA32F, size.x, size.y),
                                                 caller.texture(GL_RGBA32F, size.x, size.y)};
  const std::array<Target, 2> targets = {Target{.texture = textures[0]}, Target{.texture = textures[1]}};

  std::vector<float> read(std::size_t eye) const { return caller.read<float>(textures[eye], size.x, size.y); }
};

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
        EXPECT_LT(glm::length(centre(read(k)) - expected(eyes[k].fov, turned)), 0.1) << cant << " " << k;
        EXPECT_GT(glm::length(centre(read(k)) - expected(eyes[1 - k].fov, turned)), 1.0)
            << "the other eye's angles go unnoticed";
        EXPECT_GT(glm::length(centre(read(k)) - expected(eyes[k].fov, turned * glm::dvec3(1, -1, 1))), 1.0)
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
  EXPECT_LT(glm::length(centre(seen[0]) - centre(seen[1])), 1e-3);
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

/// Depths of a layer, rows from OpenGL's bottom.
std::vector<float> read_depths(const test::Caller& caller, std::uint32_t id, int layer = 0) {
  std::vector<float> depths(static_cast<std::size_t>(size.x * size.y));
  caller.GetTextureSubImage(id, 0, 0, 0, layer, size.x, size.y, 1, GL_DEPTH_COMPONENT, GL_FLOAT,
                            static_cast<GLsizei>(4 * depths.size()), depths.data());
  return depths;
}

TEST_F(Embed, DepthsAreAsOpenGLKeepsThem) {
  const Model model = test::random_model(3, 400, 0);
  EmbeddedRenderer renderer(caller.get_proc_address(), model);
  const auto views = eyes_from_xr(quest_eyes(), stage, sizes).views;
  render::Frame frame(renderer.context(), model);
  frame.draw(views);
  const std::vector<Picture> pictures = frame.read_pictures();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::uint32_t layers = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y, 3);
  const std::array<std::uint32_t, 2> formats = {caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y),
                                                caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y)};
  for (const auto& [near, far] :
       {std::pair(0.2, 50.0), std::pair(0.2, inf), std::pair(inf, 0.2), std::pair(50.0, 0.2)}) {
    const auto depth_of = [near = near, far = far](double z) {
      if (std::isinf(near)) return far / z;
      return (std::isinf(far) ? 1.0 : far / (far - near)) * (1.0 - near / z);
    };
    const auto differing = [&](const std::vector<float>& depths, const Picture& picture,
                               bool flipped = false) {
      int count = 0;
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
          const auto at = static_cast<std::size_t>(y * size.x + x);
          const double cover = 1.0 - picture.colour[at].a;
          const double z = cover > 0.5 ? picture.z_sum[at] / cover : 1e30;
          const int row = flipped ? y : size.y - 1 - y;
          const double is = depths[static_cast<std::size_t>(row * size.x + x)];
          count += std::abs(is - std::clamp(depth_of(z), 0.0, 1.0)) > 1e-6 ? 1 : 0;
        }
      }
      return count;
    };
    renderer.draw(
        views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f), {},
        std::array{DepthTarget{.texture = formats[0], .near_plane = near, .far_plane = far},
                   DepthTarget{.texture = layers, .layer = 2, .near_plane = near, .far_plane = far}});
    EXPECT_EQ(differing(read_depths(caller, formats[0]), pictures[0]), 0) << near << " " << far;
    EXPECT_EQ(differing(read_depths(caller, layers, 2), pictures[1]), 0) << near << " " << far;
    EXPECT_GT(differing(read_depths(caller, formats[0]), pictures[1]), 100) << "the other eye goes unnoticed";
    EXPECT_GT(differing(read_depths(caller, formats[0]), pictures[0], true), 100)
        << "upside down goes unnoticed";
    renderer.draw(std::span(&views[0], 1), std::span(&targets[0], 1), LAYOUT_SEPARATE, glm::vec3(0.0f), {},
                  std::array{DepthTarget{.texture = formats[1], .near_plane = near, .far_plane = far}});
    EXPECT_EQ(differing(read_depths(caller, formats[1]), pictures[0]), 0) << "24 bits";
  }
  const auto refused = [&](const DepthTarget& target) {
    EXPECT_THROW(renderer.draw(std::span(&views[0], 1), std::span(&targets[0], 1), LAYOUT_SEPARATE,
                               glm::vec3(0.0f), {}, std::array{target}),
                 Error);
  };
  refused({.texture = textures[0]});  // of colours
  refused({.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x - 1, size.y)});
  refused({.texture = formats[0], .near_plane = 0.0});
  refused({.texture = formats[0], .near_plane = inf, .far_plane = inf});
  EXPECT_THROW(renderer.draw(views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f), {},
                             std::array{DepthTarget{.texture = formats[0]}}),
               Error)
      << "one for two views";
}

TEST_F(Embed, DepthsLeaveTheCallersUnpackingAlone) {
  const Model model = ball({0.0, 0.0, 1.5});
  EmbeddedRenderer renderer(caller.get_proc_address(), model);
  std::uint32_t buffer = 0;
  caller.gl.CreateBuffers(1, &buffer);
  caller.gl.NamedBufferStorage(buffer, 64, nullptr, 0);
  caller.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
  const std::pair<GLenum, GLint> set[] = {{GL_UNPACK_ROW_LENGTH, 7}, {GL_UNPACK_ALIGNMENT, 2},
                                          {GL_UNPACK_SKIP_ROWS, 1},  {GL_UNPACK_SKIP_PIXELS, 3},
                                          {GL_UNPACK_SWAP_BYTES, 1}, {GL_UNPACK_IMAGE_HEIGHT, 5}};
  for (const auto& [name, value] : set) caller.PixelStorei(name, value);
  const std::uint32_t depth = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
  const auto views = eyes_from_xr(quest_eyes(), stage, sizes).views;
  renderer.draw(std::span(&views[0], 1), std::span(&targets[0], 1), LAYOUT_SEPARATE, glm::vec3(0.0f), {},
                std::array{DepthTarget{.texture = depth}});
  for (const auto& [name, value] : set) {
    GLint now = 0;
    caller.gl.GetIntegerv(name, &now);
    EXPECT_EQ(now, value) << name;
  }
  GLint bound = 0;
  caller.gl.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &bound);
  EXPECT_EQ(bound, static_cast<GLint>(buffer));
  const std::vector<float> depths = read_depths(caller, depth);
  EXPECT_LT(*std::min_element(depths.begin(), depths.end()), 1.0f);
}

// Numbers that mean light.
TEST_F(Embed, LinearTargetsHoldLight) {
  const Model model = test::random_model(3, 400, 0);
  EmbeddedRenderer renderer(caller.get_proc_address(), model);
  const auto views = eyes_from_xr(quest_eyes(), stage, sizes).views;
  const std::array<Target, 2> linear = {targets[0], Target{.texture = textures[1], .linear = true}};
  const std::array same = {views[0], views[0]};
  renderer.draw(same, linear, LAYOUT_SEPARATE, glm::vec3(0.0f));
  const std::vector<float> shown = read(0), light = read(1);
  int differ = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double v = shown[k];
    const double wanted = k % 4 == 3 ? 1.0 : v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(light[k], wanted, 1e-4 * std::max(1.0, wanted));
    differ += std::abs(light[k] - v) > 0.01 ? 1 : 0;
  }
  EXPECT_GT(differ, 1000) << "display values go unnoticed";
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
