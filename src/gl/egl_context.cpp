// EGL contexts without a window. Loads libEGL at run time: a machine without it gets a message instead of a
// loader error, and a caller's context may need no EGL.

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <vector>

#include "base/error.h"
#include "gl/backends.h"

namespace binosplat::gl {

namespace {

constexpr const char* egl_to_install =
    "On Debian: apt install libegl1 and, for a GPU, its driver with EGL (NVIDIA: libnvidia-egl or the .run "
    "installer), or libegl-mesa0 libgl1-mesa-dri for software rendering.";

struct Egl {
  decltype(&eglGetProcAddress) get_proc_address = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglTerminate) terminate = nullptr;
  decltype(&eglBindAPI) bind_api = nullptr;
  decltype(&eglChooseConfig) choose_config = nullptr;
  decltype(&eglCreateContext) create_context = nullptr;
  decltype(&eglDestroyContext) destroy_context = nullptr;
  decltype(&eglMakeCurrent) make_current = nullptr;
  decltype(&eglGetError) get_error = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
  PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;             // may be absent
  PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;  // may be absent
};

const Egl& egl() {
  static const Egl loaded = [] {
    void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) fail_to_load("EGL", egl_to_install);
    Egl e;
    const auto load = [&](const char* name, auto& function) {
      load_function(library, "libEGL.so.1", name, egl_to_install, function);
    };
    load("eglGetProcAddress", e.get_proc_address);
    load("eglInitialize", e.initialize);
    load("eglTerminate", e.terminate);
    load("eglBindAPI", e.bind_api);
    load("eglChooseConfig", e.choose_config);
    load("eglCreateContext", e.create_context);
    load("eglDestroyContext", e.destroy_context);
    load("eglMakeCurrent", e.make_current);
    load("eglGetError", e.get_error);
    e.get_platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(e.get_proc_address("eglGetPlatformDisplayEXT"));
    e.query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(e.get_proc_address("eglQueryDevicesEXT"));
    e.query_device_string =
        reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(e.get_proc_address("eglQueryDeviceStringEXT"));
    if (e.get_platform_display == nullptr) {
      throw Error(ExitCode::no_gl, fmt::format("this EGL cannot choose a platform. {}", egl_to_install));
    }
    return e;
  }();
  return loaded;
}

class EglContext final : public Context {
 public:
  EglContext(EGLenum platform, void* native_display, const std::string& backend) {
    const Egl& e = egl();
    display_ = e.get_platform_display(platform, native_display, nullptr);
    if (display_ == EGL_NO_DISPLAY || e.initialize(display_, nullptr, nullptr) == EGL_FALSE)
      refuse(backend, "no display");
    e.bind_api(EGL_OPENGL_API);
    const std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    e.choose_config(display_, wanted.data(), &config, 1, &configs);
    const std::array<EGLint, 9> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_NONE};
    context_ = e.create_context(display_, configs > 0 ? config : nullptr, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) refuse(backend, "no OpenGL 4.5 core context");
    if (e.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      refuse(backend, "the context cannot be used without a surface");
    }
    initialise(e.get_proc_address, backend);
  }

  ~EglContext() override {
    release_programs();
    egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl().destroy_context(display_, context_);
    // The display stays initialised: EGL shares one per platform, and another context may be using it.
  }

 private:
  [[noreturn]] void refuse(const std::string& backend, const char* why) {
    const EGLint error = egl().get_error();
    if (context_ != EGL_NO_CONTEXT) egl().destroy_context(display_, context_);
    throw Error(ExitCode::no_gl,
                fmt::format("{}: {} (EGL error 0x{:04x}). {}", backend, why, error, egl_to_install));
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

std::vector<EGLDeviceEXT> devices() {
  const Egl& e = egl();
  EGLint count = 0;
  if (e.query_devices == nullptr || e.query_devices(0, nullptr, &count) == EGL_FALSE) return {};
  std::vector<EGLDeviceEXT> list(static_cast<std::size_t>(count));
  e.query_devices(count, list.data(), &count);
  list.resize(static_cast<std::size_t>(count));
  return list;
}

bool is_software(EGLDeviceEXT device) {
  const Egl& e = egl();
  const char* names =
      e.query_device_string == nullptr ? nullptr : e.query_device_string(device, EGL_EXTENSIONS);
  return names != nullptr && std::string(names).find("EGL_MESA_device_software") != std::string::npos;
}

}  // namespace

int Context::device_count() { return static_cast<int>(devices().size()); }

std::unique_ptr<Context> open_egl_device(int device) {
  const std::vector<EGLDeviceEXT> list = devices();
  if (device >= static_cast<int>(list.size())) {
    fail("device {}: EGL offers {} device(s), numbered from 0", device, list.size());
  }
  std::string reasons;
  for (int i = 0; i < static_cast<int>(list.size()); ++i) {
    // Uses a software device only if `device` selects it: by default the surfaceless platform opens llvmpipe.
    if (device >= 0 ? i != device : is_software(list[static_cast<std::size_t>(i)])) continue;
    try {
      return std::make_unique<EglContext>(EGL_PLATFORM_DEVICE_EXT, list[static_cast<std::size_t>(i)],
                                          fmt::format("EGL device {}", i));
    } catch (const Error& error) {
      reasons += fmt::format("{}{}", reasons.empty() ? "" : "\n  ", error.what());
    }
  }
  if (reasons.empty())
    reasons = fmt::format("EGL device platform: no GPU among {} device(s). {}", list.size(), egl_to_install);
  throw Error(ExitCode::no_gl, reasons);
}

std::unique_ptr<Context> open_egl_surfaceless() {
  return std::make_unique<EglContext>(EGL_PLATFORM_SURFACELESS_MESA, nullptr, "EGL surfaceless");
}

}  // namespace binosplat::gl
