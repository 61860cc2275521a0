// A frame restores the caller's OpenGL state, piece by piece.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>

#include "gl/state.h"
#include "library/renderer_fixture.h"
#include "render/frame.h"
#include "stereo/rig.h"
#include "support/models.h"

namespace binosplat {
namespace {

using Values = std::vector<double>;
using Names = std::set<std::string>;

/// A piece of OpenGL state: `set` gives it an unusual value, `get` returns its value.
struct Piece {
  std::string name;
  std::function<void()> set;
  std::function<Values()> get;
};

struct CallerState : testing::Test {
  test::Caller caller;
  const gl::Functions& gl = caller.gl;
  std::vector<Piece> pieces;
  std::size_t changed_count = 0;  // number of leading pieces that drawing changes
  gl::Buffer buffer{*caller.context, "the caller's"};
  std::uint32_t framebuffer = 0, vertices = 0, sampler = 0;
  std::uint32_t texture = caller.texture(GL_RGBA8, 8, 8), array = caller.texture(GL_RGBA16F, 8, 8, 2);

  Values integers(GLenum name, int count = 1) const {
    std::array<GLint, 4> values{};
    gl.GetIntegerv(name, values.data());
    return {values.begin(), values.begin() + count};
  }
  Values viewport(GLuint index) const {
    std::array<float, 4> values{};
    caller.GetFloati_v(GL_VIEWPORT, index, values.data());
    return {values.begin(), values.end()};
  }
  void add(const std::string& name, std::function<void()> set, std::function<Values()> get) {
    pieces.push_back({name, std::move(set), std::move(get)});
  }
  /// Adds a piece that is a number.
  void add(const std::string& name, GLenum number, std::function<void()> set) {
    add(name, std::move(set), [this, number] { return integers(number); });
  }
  void add_buffer(const std::string& name, GLenum target, GLenum number) {
    add(name, number, [this, target] { gl.BindBuffer(target, buffer.id()); });
  }
  /// Adds a piece that is enabled or disabled.
  void add_enabled(const std::string& name, GLenum effect) {
    add(
        name, [this, effect] { gl.Enable(effect); },
        [this, effect] { return Values{double(gl.IsEnabled(effect))}; });
  }
  void add_enabled_at(const std::string& name, GLenum effect, GLuint index) {
    add(
        name, [this, effect, index] { gl.Enablei(effect, index); },
        [this, effect, index] { return Values{double(gl.IsEnabledi(effect, index))}; });
  }

  CallerState() {
    buffer.reserve(4096);
    gl.CreateFramebuffers(1, &framebuffer);
    caller.CreateVertexArrays(1, &vertices);
    caller.CreateSamplers(1, &sampler);
    add_changed();
    changed_count = pieces.size();
    add_effects();
    add_untouched();
  }

  void add_changed() {
    add("program", GL_CURRENT_PROGRAM,
        [this] { gl.UseProgram(caller.context->program("recolour.comp").id()); });
    add_buffer("storage buffer", GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING);
    add_buffer("indirect buffer", GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING);
    for (const GLuint unit : {0u, MAX_CANVASES - 1u}) {
      const auto get = [this, unit] {
        Values values;
        for (const GLenum name : {GL_IMAGE_BINDING_NAME, GL_IMAGE_BINDING_LEVEL, GL_IMAGE_BINDING_LAYERED,
                                  GL_IMAGE_BINDING_LAYER, GL_IMAGE_BINDING_ACCESS, GL_IMAGE_BINDING_FORMAT}) {
          GLint value = 0;
          gl.GetIntegeri_v(name, unit, &value);
          values.push_back(value);
        }
        return values;
      };
      const auto set = [this, unit] {
        gl.BindImageTexture(unit, array, 0, GL_FALSE, 1, GL_READ_ONLY, GL_RGBA16F);
      };
      add("image " + std::to_string(unit), set, get);
    }
    add_enabled_at("scissor test", GL_SCISSOR_TEST, 0);
    add_enabled("sRGB framebuffer", GL_FRAMEBUFFER_SRGB);
    add_enabled("rasterizer discard", GL_RASTERIZER_DISCARD);
    add_buffer("uniform buffer", GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING);
    add(
        "uniform binding",
        [this] {
          gl.BindBufferRange(GL_UNIFORM_BUFFER, 0, buffer.id(), 256, 128);
          gl.BindBuffer(GL_UNIFORM_BUFFER, buffer.id());
        },
        [this] {
          return binding(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, 0);
        });
    for (GLuint i = 0; i < gl::storage_bindings_needed; ++i) {
      // Some buffers are bound as a range, some as a whole. The general binding point must survive both.
      const auto set = [this, i] {
        if (i % 3 == 2) {
          gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffer.id());
        } else {
          gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffer.id(), 256 * (i + 1), 128);
        }
        gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.id());
      };
      const auto get = [this, i] {
        return binding(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
                       GL_SHADER_STORAGE_BUFFER_SIZE, i);
      };
      add("storage binding " + std::to_string(i), set, get);
    }
  }

  Values binding(GLenum name, GLenum start_name, GLenum size_name, GLuint i) const {
    GLint id = 0;
    GLint64 start = 0, size = 0;
    gl.GetIntegeri_v(name, i, &id);
    gl.GetInteger64i_v(start_name, i, &start);
    gl.GetInteger64i_v(size_name, i, &size);
    return {double(id), double(start), double(size)};
  }

  void add_effects() {
    add(
        "viewport", [this] { caller.ViewportIndexedf(0, 1.5f, 2, 33, 44); }, [this] { return viewport(0); });
    add(
        "colour mask", [this] { caller.ColorMaski(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE); },
        [this] {
          std::array<GLboolean, 4> v{};
          caller.GetBooleani_v(GL_COLOR_WRITEMASK, 0, v.data());
          return Values(v.begin(), v.end());
        });
    add_enabled_at("blending", GL_BLEND, 0);
    add_buffer("query buffer", GL_QUERY_BUFFER, GL_QUERY_BUFFER_BINDING);
    add("clip origin", GL_CLIP_ORIGIN, [this] { caller.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE); });
    add("clip depth", GL_CLIP_DEPTH_MODE, [] {});
    add("polygon mode", GL_POLYGON_MODE, [this] { caller.PolygonMode(GL_FRONT_AND_BACK, GL_LINE); });
    for (const auto& [name, effect] :
         std::vector<std::pair<const char*, GLenum>>{{"depth test", GL_DEPTH_TEST},
                                                     {"stencil test", GL_STENCIL_TEST},
                                                     {"culling", GL_CULL_FACE},
                                                     {"logic operation", GL_COLOR_LOGIC_OP},
                                                     {"dithering", GL_DITHER},
                                                     {"alpha to coverage", GL_SAMPLE_ALPHA_TO_COVERAGE},
                                                     {"alpha to one", GL_SAMPLE_ALPHA_TO_ONE},
                                                     {"sample coverage", GL_SAMPLE_COVERAGE},
                                                     {"sample mask", GL_SAMPLE_MASK},
                                                     {"polygon smoothing", GL_POLYGON_SMOOTH},
                                                     {"clip distance 0", GL_CLIP_DISTANCE0},
                                                     {"clip distance 7", GL_CLIP_DISTANCE7}}) {
      add_enabled(name, effect);
    }
  }

  /// Adds the state of a texture unit that a frame with mesh depths uses.
  void add_unit(GLuint unit) {
    const auto of_unit = [this, unit](GLenum name) {
      const GLint active = static_cast<GLint>(integers(GL_ACTIVE_TEXTURE)[0]);
      caller.ActiveTexture(GL_TEXTURE0 + unit);
      Values values = integers(name);
      caller.ActiveTexture(static_cast<GLenum>(active));
      return values;
    };
    const auto bind = [this, unit](GLenum target, GLuint id) {
      caller.ActiveTexture(GL_TEXTURE0 + unit);
      caller.BindTexture(target, id);
    };
    const std::string of = " of unit " + std::to_string(unit);
    add(
        "texture" + of, [this, bind] { bind(GL_TEXTURE_2D, texture); },
        [of_unit] { return of_unit(GL_TEXTURE_BINDING_2D); });
    add(
        "sampler" + of, [this, unit] { caller.BindSampler(unit, sampler); },
        [of_unit] { return of_unit(GL_SAMPLER_BINDING); });
  }

  void add_untouched() {
    add_unit(0);
    add_unit(MAX_CANVASES);
    add("vertex array", GL_VERTEX_ARRAY_BINDING, [this] { caller.BindVertexArray(vertices); });
    add("draw framebuffer", GL_DRAW_FRAMEBUFFER_BINDING,
        [this] { gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer); });
    add("texture unit", GL_ACTIVE_TEXTURE, [this] { caller.ActiveTexture(GL_TEXTURE5); });
    add("texture", GL_TEXTURE_BINDING_2D, [this] { caller.BindTexture(GL_TEXTURE_2D, texture); });
    add("sampler", GL_SAMPLER_BINDING, [this] { caller.BindSampler(5, sampler); });
    add("read framebuffer", GL_READ_FRAMEBUFFER_BINDING,
        [this] { gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer); });
    add_buffer("array buffer", GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING);
    add_buffer("pixel pack buffer", GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING);
    add("pixel store", GL_PACK_ALIGNMENT, [this] { caller.PixelStorei(GL_PACK_ALIGNMENT, 8); });
    add("blend function", GL_BLEND_DST_RGB, [this] { caller.BlendFunc(GL_ONE, GL_DST_COLOR); });
    add("depth function", GL_DEPTH_FUNC, [this] { caller.DepthFunc(GL_GREATER); });
    add("depth mask", GL_DEPTH_WRITEMASK, [this] { caller.DepthMask(GL_FALSE); });
    add(
        "clear colour", [this] { gl.ClearColor(0.1f, 0.2f, 0.3f, 0.4f); },
        [this] { return integers(GL_COLOR_CLEAR_VALUE, 4); });
    add(
        "scissors", [this] { caller.ScissorIndexed(0, 1, 2, 3, 4); },
        [this] { return integers(GL_SCISSOR_BOX, 4); });
    add(
        "viewport 1", [this] { caller.ViewportIndexedf(1, 5, 6, 7, 8); }, [this] { return viewport(1); });
    add_enabled_at("blending of buffer 1", GL_BLEND, 1);
  }

  void set_all() {
    for (const Piece& piece : pieces) piece.set();
    ASSERT_TRUE(caller.context->take_errors().empty()) << "the test itself is wrong";
  }

  /// Returns the names of the pieces that an action changes.
  Names changed_by(const std::function<void()>& action) {
    set_all();
    std::vector<Values> before;
    for (const Piece& piece : pieces) before.push_back(piece.get());
    action();
    Names changed;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (pieces[k].get() != before[k]) changed.insert(pieces[k].name);
    }
    return changed;
  }
};

/// Returns both eyes of a head at the origin, 40 x 32 px each, with a focal length of 40 px.
std::array<View, 2> views_into(const std::array<Target, 2>& targets) {
  const double across = std::atan(0.5), up = std::atan(0.4);
  const Fov fov = {-across, across, up, -up};
  return {View{{.position = {-0.05, 0, 0}, .fov = fov}, {40, 32}, targets[0]},
          View{{.position = {0.05, 0, 0}, .fov = fov}, {40, 32}, targets[1]}};
}

/// Targets and depth textures: the first target is written in place, the second needs a copy. The second
/// depth texture is smaller.
struct Textures {
  std::array<std::uint32_t, 2> colours, depths;
  std::array<Target, 2> targets;

  explicit Textures(const test::Caller& caller)
      : colours{caller.texture(GL_RGBA32F, 40, 32), caller.texture(GL_RGB8, 40, 32)},
        depths{caller.texture(GL_DEPTH_COMPONENT32F, 40, 32), caller.texture(GL_DEPTH_COMPONENT24, 20, 16)} {
    targets[0].texture = colours[0];
    targets[1].framebuffer = caller.framebuffer(colours[1]);
  }
  std::array<View, 2> views() const { return views_into(targets); }
  std::array<View, 2> views_with_depths() const {
    std::array<View, 2> both = views();
    for (std::size_t k = 0; k < 2; ++k) both[k].depth = {.texture = depths[k]};
    return both;
  }
};

TEST_F(CallerState, IsRestoredAfterFrame) {
  const SplatModel model = in_memory(test::random_model(1, 200, 1));
  std::unique_ptr<Renderer> renderer;
  const auto made =
      changed_by([&] { renderer = std::make_unique<Renderer>(caller.get_proc_address(), model); });
  EXPECT_EQ(made, Names()) << "by uploading the model";
  const Textures odd(caller);
  const auto drawn = changed_by([&] { renderer->draw(odd.views_with_depths(), {}, over_black); });
  EXPECT_EQ(drawn, Names());
  const std::vector<float> depths = caller.read_depths(odd.depths[0], 40, 32);
  auto in_place = odd.views_with_depths();
  in_place[1].target = {.texture = caller.texture(GL_SRGB8_ALPHA8, 40, 32)};
  EXPECT_EQ(changed_by([&] { EXPECT_TRUE(renderer->draw(in_place, {}).in_place); }), Names());
  const std::uint32_t meshes = caller.texture(GL_DEPTH24_STENCIL8, 40, 32);
  for (auto with_meshes : {odd.views_with_depths(), in_place}) {
    for (View& view : with_meshes)
      view.mesh_depth = {.texture = meshes, .near_plane = 0.1, .far_plane = 100.0};
    EXPECT_EQ(changed_by([&] { renderer->draw(with_meshes, {}); }), Names());
  }
  const auto refused = changed_by([&] {
    for (const std::uint32_t bad : {4711u, caller.texture(GL_RGBA8UI, 40, 32)})
      EXPECT_THROW(renderer->draw(views_into({{odd.targets[0], {.texture = bad}}}), {}), Error);
  });
  EXPECT_EQ(refused, Names()) << "by a frame that failed";

  // The pictures equal those in a plain context: none of the unusual state affects them.
  set_all();
  renderer->draw(odd.views(), {});
  const auto odd_picture = caller.read<float>(odd.colours[0], 40, 32),
             odd_copy = caller.read<float>(odd.colours[1], 40, 32);
  test::Caller plain_caller;
  Renderer other(plain_caller.get_proc_address(), model);
  const Textures plain(plain_caller);
  other.draw(plain.views_with_depths(), {}, over_black);
  EXPECT_EQ(plain_caller.read_depths(plain.depths[0], 40, 32), depths);
  EXPECT_LT(*std::min_element(depths.begin(), depths.end()), 0.9f) << "no depth was drawn";
  other.draw(plain.views(), {});
  EXPECT_EQ(plain_caller.read<float>(plain.colours[0], 40, 32), odd_picture);
  EXPECT_EQ(plain_caller.read<float>(plain.colours[1], 40, 32), odd_copy);
  EXPECT_GT(*std::max_element(odd_copy.begin(), odd_copy.end()), 0.1f) << "nothing was copied";
}

TEST_F(CallerState, DeletedProgramLeavesNoError) {
  gl.UseProgram(caller.context->program("recolour.comp").id());
  caller.context->set_shader_folder({});  // deletes the program
  {
    const gl::SavedState kept(*caller.context);
    gl.UseProgram(0);
  }
  EXPECT_EQ(gl.GetError(), GLenum{GL_NO_ERROR});
}

TEST_F(CallerState, UnsavedStateIsDetected) {
  const Model model = test::random_model(1, 200, 1);
  render::Frame frame(*caller.context, model);
  const gl::SavedState kept(*caller.context);  // restores the earlier state at its end
  const auto careless = changed_by([&] {
    frame.draw(stereo::make_rig(test::front_camera(40, 32, 40.0), {.ipd = 0.1}).views);
    kept.set_plain();
    for (const GLuint unit : {0u, MAX_CANVASES - 1u})
      gl.BindImageTexture(unit, texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, 13, frame.colours().id(), 0, 16);
    gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, 8, frame.colours().id(), 0, 16);
  });
  Names expected;
  for (std::size_t k = 0; k < changed_count; ++k) expected.insert(pieces[k].name);
  EXPECT_EQ(careless, expected);
  const auto among_meshes = changed_by([&] {
    const render::MeshDepth mesh{.texture = caller.texture(GL_DEPTH_COMPONENT24, 40, 32), .size = {40, 32}};
    const render::Canvas canvas{.texture = caller.texture(GL_RGBA8, 40, 32)};
    frame.draw(stereo::make_rig(test::front_camera(40, 32, 40.0), {.ipd = 0.1}).views, {}, {},
               {.canvases = std::array{canvas, canvas}, .mesh_depths = std::array{mesh, mesh}});
  });
  for (const char* name :
       {"texture of unit 0", "sampler of unit 0", "texture of unit 4", "sampler of unit 4"})
    EXPECT_TRUE(among_meshes.contains(name)) << name;
}

}  // namespace
}  // namespace binosplat
