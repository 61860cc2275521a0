// A caller's OpenGL state is after a frame what it was before, state by state.

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

#include "base/error.h"
#include "gl/state.h"
#include "stereo/embed.h"
#include "support/caller.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

using Values = std::vector<double>;

/// A piece of state: how the caller sets it to something unusual, and what it is now.
struct Piece {
  std::string name;
  std::function<void()> set;
  std::function<Values()> get;
  bool drawing_changes = true;
};

struct State : testing::Test {
  test::Caller caller;
  const gl::Functions& gl = caller.gl;
  std::vector<Piece> pieces;
  gl::Buffer buffer{*caller.context, "the caller's"};
  std::uint32_t framebuffer = 0, vertices = 0, sampler = 0;
  std::uint32_t texture = caller.texture(GL_RGBA8, 8, 8);

  Values integers(GLenum name, int count = 1) const {
    std::array<GLint, 4> values{};
    gl.GetIntegerv(name, values.data());
    return {values.begin(), values.begin() + count};
  }
  void add(const std::string& name, std::function<void()> set, std::function<Values()> get,
           bool changes = true) {
    pieces.push_back({name, std::move(set), std::move(get), changes});
  }
  void add_enabled(const std::string& name, GLenum effect) {
    add(
        name, [this, effect] { gl.Enable(effect); },
        [this, effect] { return Values{double(gl.IsEnabled(effect))}; });
  }

  State() {
    buffer.reserve(4096);
    gl.CreateFramebuffers(1, &framebuffer);
    gl.CreateVertexArrays(1, &vertices);
    caller.CreateSamplers(1, &sampler);
    add_bindings();
    add_effects();
    add_untouched();
  }

  void add_bindings() {
    add(
        "program", [this] { gl.UseProgram(caller.context->program("ranges_clear.comp").id()); },
        [this] { return integers(GL_CURRENT_PROGRAM); });
    add(
        "vertex array", [this] { gl.BindVertexArray(vertices); },
        [this] { return integers(GL_VERTEX_ARRAY_BINDING); });
    add(
        "draw framebuffer", [this] { gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer); },
        [this] { return integers(GL_DRAW_FRAMEBUFFER_BINDING); });
    add(
        "storage buffer", [this] { gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.id()); },
        [this] { return integers(GL_SHADER_STORAGE_BUFFER_BINDING); });
    add(
        "indirect buffer", [this] { gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer.id()); },
        [this] { return integers(GL_DISPATCH_INDIRECT_BUFFER_BINDING); });
    for (GLuint i = 0; i < gl::storage_blocks_needed; ++i) {
      // Some bound as a range, some as a whole, and the general binding must survive both.
      const auto set = [this, i] {
        if (i % 3 == 2) {
          gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffer.id());
        } else {
          gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffer.id(), 256 * (i + 1), 128);
        }
        gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.id());
      };
      const auto get = [this, i] {
        GLint id = 0;
        GLint64 start = 0, size = 0;
        gl.GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, i, &id);
        gl.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_START, i, &start);
        gl.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_SIZE, i, &size);
        return Values{double(id), double(start), double(size)};
      };
      add("storage binding " + std::to_string(i), set, get);
    }
  }

  void add_effects() {
    add(
        "viewport", [this] { gl.ViewportIndexedf(0, 1.5f, 2, 33, 44); },
        [this] {
          std::array<float, 4> v{};
          gl.GetFloati_v(GL_VIEWPORT, 0, v.data());
          return Values(v.begin(), v.end());
        });
    add(
        "colour mask", [this] { gl.ColorMaski(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE); },
        [this] {
          std::array<GLboolean, 4> v{};
          gl.GetBooleani_v(GL_COLOR_WRITEMASK, 0, v.data());
          return Values(v.begin(), v.end());
        });
    add(
        "scissor test", [this] { gl.Enablei(GL_SCISSOR_TEST, 0); },
        [this] { return Values{double(gl.IsEnabledi(GL_SCISSOR_TEST, 0))}; });
    add(
        "blending", [this] { gl.Enablei(GL_BLEND, 0); },
        [this] { return Values{double(gl.IsEnabledi(GL_BLEND, 0))}; });
    add(
        "clip origin", [this] { gl.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE); },
        [this] { return integers(GL_CLIP_ORIGIN); });
    add(
        "clip depth", [] {}, [this] { return integers(GL_CLIP_DEPTH_MODE); });
    add(
        "polygon mode", [this] { gl.PolygonMode(GL_FRONT_AND_BACK, GL_LINE); },
        [this] { return integers(GL_POLYGON_MODE); });
    for (const auto& [name, effect] :
         std::vector<std::pair<const char*, GLenum>>{{"depth test", GL_DEPTH_TEST},
                                                     {"stencil test", GL_STENCIL_TEST},
                                                     {"culling", GL_CULL_FACE},
                                                     {"rasterizer discard", GL_RASTERIZER_DISCARD},
                                                     {"sRGB framebuffer", GL_FRAMEBUFFER_SRGB},
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

  void add_untouched() {
    add(
        "texture unit", [this] { caller.ActiveTexture(GL_TEXTURE5); },
        [this] { return integers(GL_ACTIVE_TEXTURE); }, false);
    add(
        "texture", [this] { caller.BindTexture(GL_TEXTURE_2D, texture); },
        [this] { return integers(GL_TEXTURE_BINDING_2D); }, false);
    add(
        "sampler", [this] { caller.BindSampler(5, sampler); },
        [this] { return integers(GL_SAMPLER_BINDING); }, false);
    add(
        "uniform buffer", [this] { gl.BindBufferRange(GL_UNIFORM_BUFFER, 0, buffer.id(), 0, 256); },
        [this] { return integers(GL_UNIFORM_BUFFER_BINDING); }, false);
    add(
        "read framebuffer", [this] { gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer); },
        [this] { return integers(GL_READ_FRAMEBUFFER_BINDING); }, false);
    add(
        "array buffer", [this] { gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id()); },
        [this] { return integers(GL_ARRAY_BUFFER_BINDING); }, false);
    add(
        "pixel pack buffer", [this] { gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer.id()); },
        [this] { return integers(GL_PIXEL_PACK_BUFFER_BINDING); }, false);
    add(
        "pixel store", [this] { caller.PixelStorei(GL_PACK_ALIGNMENT, 8); },
        [this] { return integers(GL_PACK_ALIGNMENT); }, false);
    add(
        "blend function", [this] { caller.BlendFunc(GL_ONE, GL_DST_COLOR); },
        [this] { return integers(GL_BLEND_DST_RGB); }, false);
    add(
        "depth function", [this] { caller.DepthFunc(GL_GREATER); },
        [this] { return integers(GL_DEPTH_FUNC); }, false);
    add(
        "depth mask", [this] { caller.DepthMask(GL_FALSE); }, [this] { return integers(GL_DEPTH_WRITEMASK); },
        false);
    add(
        "clear colour", [this] { gl.ClearColor(0.1f, 0.2f, 0.3f, 0.4f); },
        [this] {
          std::array<float, 4> v{};
          caller.GetFloatv(GL_COLOR_CLEAR_VALUE, v.data());
          return Values(v.begin(), v.end());
        },
        false);
    add(
        "scissors", [this] { caller.ScissorIndexed(0, 1, 2, 3, 4); },
        [this] { return integers(GL_SCISSOR_BOX, 4); }, false);
    add(
        "viewport 1", [this] { gl.ViewportIndexedf(1, 5, 6, 7, 8); },
        [this] {
          std::array<float, 4> v{};
          gl.GetFloati_v(GL_VIEWPORT, 1, v.data());
          return Values(v.begin(), v.end());
        },
        false);
    add(
        "blending of buffer 1", [this] { gl.Enablei(GL_BLEND, 1); },
        [this] { return Values{double(gl.IsEnabledi(GL_BLEND, 1))}; }, false);
  }

  void set_all() {
    for (const Piece& piece : pieces) piece.set();
    ASSERT_TRUE(caller.context->take_errors().empty()) << "the test itself is wrong";
  }

  /// Names of the pieces that an action leaves other than they were.
  std::set<std::string> changed_by(const std::function<void()>& action) {
    set_all();
    std::vector<Values> before;
    for (const Piece& piece : pieces) before.push_back(piece.get());
    action();
    std::set<std::string> changed;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (pieces[k].get() != before[k]) changed.insert(pieces[k].name);
    }
    return changed;
  }
};

std::array<shared::View, 2> views() { return make_rig(test::front_camera(40, 32, 40.0), {.ipd = 0.1}).views; }

TEST_F(State, IsTheSameAfterAFrame) {
  const Model model = test::random_model(1, 200, 1);
  std::unique_ptr<EmbeddedRenderer> renderer;
  const auto made =
      changed_by([&] { renderer = std::make_unique<EmbeddedRenderer>(caller.get_proc_address(), model); });
  EXPECT_EQ(made, std::set<std::string>()) << "by uploading the model";
  const std::array targets = {Target{.texture = caller.texture(GL_RGBA32F, 40, 32)},
                              Target{.texture = caller.texture(GL_RGBA32F, 40, 32)}};
  const auto drawn = changed_by([&] { renderer->draw(views(), targets); });
  EXPECT_EQ(drawn, std::set<std::string>());

  // And the pictures are those of a plain context: none of that state reached them.
  const auto odd = caller.read<float>(targets[0].texture, 40, 32);
  const auto refused = changed_by([&] {
    EXPECT_THROW(renderer->draw(views(), std::array{targets[0], Target{.texture = 4711}}), Error);
  });
  EXPECT_EQ(refused, std::set<std::string>()) << "by a frame that failed";
  test::Caller plain;
  EmbeddedRenderer other(plain.get_proc_address(), model);
  const std::array plain_targets = {Target{.texture = plain.texture(GL_RGBA32F, 40, 32)},
                                    Target{.texture = plain.texture(GL_RGBA32F, 40, 32)}};
  other.draw(views(), plain_targets);
  EXPECT_EQ(plain.read<float>(plain_targets[0].texture, 40, 32), odd);
}

TEST_F(State, DrawingWithoutCareIsNoticedInEveryPiece) {
  const Model model = test::random_model(1, 200, 1);
  render::Frame frame(*caller.context, model);
  const gl::KeptState kept(*caller.context);  // of the caller's before the test sets its own: ends it all
  const std::uint32_t target = caller.texture(GL_RGBA32F, 40, 32);
  const auto careless = changed_by([&] {
    frame.draw(views());
    kept.set_plain();
    std::uint32_t own = 0;
    gl.CreateFramebuffers(1, &own);
    gl.NamedFramebufferTexture(own, GL_COLOR_ATTACHMENT0, target, 0);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, own);
    gl.ViewportIndexedf(0, 0, 0, 40, 32);
    gl.BindVertexArray(0);
    gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, 8, frame.colours().id(), 0, 16);
  });
  std::set<std::string> expected;
  for (const Piece& piece : pieces) {
    if (piece.drawing_changes) expected.insert(piece.name);
  }
  EXPECT_EQ(careless, expected);
}

}  // namespace
}  // namespace binosplat::stereo
