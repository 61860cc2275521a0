#include "xr/binding.h"

#include <dlfcn.h>

#include "base/error.h"
#include "xr/instance.h"
#include "xr/platform.h"

namespace binosplat::xr {

namespace {

// Of a library that whoever made the context has opened; null if nobody has.
template <typename Function>
Function opened(const char* library, const char* name) {
  void* handle = dlopen(library, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  if (handle == nullptr) return nullptr;
  const auto function = reinterpret_cast<Function>(dlsym(handle, name));
  dlclose(handle);  // whoever opened it keeps it
  return function;
}

void check_version(const Instance& instance) {
  const auto requirements =
      find<PFN_xrGetOpenGLGraphicsRequirementsKHR>(instance.handle(), "xrGetOpenGLGraphicsRequirementsKHR");
  XrGraphicsRequirementsOpenGLKHR range{XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
  check(requirements(instance.handle(), instance.system(), &range), "xrGetOpenGLGraphicsRequirementsKHR");
  constexpr XrVersion needed = XR_MAKE_VERSION(4, 5, 0);
  const auto text = [](XrVersion v) {
    return fmt::format("{}.{}", XR_VERSION_MAJOR(v), XR_VERSION_MINOR(v));
  };
  // What runtimes name as the most is what they were tried with: newer contexts are what drivers give anyway.
  if (range.minApiVersionSupported > XR_MAKE_VERSION(4, 6, 0))
    throw Error(ExitCode::no_gl, fmt::format("{} wants OpenGL {} and more; binosplat draws with 4.5",
                                             instance.runtime(), text(range.minApiVersionSupported)));
  if (range.maxApiVersionSupported < needed)
    throw Error(ExitCode::no_gl, fmt::format("{} takes OpenGL up to {} only; binosplat needs 4.5",
                                             instance.runtime(), text(range.maxApiVersionSupported)));
}

std::shared_ptr<const void> egl_binding() {
  const auto display = opened<decltype(&eglGetCurrentDisplay)>("libEGL.so.1", "eglGetCurrentDisplay");
  const auto current = opened<decltype(&eglGetCurrentContext)>("libEGL.so.1", "eglGetCurrentContext");
  if (current == nullptr || display == nullptr || current() == EGL_NO_CONTEXT) return nullptr;
  const auto query = opened<decltype(&eglQueryContext)>("libEGL.so.1", "eglQueryContext");
  const auto choose = opened<decltype(&eglChooseConfig)>("libEGL.so.1", "eglChooseConfig");
  XrGraphicsBindingEGLMNDX binding{XR_TYPE_GRAPHICS_BINDING_EGL_MNDX};
  binding.getProcAddress = opened<PFNEGLGETPROCADDRESSPROC>("libEGL.so.1", "eglGetProcAddress");
  binding.display = display();
  binding.context = current();
  EGLint id = 0, count = 0;  // of the config: 0 for a context that was made without one
  query(binding.display, binding.context, EGL_CONFIG_ID, &id);
  const EGLint wanted[] = {EGL_CONFIG_ID, id, EGL_NONE};
  if (id != 0) choose(binding.display, wanted, &binding.config, 1, &count);
  return std::make_shared<XrGraphicsBindingEGLMNDX>(binding);
}

std::shared_ptr<const void> glx_binding() {
  const char* library = "libGLX.so.0";
  const auto current = opened<decltype(&glXGetCurrentContext)>(library, "glXGetCurrentContext");
  if (current == nullptr || current() == nullptr) return nullptr;
  const auto display = opened<decltype(&glXGetCurrentDisplay)>(library, "glXGetCurrentDisplay");
  const auto drawable = opened<decltype(&glXGetCurrentDrawable)>(library, "glXGetCurrentDrawable");
  const auto query = opened<decltype(&glXQueryContext)>(library, "glXQueryContext");
  const auto choose = opened<decltype(&glXChooseFBConfig)>(library, "glXChooseFBConfig");
  const auto visual_of = opened<decltype(&glXGetVisualFromFBConfig)>(library, "glXGetVisualFromFBConfig");
  const auto release = opened<decltype(&XFree)>("libX11.so.6", "XFree");
  XrGraphicsBindingOpenGLXlibKHR binding{XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR};
  binding.xDisplay = display();
  binding.glxContext = current();
  binding.glxDrawable = drawable();
  int id = 0, screen = 0, count = 0;
  query(binding.xDisplay, binding.glxContext, GLX_FBCONFIG_ID, &id);
  query(binding.xDisplay, binding.glxContext, GLX_SCREEN, &screen);
  const int wanted[] = {GLX_FBCONFIG_ID, id, 0};
  if (GLXFBConfig* const configs = choose(binding.xDisplay, screen, wanted, &count); configs != nullptr) {
    binding.glxFBConfig = configs[0];
    if (XVisualInfo* const visual = visual_of(binding.xDisplay, configs[0]); visual != nullptr) {
      binding.visualid = static_cast<std::uint32_t>(visual->visualid);
      release(visual);
    }
    release(configs);
  }
  return std::make_shared<XrGraphicsBindingOpenGLXlibKHR>(binding);
}

}  // namespace

std::shared_ptr<const void> binding_of_current_context(const Instance& instance) {
  check_version(instance);
  if (auto egl = egl_binding()) {
    if (!instance.has(egl_extension))
      throw Error(
          ExitCode::no_gl,
          fmt::format("{} takes no EGL contexts ({} is missing): run this where there is an X display, "
                      "without --no-mirror: then the window's own context of GLX draws",
                      instance.runtime(), egl_extension));
    return egl;
  }
  if (auto glx = glx_binding()) return glx;
  throw Error(ExitCode::no_gl, "OpenXR takes contexts of EGL and of GLX only, and none is current");
}

}  // namespace binosplat::xr
