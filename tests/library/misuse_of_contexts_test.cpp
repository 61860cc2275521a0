// Calls while another context than the renderer's is current, or none, or one in which binosplat cannot draw.

#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "library/renderer_fixture.h"
#include "support/errors.h"
#include "support/models.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace binosplat {
namespace {

constexpr const char* none_is_current = "no OpenGL context is current on this thread";

/// The driver's loader, with other results for some functions.
struct Loader {
  using Function = void (*)();
  static inline gl::GetProcAddress driver = nullptr;
  static inline std::string version, hidden;

  static const GLubyte* get_string(GLenum name) {
    const auto of_driver = reinterpret_cast<const GLubyte* (*)(GLenum)>(driver("glGetString"));
    if (name != GL_VERSION || version.empty()) return of_driver(name);
    return reinterpret_cast<const GLubyte*>(version.c_str());
  }
  static Function get_proc_address(const char* name) {
    if (name == hidden) return nullptr;
    return std::strcmp(name, "glGetString") == 0 ? reinterpret_cast<Function>(get_string) : driver(name);
  }
  static Function nothing(const char*) { return nullptr; }
};

using MakeCurrent = unsigned(void*, void*, void*, void*);

struct Contexts : Library {
  const SplatModel model = in_memory(test::random_model(3, 200, 0));

  Contexts() {
    Loader::driver = caller.get_proc_address();
    Loader::version = Loader::hidden = "";
  }

  testing::AssertionResult renderer_refused(gl::GetProcAddress loader,
                                            std::initializer_list<std::string> parts,
                                            ExitCode code = ExitCode::no_gl) const {
    return test::fails_saying([&] { Renderer(loader, model); }, parts, code);
  }
  /// Returns whether each call on a renderer with a submitted frame is refused, on another thread or on this
  /// one.
  testing::AssertionResult all_refused(Renderer& renderer, const std::string& saying, bool elsewhere) const {
    testing::AssertionResult result = testing::AssertionSuccess();
    const auto call_all = [&] {
      for (const auto& call : std::vector<std::function<void()>>{
               [&] { renderer.submit(views(), placement); }, [&] { renderer.finish(); },
               [&] { renderer.is_done(); }, [&] { renderer.draw(views(), placement); }}) {
        if (result) result = test::fails_saying(call, {saying}, ExitCode::no_gl);
      }
    };
    if (elsewhere) {
      std::thread(call_all).join();
    } else {
      call_all();
    }
    return result;
  }
};

TEST_F(Contexts, RejectsMissingContext) {
  std::thread([&] { EXPECT_TRUE(renderer_refused(caller.get_proc_address(), {none_is_current})); }).join();
  Renderer renderer(caller.get_proc_address(), model);
  renderer.submit(views(), placement, over_black);
  EXPECT_TRUE(all_refused(renderer, none_is_current, true));
  EXPECT_GT(renderer.finish().pairs, 0u) << "the frame is lost where it was asked for elsewhere";
}

TEST_F(Contexts, RejectsOtherContext) {
  Renderer renderer(caller.get_proc_address(), model);
  renderer.submit(views(), placement, over_black);
  {
    const test::Caller other;
    EXPECT_TRUE(all_refused(renderer, "another OpenGL context is current", false));
  }
  EXPECT_GT(renderer.finish().pairs, 0u);
}

TEST_F(Contexts, RendererEndsInOtherContext) {
  std::optional<Renderer> ends;
  {
#if defined(__SANITIZE_ADDRESS__)
    const __lsan::ScopedDisabler meant_to_leak;
#endif
    ends.emplace(caller.get_proc_address(), model);
  }
  const test::Caller other;
  Renderer stays(other.get_proc_address(), model);
  std::vector<View> one = {views()[0]};
  one[0].target.texture = other.texture(GL_RGBA32F, size.x, size.y);
  const std::uint64_t pairs = stays.draw(one, placement, over_black).pairs;
  const auto drawn = other.read<float>(one[0].target.texture, size.x, size.y);
  testing::internal::CaptureStderr();
  ends.reset();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("its memory is not freed"), std::string::npos);
  EXPECT_EQ(stays.draw(one, placement, over_black).pairs, pairs);
  EXPECT_EQ(other.read<float>(one[0].target.texture, size.x, size.y), drawn);
}

TEST_F(Contexts, RejectsOldOrForeignVersions) {
  EXPECT_TRUE(
      renderer_refused(nullptr, {"get_proc_address is null", "eglGetProcAddress"}, ExitCode::bad_input));
  EXPECT_TRUE(renderer_refused(Loader::nothing, {"get_proc_address finds no glGetString"}));
  for (const char* version : {"4.4 (Core Profile) Mesa 22.3.6", "2.1 Mesa 22.3.6", "4.3.0 NVIDIA 535.54"}) {
    Loader::version = version;
    EXPECT_TRUE(renderer_refused(Loader::get_proc_address,
                                 {std::string("has OpenGL ") + version, "needs OpenGL 4.5 core or later"}));
  }
  Loader::version = "OpenGL ES 3.2 Mesa 22.3.6";
  EXPECT_TRUE(renderer_refused(Loader::get_proc_address, {"has OpenGL ES 3.2", "not OpenGL ES"}));
  Loader::version = "4.6.0 NVIDIA 535.54";
  EXPECT_NO_THROW(Renderer(Loader::get_proc_address, model));
  Loader::hidden = "glDispatchCompute";
  EXPECT_TRUE(renderer_refused(Loader::get_proc_address, {"has no glDispatchCompute"}));
}

// A real context of OpenGL ES.
TEST_F(Contexts, RejectsOpenGLES) {
  const auto get_display = function<void*()>("eglGetCurrentDisplay");
  if (get_display == nullptr || get_display() == nullptr) GTEST_SKIP() << "no EGL here";
  constexpr int version_name = 0x3098, end = 0x3038;
  constexpr unsigned opengl_es = 0x30a0, opengl = 0x30a2;
  const test::CurrentAgain again;
  void* const display = get_display();
  const auto bind = function<unsigned(unsigned)>("eglBindAPI");
  bind(opengl_es);
  void* const context = function<void*(void*, void*, void*, const int*)>("eglCreateContext")(
      display, nullptr, nullptr, std::array{version_name, 3, end}.data());
  bind(opengl);
  if (context == nullptr) GTEST_SKIP() << "no OpenGL ES here";
  ASSERT_NE(function<MakeCurrent>("eglMakeCurrent")(display, nullptr, nullptr, context), 0u);
  EXPECT_TRUE(renderer_refused(caller.get_proc_address(), {"has OpenGL ES 3", "binosplat needs OpenGL 4.5"}));
  // EGL deletes the context after another one becomes current.
  function<unsigned(void*, void*)>("eglDestroyContext")(display, context);
}

// The renderer can draw into a context's default framebuffer, but not to the left of its corner.
TEST_F(Contexts, DrawsIntoDefaultFramebuffer) {
  const auto get_display = function<void*()>("eglGetCurrentDisplay");
  if (get_display == nullptr || get_display() == nullptr) GTEST_SKIP() << "no EGL here";
  void *const display = get_display(), *const context = function<void*()>("eglGetCurrentContext")();
  constexpr int config_id = 0x3028, end = 0x3038, width = 0x3057, height = 0x3056;
  int number = 0, count = 0;
  void* config = nullptr;
  function<unsigned(void*, void*, int, int*)>("eglQueryContext")(display, context, config_id, &number);
  function<unsigned(void*, const int*, void**, int, int*)>("eglChooseConfig")(
      display, std::array{config_id, number, end}.data(), &config, 1, &count);
  void* const surface = function<void*(void*, void*, const int*)>("eglCreatePbufferSurface")(
      display, config, std::array{width, size.x, height, size.y, end}.data());
  const auto make_current = function<MakeCurrent>("eglMakeCurrent");
  if (surface == nullptr || make_current(display, surface, surface, context) == 0u)
    GTEST_SKIP() << "no surface here";
  Renderer renderer(caller.get_proc_address(), model);
  std::vector<View> one = {views()[0]};
  one[0].target = {};
  EXPECT_GT(renderer.draw(one, placement, over_black).pairs, 0u);
  EXPECT_TRUE(renderer.draw(one, placement, over_black).callers_errors.empty());
  one[0].target.x = -1;
  EXPECT_ERROR(renderer.draw(one, placement), "views[0].target", "-1, 0");
  make_current(display, nullptr, nullptr, context);
  function<unsigned(void*, void*)>("eglDestroySurface")(display, surface);
}

}  // namespace
}  // namespace binosplat
