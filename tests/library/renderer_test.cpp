// binosplat in another program: views as in OpenXR, the program's state, and the origin of OpenGL errors.

#include <cmath>
#include <cstring>

#include "library/renderer_fixture.h"
#include "scene/axes.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

/// Returns a bright ball at (right, up, forward) of the head, in metres.
Model ball(const glm::dvec3& at, double units = 1.0) {
  Model model;
  test::add(model, glm::vec3(glm::dvec3(at.x, -at.y, at.z) * units),
            glm::vec3(0.01f * static_cast<float>(units)), 0.99f);
  return model;
}

/// Returns the centre of brightness, in pixels from OpenGL's lower left.
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

/// Returns the pixel at which the angles project a direction (right, up, forward) of an eye.
glm::dvec2 expected_centre(const Fov& fov, const glm::dvec3& v) {
  const auto along = [](double low, double high, double tangent, int pixels) {
    return (tangent - std::tan(low)) / (std::tan(high) - std::tan(low)) * pixels - 0.5;
  };
  return {along(fov.left, fov.right, v.x / v.z, size.x), along(fov.down, fov.up, v.y / v.z, size.y)};
}

TEST_F(Library, AnglesAndPosesFollowOpenXr) {
  for (const double cant : {0.0, 10.0}) {
    for (const double units : {1.0, 4.0}) {
      const glm::dvec3 at(0.3, 0.2, 1.5);
      const Model model = ball(at, units);
      Renderer renderer(caller.get_proc_address(), in_memory(model));
      const auto eyes = quest_eyes(cant);
      Placement there = placement;
      there.origin *= units;
      there.units_per_metre = units;
      EXPECT_EQ(renderer.draw(views(eyes), there, over_black).order_groups, cant == 0.0 ? 1u : 2u);
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

TEST_F(Library, EyesAreIndependent) {
  const SplatModel model = in_memory(test::random_model(3, 400, 2));
  for (const double cant : {0.0, 10.0}) {
    Renderer renderer(caller.get_proc_address(), model);
    const std::vector<View> pair = views(quest_eyes(cant));
    renderer.draw(pair, placement);
    const std::array<std::vector<float>, 2> both = {read(0), read(1)};
    const Target elsewhere = {.texture = caller.texture(GL_RGBA32F, size.x, size.y)};
    const std::array four = {pair[0], View{pair[0].eye, size / 2, elsewhere},
                             View{pair[1].eye, size / 2, elsewhere}, pair[1]};
    renderer.draw(four, placement);
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_EQ(std::memcmp(both[k].data(), read(k).data(), both[k].size() * sizeof(float)), 0) << cant << k;
    EXPECT_NE(both[0], both[1]) << "one eye twice goes unnoticed";
  }
}

// One ball at the upper right: in the axes of trained models, in OpenGL's, and relative to a distant origin.
TEST_F(Library, AppliesModelAxesAndOrigin) {
  const Model plain = ball({0.3, 0.2, 1.5});
  Model up = plain, far = plain;
  up.axes.letters = "RUB";
  up.position[0] = {0.3f, 0.2f, -1.5f};
  far.axes.origin = {455000.25, 5411000.5, 312.125};
  const auto seen = [&](const Model& model, const Placement& where) {
    Renderer renderer(caller.get_proc_address(), in_memory(model));
    renderer.draw(views(), where, over_black);
    return read(0);
  };
  Placement beside = placement;
  beside.origin += far.axes.origin;
  const auto expected = seen(plain, placement);
  for (const auto& [model, where] : {std::pair(plain, in_memory(plain).placement({0, 1.6, 0})),
                                     {up, in_memory(up).placement({0, 1.6, 0})},
                                     {far, beside}}) {
    EXPECT_LT(glm::length(centre_of_pixels(seen(model, where)) - centre_of_pixels(expected)), 1e-3)
        << model.axes.letters;
  }
  EXPECT_EQ(in_memory(far).bounds().low - far.axes.origin, in_memory(plain).bounds().low);
  EXPECT_NE(seen(up, placement), expected) << "the model's axes go unnoticed";
  EXPECT_NE(seen(far, placement), expected) << "the origin goes unnoticed";
}

TEST_F(Library, RoundedPosesStayParallel) {
  Renderer renderer(caller.get_proc_address(), in_memory(ball({0, 0, 1})));
  auto eyes = quest_eyes();
  eyes[1].position.z += 1e-7;  // rounding of floats
  EXPECT_EQ(renderer.draw(views(eyes), placement).order_groups, 1u);
  eyes[1].position.z += 1e-3;
  EXPECT_EQ(renderer.draw(views(eyes), placement).order_groups, 2u);
}

TEST_F(Library, LayoutsShareOneTarget) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 400, 2)));
  std::vector<View> pair = views();
  renderer.draw(pair, placement, over_black);
  const std::uint32_t wide = caller.texture(GL_RGBA32F, 2 * size.x, size.y);
  pair[0].target.texture = wide;
  Settings side_by_side = over_black;
  side_by_side.layout = Layout::parallel;
  renderer.draw(pair, placement, side_by_side);
  const auto pixels = caller.read<float>(wide, 2 * size.x, size.y);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto alone = read(eye);
    for (int y = 0; y < size.y; ++y) {
      const std::size_t row = 4 * static_cast<std::size_t>(y) * size.x;
      ASSERT_EQ(std::memcmp(&pixels[2 * row + 4 * eye * size.x], &alone[row], 4 * sizeof(float) * size.x), 0);
    }
  }
  pair.pop_back();
  EXPECT_ERROR(renderer.draw(pair, placement, side_by_side), "1 views", "parallel");
}

TEST_F(Library, KeepsCallersErrors) {
  Renderer renderer(caller.get_proc_address(), in_memory(ball({0, 0, 1})));
  caller.gl.Enable(0xDEAD);
  const Report report = renderer.draw(views(), placement);
  EXPECT_EQ(report.callers_errors, std::vector<std::uint32_t>{GL_INVALID_ENUM});
  EXPECT_GT(report.pairs, 0u) << "the frame was not drawn";
  EXPECT_TRUE(renderer.draw(views(), placement).callers_errors.empty());
  EXPECT_EQ(caller.gl.GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

/// A driver that reports a reset of its GPU when the test sets `status`.
struct LostGpu {
  static inline gl::GetProcAddress driver = nullptr;
  static inline GLenum status = GL_NO_ERROR;
  static GLenum reset_status() { return status; }
  static void (*get_proc_address(const char* name))() {
    if (std::strcmp(name, "glGetGraphicsResetStatus") == 0) return reinterpret_cast<void (*)()>(reset_status);
    return driver(name);
  }
};

TEST_F(Library, ReportsLostGpu) {
  LostGpu::driver = caller.get_proc_address();
  Renderer renderer(LostGpu::get_proc_address, in_memory(ball({0, 0, 1})));
  EXPECT_NO_THROW(renderer.draw(views(), placement));
  LostGpu::status = GL_INNOCENT_CONTEXT_RESET;
  EXPECT_TRUE(test::fails_saying([&] { renderer.draw(views(), placement); }, {"was reset by another program"},
                                 ExitCode::no_gl));
}

// Both eyes with an inset each, as on headsets with four views.
TEST_F(Library, FourParallelViewsShareOrder) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 200, 0)));
  const auto with_insets = [&](const std::array<Eye, 2>& eyes) {
    const std::vector<View> pair = views(eyes);
    std::vector<View> four = {pair[0], pair[0], pair[1], pair[1]};
    four[1].eye.fov = four[3].eye.fov = {-0.2, 0.2, 0.2, -0.2};
    return four;
  };
  EXPECT_EQ(renderer.draw(with_insets(quest_eyes()), placement).order_groups, 1u);
  const auto canted = with_insets(quest_eyes(8.0));
  EXPECT_EQ(renderer.draw(canted, placement).order_groups, 2u) << "an eye's views share theirs";
  EXPECT_EQ(renderer.draw(canted, placement, {.order = Order::distance}).order_groups, 1u);
}

TEST(LibraryModel, FramingShowsWholeModel) {
  Model model;
  test::Uniform uniform(5);
  for (int i = 0; i < 2000; ++i)
    test::add(model, {uniform(3, 4), uniform(-6, -2), uniform(7, 8)}, glm::vec3(0.05f), 0.9f);
  const Fov fov{-0.8, 0.6, 0.7, -0.7};
  const glm::dvec3 eye(-0.03, 1.6, 0.0);
  for (const char* letters : {"RDF", "RUB"}) {
    Model turned = model;
    bring_into_axes(turned, letters);
    const Placement placement = in_memory(turned).framing(fov, eye, 2.0);
    EXPECT_EQ(placement.units_per_metre, 2.0);
    double widest = 0.0;
    for (const glm::vec3& p : turned.position) {
      const glm::dvec3 v =
          glm::transpose(placement.axes) * (glm::dvec3(p) - placement.origin) / placement.units_per_metre -
          eye;
      ASSERT_LT(v.z, 0.0);
      EXPECT_LT(std::abs(std::atan(v.x / v.z)), 0.6) << letters;
      EXPECT_LT(std::abs(std::atan(v.y / v.z)), 0.7) << letters;
      widest = std::max(widest, std::abs(std::atan(v.y / v.z)));
    }
    EXPECT_GT(widest, 0.45) << "it is near";
    EXPECT_GT(std::abs(placement.axes[1].y), 0.999) << "upright";
  }
}

TEST(LibraryModel, CoreBoundsExcludeSky) {
  Model model = test::random_model(3, 500, 0);
  for (int i = 0; i < 40; ++i) test::add(model, {0, -300, 0}, glm::vec3(1.0f), 0.9f);
  EXPECT_GT(in_memory(model).bounds().low.y, -10.0);
  EXPECT_EQ(in_memory(model).all_bounds().low.y, -300.0);
}

// A loaded model, and what a program can query of it.
TEST(LibraryModel, IsSharedAndDescribesItself) {
  Model model = test::random_model(3, 200, 0);
  model.name = "small";
  auto first = std::make_unique<SplatModel>(in_memory(model));
  const SplatModel copy = *first;
  first.reset();
  EXPECT_EQ(copy.name(), "small");
  EXPECT_EQ(copy.count(), 200u);
  const Bounds bounds = copy.bounds(), expected = core_bounds(model);
  EXPECT_EQ(bounds.low, expected.low);
  EXPECT_EQ(bounds.high, expected.high);
  EXPECT_ERROR(SplatModel("/no/such.ply"), "/no/such.ply");
}

}  // namespace
}  // namespace binosplat
