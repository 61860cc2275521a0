// Errors of use are reported before anything is drawn, with a text that names the argument.

#include <functional>
#include <limits>
#include <optional>
#include <string_view>

#include "library/renderer_fixture.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity(),
                 no_number = std::numeric_limits<double>::quiet_NaN();

struct Misuse : Library {
  const SplatModel model = in_memory(test::random_model(3, 200, 0));
  Renderer renderer{caller.get_proc_address(), model};

  /// Returns whether a frame is refused after `spoil` has changed its second view. The error must leave no
  /// OpenGL error and no submitted frame, and the next frame must be drawn.
  testing::AssertionResult refused(const std::function<void(View&)>& spoil,
                                   std::initializer_list<std::string> parts) {
    std::vector<View> pair = views();
    spoil(pair[1]);
    return refused(pair, placement, over_black, parts);
  }
  testing::AssertionResult refused(const std::vector<View>& bad, const Placement& where,
                                   const Settings& settings, std::initializer_list<std::string> parts) {
    const auto said = test::fails_saying([&] { renderer.submit(bad, where, settings); }, parts);
    if (!said) return said;
    if (std::string_view(said.message()).find("--") != std::string_view::npos)
      return testing::AssertionFailure() << "names an option of the program: " << said.message();
    if (caller.gl.GetError() != GL_NO_ERROR)
      return testing::AssertionFailure() << "an error of OpenGL's is left";
    const Report report = renderer.draw(views(), placement, over_black);
    if (report.pairs == 0 || !report.callers_errors.empty())
      return testing::AssertionFailure() << "the next frame is not drawn as ever";
    return said;
  }
  testing::AssertionResult target_refused(const Target& target, std::initializer_list<std::string> parts) {
    return refused([&](View& view) { view.target = target; }, parts);
  }
  /// Returns whether views are refused if the second one has this depth target.
  testing::AssertionResult depth_refused(const DepthTarget& depth, std::initializer_list<std::string> parts) {
    std::vector<View> pair = views();
    pair[0].depth = {.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y)};
    pair[1].depth = depth;
    return refused(pair, placement, over_black, parts);
  }

  std::uint32_t made(GLenum kind, const std::function<void(std::uint32_t)>& fill) const {
    std::uint32_t id = 0;
    caller.gl.CreateTextures(kind, 1, &id);
    fill(id);
    return id;
  }
  std::uint32_t framebuffer(const std::vector<std::uint32_t>& colours) const {
    std::uint32_t id = 0;
    caller.gl.CreateFramebuffers(1, &id);
    for (GLenum k = 0; k < colours.size(); ++k)
      caller.gl.NamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0 + k, colours[k], 0);
    return id;
  }
};

TEST_F(Misuse, InvalidTextures) {
  std::uint32_t deleted = caller.texture(GL_RGBA8, size.x, size.y);
  caller.gl.DeleteTextures(1, &deleted);
  EXPECT_TRUE(target_refused({.texture = deleted}, {"views[1].target", "there is no texture"}));
  std::uint32_t unbound = 0;
  caller.gl.GenTextures(1, &unbound);
  EXPECT_TRUE(target_refused({.texture = unbound}, {"views[1].target", "there is no texture"}));
  const std::uint32_t empty = made(GL_TEXTURE_2D, [](std::uint32_t) {});
  EXPECT_TRUE(target_refused({.texture = empty}, {"has no level 0"}));
  const std::uint32_t solid = made(
      GL_TEXTURE_3D, [&](std::uint32_t id) { caller.TextureStorage3D(id, 1, GL_RGBA8, size.x, size.y, 4); });
  EXPECT_TRUE(target_refused({.texture = solid, .layer = 1}, {"of kind 0x806f", "GL_TEXTURE_2D_ARRAY"}));
  const std::uint32_t samples = made(GL_TEXTURE_2D_MULTISAMPLE, [&](std::uint32_t id) {
    function<void(GLuint, GLsizei, GLenum, GLsizei, GLsizei, GLboolean)>("glTextureStorage2DMultisample")(
        id, 4, GL_RGBA8, size.x, size.y, GL_TRUE);
  });
  EXPECT_TRUE(target_refused({.texture = samples}, {"of kind 0x9100", "without samples"}));
  EXPECT_TRUE(target_refused({.framebuffer = framebuffer({samples})}, {"samples a pixel"}));

  const std::uint32_t good = caller.texture(GL_RGBA8, size.x, size.y),
                      array = caller.texture(GL_RGBA8, size.x, size.y, 2);
  EXPECT_TRUE(target_refused({.texture = good, .level = 1}, {"has no level 1"}));
  EXPECT_TRUE(target_refused({.texture = good, .layer = 0}, {"has no layer 0", "not an array"}));
  EXPECT_TRUE(target_refused({.texture = array, .layer = 2}, {"has no layer 2", "an array of 2"}));
  EXPECT_TRUE(target_refused({.texture = array}, {"has no layer -1"}));
  EXPECT_TRUE(target_refused({.texture = good, .x = 1}, {"views[1].target", "72 x 64 px at 1, 0"}));
  EXPECT_TRUE(target_refused({.texture = good, .y = -1}, {"does not lie within"}));
  EXPECT_TRUE(
      target_refused({.texture = good, .x = std::numeric_limits<int>::max()}, {"does not lie within"}));
  EXPECT_TRUE(
      target_refused({.texture = caller.texture(GL_RGBA8, size.x / 2, size.y)}, {"within 36 x 64 px"}));
  for (const GLenum format :
       {GL_RGBA8UI, GL_R32I, GL_RGB9_E5, GL_COMPRESSED_RGBA_BPTC_UNORM, GL_DEPTH_COMPONENT24}) {
    const std::uint32_t texture = caller.texture(format, size.x, size.y);
    EXPECT_TRUE(target_refused({.texture = texture}, {"views[1].target", "colour-renderable"})) << format;
  }
  // The same among many views, the first of which needs a copy.
  std::vector<View> many(6, views()[0]);
  many[0].target.texture = caller.texture(GL_RGB8, size.x, size.y);
  many[4].target.texture = deleted;
  EXPECT_TRUE(refused(many, placement, over_black, {"views[4].target"}));
}

TEST_F(Misuse, InvalidFramebuffers) {
  EXPECT_TRUE(target_refused({.framebuffer = 4711}, {"views[1].target", "no framebuffer 4711"}));
  EXPECT_TRUE(target_refused({.texture = textures[1], .framebuffer = 3}, {"expected one of them"}));
  EXPECT_TRUE(target_refused({.framebuffer = framebuffer({})}, {"is not complete"}));
  EXPECT_TRUE(target_refused({}, {"views[1].target", "no default framebuffer"}));
  const std::uint32_t good = caller.texture(GL_RGBA8, size.x, size.y);
  EXPECT_TRUE(target_refused({.framebuffer = framebuffer({good}), .x = 1}, {"does not lie within"}));
  const std::uint32_t small = caller.texture(GL_RGBA8, size.x, size.y / 2);
  EXPECT_TRUE(target_refused({.framebuffer = framebuffer({good, small})}, {"within 72 x 32 px"}));
  const std::uint32_t integers = caller.texture(GL_RGBA8UI, size.x, size.y);
  EXPECT_TRUE(target_refused({.framebuffer = framebuffer({integers})}, {"has an integer format"}));
  std::uint32_t deleted = caller.texture(GL_RGBA8, size.x, size.y);
  const std::uint32_t of_deleted = framebuffer({deleted});
  caller.gl.DeleteTextures(1, &deleted);
  EXPECT_TRUE(target_refused({.framebuffer = of_deleted}, {"views[1].target"}));
  const std::uint32_t of_depths = framebuffer({});
  caller.gl.NamedFramebufferTexture(of_depths, GL_DEPTH_ATTACHMENT,
                                    caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y), 0);
  EXPECT_TRUE(target_refused({.framebuffer = of_depths}, {"has no colours"}));
  std::uint32_t buffer = 0;
  function<void(GLsizei, GLuint*)>("glCreateRenderbuffers")(1, &buffer);
  function<void(GLuint, GLenum, GLsizei, GLsizei)>("glNamedRenderbufferStorage")(buffer, GL_RGBA8, size.x,
                                                                                 size.y);
  const std::uint32_t of_buffer = framebuffer({});
  function<void(GLuint, GLenum, GLenum, GLuint)>("glNamedFramebufferRenderbuffer")(
      of_buffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffer);
  EXPECT_TRUE(target_refused({.framebuffer = of_buffer, .y = 1}, {"within 72 x 64 px"}));
  std::vector<View> pair = views();
  pair[1].target = {.framebuffer = of_buffer};
  EXPECT_GT(renderer.draw(pair, placement, over_black).pairs, 0u) << "a good one is refused, too";
}

TEST_F(Misuse, InvalidEyePairs) {
  std::vector<View> pair = views();
  Settings wide = over_black;
  wide.layout = Layout::parallel;
  EXPECT_TRUE(refused(pair, placement, wide, {"views[0].target", "144 x 64 px", "within 72 x 64 px"}));
  pair[1].size.x -= 1;
  EXPECT_TRUE(refused(pair, placement, wide, {"views[1].size: 71 x 64", "parallel"}));
  pair = views();
  EXPECT_TRUE(refused(pair, placement, {.layout = Layout::anaglyph}, {"settings.background"}));
  EXPECT_TRUE(refused(pair, placement, {.background = glm::vec3(2.0f)}, {"settings.background", "0 to 1"}));
  for (View& view : pair) view.size = size - 1;
  for (const Layout layout : {Layout::half_width, Layout::half_height}) {
    wide.layout = layout;
    EXPECT_TRUE(refused(pair, placement, wide, {"`layout` half-", "choose an even"}));
  }
  pair = views();
  EXPECT_TRUE(refused(pair, placement, {.quality = 40.0f, .foveation = Foveation{}},
                      {"settings.quality with settings.foveation", "settings.tolerance"}));
  Settings gazes = over_black;
  gazes.foveation = Foveation{.gaze = std::vector<glm::dvec2>(3)};
  EXPECT_TRUE(refused(pair, placement, gazes, {"settings.foveation.gaze", "3 for 2"}));
}

TEST_F(Misuse, InvalidDepthTextures) {
  const std::uint32_t good = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
  for (const GLenum format :
       {GL_DEPTH24_STENCIL8, GL_DEPTH32F_STENCIL8, GL_R32F, GL_RGBA8, GL_STENCIL_INDEX8}) {
    EXPECT_TRUE(depth_refused({.texture = caller.texture(format, size.x, size.y)},
                              {"views[1].depth", "without stencil"}))
        << format;
  }
  std::uint32_t used_again = caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y),
                deleted = caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y);
  caller.gl.DeleteTextures(1, &deleted);
  caller.gl.DeleteTextures(1, &used_again);  // the next texture gets its name
  EXPECT_TRUE(depth_refused({.texture = deleted}, {"views[1].depth", "there is no texture"}));
  EXPECT_TRUE(depth_refused({}, {"views[1].depth", "there is no texture 0"}));
  EXPECT_TRUE(depth_refused({.texture = good, .level = 1}, {"has no level 1"}));
  EXPECT_TRUE(depth_refused({.texture = good, .layer = 1}, {"has no layer 1"}));
  for (const auto& [near, far] : {std::pair(0.0, 1.0), std::pair(-1.0, 1.0), std::pair(no_number, 1.0),
                                  std::pair(1.0, 1.0), std::pair(infinite, infinite), std::pair(1.0, 0.0)}) {
    const std::string text = fmt::format("planes at {} and {}", near, far);
    EXPECT_TRUE(
        depth_refused({.texture = good, .near_plane = near, .far_plane = far}, {"views[1].depth", text}));
  }
  // The same for depths of meshes.
  std::vector<View> pair = views();
  for (View& view : pair) {
    view.depth = {.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y)};
    view.mesh_depth = {.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y),
                       .near_plane = 0.1,
                       .far_plane = 100.0};
  }
  EXPECT_GT(renderer.draw(pair, placement).pairs, 0u);
  pair[0].depth->texture = pair[1].mesh_depth->texture;
  EXPECT_TRUE(refused(pair, placement, {}, {"views[0].depth", "is a mesh_depth, too"}));
  pair = views();
  for (View& view : pair) view.mesh_depth = {.texture = good, .coding = static_cast<DepthCoding>(77)};
  EXPECT_TRUE(refused(pair, placement, {}, {"views[0].mesh_depth", "coding 77"}));
}

TEST_F(Misuse, NonFiniteNumbers) {
  for (const double bad : {no_number, infinite, -infinite}) {
    EXPECT_TRUE(refused([&](View& v) { v.eye.position.y = bad; }, {"views[1].eye.position"}));
    EXPECT_TRUE(
        refused([&](View& v) { v.eye.orientation.z = bad; }, {"views[1].eye.orientation", "quaternion"}));
    EXPECT_TRUE(refused([&](View& v) { v.eye.fov.up = bad; }, {"views[1].eye.fov", "radians"}));
    const auto badly_placed = [&](Placement where, const char* part) {
      return refused(views(), where, over_black, {part});
    };
    EXPECT_TRUE(badly_placed({.origin = {0.0, 0.0, bad}}, "placement.origin"));
    EXPECT_TRUE(badly_placed({.axes = glm::dmat3(bad)}, "placement.axes"));
    EXPECT_TRUE(badly_placed({.units_per_metre = bad}, "placement.units_per_metre"));
    Settings settings = over_black;
    settings.near_plane = bad;
    EXPECT_TRUE(refused(views(), placement, settings, {"settings.near_plane"}));
    settings = {.background = glm::vec3(0.0f, static_cast<float>(bad), 0.0f)};
    EXPECT_TRUE(refused(views(), placement, settings, {"settings.background"}));
    const auto share = static_cast<float>(bad);
    EXPECT_TRUE(refused([&](View& v) { v.region.tolerance_share = share; }, {"tolerance"}));
    EXPECT_TRUE(refused([&](View& v) { v.region.low_pass_share = share; }, {"low_pass_share"}));
  }
  EXPECT_TRUE(refused([](View& v) { v.eye.position.x = 1e200; }, {"views[1].eye.position"}));
  EXPECT_TRUE(refused([](View& v) { v.eye.orientation = glm::dvec4(0.0); }, {"views[1].eye.orientation"}));
  for (const double units : {0.0, -1.0})
    EXPECT_TRUE(refused(views(), {.units_per_metre = units}, over_black, {"placement.units_per_metre"}));
  EXPECT_TRUE(refused(views(), {.axes = glm::dmat3(2.0)}, over_black, {"placement.axes", "length 1"}));
  EXPECT_TRUE(
      refused([](View& v) { v.region.columns.resize(3); }, {"views[1].region", "columns for 3 rows"}));
  EXPECT_TRUE(refused([](View& v) { v.region.hole_end = {1000, 8}; }, {"views[1].region", "a hole"}));
  for (const glm::ivec2 none :
       {glm::ivec2(0), glm::ivec2(72, -1), glm::ivec2(std::numeric_limits<int>::max(), 1)}) {
    const std::string text = fmt::format("views[1].size: {} x {} px", none.x, none.y);
    EXPECT_TRUE(refused([&](View& v) { v.size = none; }, {text}));
  }
  EXPECT_TRUE(refused([](View& v) { std::swap(v.eye.fov.left, v.eye.fov.right); }, {"views[1].eye.fov"}));
  EXPECT_TRUE(refused(std::vector<View>(9, views()[0]), placement, over_black, {"1 to 8 views"}));
  EXPECT_TRUE(refused(std::vector<View>(), placement, over_black, {"1 to 8 views"}));
}

// tests/library/settings_test.cpp has the complete list of contradictions.
TEST_F(Misuse, ContradictorySettings) {
  EXPECT_TRUE(refused(views(), placement, {.quality = 40.0f, .tolerance = 0.0f},
                      {"settings.tolerance", "settings.quality"}));
  // A quality alone is enough: the rule follows from it.
  EXPECT_GE(renderer.draw(views(), placement, {.quality = 40.0f}).quality, 39.0);
}

TEST_F(Misuse, DestroyedAndMovedObjects) {
  std::optional<SplatModel> short_lived(in_memory(test::random_model(3, 200, 0)));
  Renderer outliving(caller.get_proc_address(), *short_lived);
  renderer.draw(views(), placement, over_black);
  const auto expected = read(0);
  short_lived.reset();
  outliving.draw(views(), placement, over_black);
  EXPECT_EQ(read(0), expected);

  Renderer to(std::move(outliving));
  // NOLINTBEGIN(bugprone-use-after-move)
  for (const auto& use : std::vector<std::function<void()>>{
           [&] { outliving.submit(views(), placement); }, [&] { outliving.finish(); },
           [&] { outliving.is_done(); }, [&] { outliving.draw(views(), placement); }})
    EXPECT_TRUE(test::fails_saying(use, {"Renderer was moved from"}));
  EXPECT_GT(to.draw(views(), placement, over_black).pairs, 0u);
  outliving = std::move(to);
  EXPECT_GT(outliving.draw(views(), placement, over_black).pairs, 0u);

  SplatModel from = model;
  const SplatModel there = std::move(from);
  EXPECT_ERROR(Renderer(caller.get_proc_address(), from), "model", "moved from");
  EXPECT_ERROR(from.count(), "moved from");
  // NOLINTEND(bugprone-use-after-move)
}

}  // namespace
}  // namespace binosplat
