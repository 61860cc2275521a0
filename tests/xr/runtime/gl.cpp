#include "xr/runtime/gl.h"

#include <dlfcn.h>

#include "xr/egl_as_xlib.h"
#include "xr/runtime/state.h"

namespace binosplat::xr_test {
namespace {

using Proc = void (*)();
using GetProc = Proc (*)(const char*);
using EglMakeCurrent = unsigned (*)(void*, void*, void*, void*);
using GlxMakeCurrent = int (*)(void*, unsigned long, void*);

template <typename T>
void load(T& function, const GetProc get, const char* name) {
  function = reinterpret_cast<T>(get(name));
  require(function != nullptr, XR_ERROR_GRAPHICS_DEVICE_INVALID, std::string("the context has no ") + name);
}

void load_all(Binding& gl, const GetProc get) {
#define BINOSPLAT_LOAD(name, upper) load(gl.name, get, "gl" #name);
  BINOSPLAT_XR_GL(BINOSPLAT_LOAD)
#undef BINOSPLAT_LOAD
}

Binding from_egl(const XrGraphicsBindingEGLMNDX& egl) {
  Binding gl;
  gl.name = "egl";
  gl.display = egl.display;
  gl.context = egl.context;
  require(egl.getProcAddress != nullptr && egl.display != nullptr && egl.context != nullptr,
          XR_ERROR_GRAPHICS_DEVICE_INVALID, "an EGL binding without getProcAddress, display or context");
  const auto get = reinterpret_cast<GetProc>(egl.getProcAddress);
  load(gl.current, get, "eglGetCurrentContext");
  load(gl.egl_make_current, get, "eglMakeCurrent");
  load_all(gl, get);
  return gl;
}

Binding from_xlib(const XlibBinding& xlib) {
  Binding gl;
  gl.name = "xlib";
  gl.display = xlib.display;
  gl.drawable = xlib.drawable;
  gl.context = xlib.context;
  require(xlib.display != nullptr && xlib.context != nullptr, XR_ERROR_GRAPHICS_DEVICE_INVALID,
          "an Xlib binding without display or context");
  void* library = dlopen("libGLX.so.0", RTLD_NOW);
  void* found = library == nullptr ? nullptr : dlsym(library, "glXGetProcAddressARB");
  require(found != nullptr, XR_ERROR_GRAPHICS_DEVICE_INVALID, "there is no glXGetProcAddressARB");
  const auto get = reinterpret_cast<GetProc>(found);
  load(gl.current, get, "glXGetCurrentContext");
  load(gl.glx_make_current, get, "glXMakeCurrent");
  load_all(gl, get);
  return gl;
}

/// Sets what of the context's state reading back depends on, and sets it back.
class PackState {
 public:
  explicit PackState(const Binding& gl) : gl_(gl) {
    gl_.GetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &buffer_);
    gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    for (std::size_t k = 0; k < names.size(); ++k) {
      gl_.GetIntegerv(names[k], &kept_[k]);
      gl_.PixelStorei(names[k], names[k] == GL_PACK_ALIGNMENT ? 1 : 0);
    }
  }
  ~PackState() {
    gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(buffer_));
    for (std::size_t k = 0; k < names.size(); ++k) gl_.PixelStorei(names[k], kept_[k]);
  }
  PackState(const PackState&) = delete;
  PackState& operator=(const PackState&) = delete;

 private:
  static constexpr std::array<GLenum, 8> names = {
      GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_PIXELS,
      GL_PACK_SKIP_ROWS, GL_PACK_SKIP_IMAGES, GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST};
  const Binding& gl_;
  GLint buffer_ = 0;
  std::array<GLint, names.size()> kept_{};
};

}  // namespace

Binding binding_from(const void* next, bool egl_enabled, bool xlib_enabled) {
  if (const auto* egl = chained<XrGraphicsBindingEGLMNDX>(next, XR_TYPE_GRAPHICS_BINDING_EGL_MNDX)) {
    require(egl_enabled, XR_ERROR_GRAPHICS_DEVICE_INVALID, "XR_MNDX_egl_enable was not enabled");
    return from_egl(*egl);
  }
  if (const auto* xlib = chained<XlibBinding>(next, XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR)) {
    if (xlib->visual == egl_visual) {
      return from_egl(*reinterpret_cast<const XrGraphicsBindingEGLMNDX*>(xlib->drawable));
    }
    require(xlib_enabled, XR_ERROR_GRAPHICS_DEVICE_INVALID, "XR_KHR_opengl_enable was not enabled");
    return from_xlib(*xlib);
  }
  refuse(XR_ERROR_GRAPHICS_DEVICE_INVALID, "no graphics binding: one of EGL or Xlib is expected");
}

Current::Current(const Binding& binding) : binding_(binding) {
  if (binding.current() == binding.context) return;
  switched_ = true;
  // What was current is not known to be in this thread alone, so only none is put back.
  require(binding.current() == nullptr, XR_ERROR_RUNTIME_FAILURE,
          "another context than the session's is current");
  const bool good = binding.name == "egl" ? reinterpret_cast<EglMakeCurrent>(binding.egl_make_current)(
                                                binding.display, nullptr, nullptr, binding.context) != 0
                                          : reinterpret_cast<GlxMakeCurrent>(binding.glx_make_current)(
                                                binding.display, binding.drawable, binding.context) != 0;
  require(good, XR_ERROR_RUNTIME_FAILURE, "the session's context cannot be made current in this thread");
}

Current::~Current() {
  if (!switched_) return;
  if (binding_.name == "egl") {
    reinterpret_cast<EglMakeCurrent>(binding_.egl_make_current)(binding_.display, nullptr, nullptr, nullptr);
  } else {
    reinterpret_cast<GlxMakeCurrent>(binding_.glx_make_current)(binding_.display, 0, nullptr);
  }
}

XrVersion version_of(const Binding& gl) {
  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  return XR_MAKE_VERSION(major, minor, 0);
}

bool is_depth(std::int64_t format) {
  return format == GL_DEPTH_COMPONENT16 || format == GL_DEPTH_COMPONENT24 || format == GL_DEPTH_COMPONENT32F;
}

std::uint32_t make_texture(const Binding& gl, const XrSwapchainCreateInfo& info, bool immutable) {
  const auto format = static_cast<GLenum>(info.format);
  const auto width = static_cast<GLsizei>(info.width), height = static_cast<GLsizei>(info.height);
  GLuint texture = 0;
  if (immutable) {
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, static_cast<GLsizei>(info.mipCount), format, width, height);
    return texture;
  }
  GLint bound = 0;
  gl.GetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0,
                is_depth(info.format) ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl.BindTexture(GL_TEXTURE_2D, static_cast<GLuint>(bound));
  return texture;
}

std::vector<std::uint8_t> read_texture(const Binding& gl, std::uint32_t texture,
                                       const XrSwapchainCreateInfo& info) {
  const PackState state(gl);
  std::vector<std::uint8_t> bytes(std::size_t{4} * info.width * info.height);
  const bool depth = is_depth(info.format);
  gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  gl.GetTextureSubImage(texture, 0, 0, 0, 0, static_cast<GLsizei>(info.width),
                        static_cast<GLsizei>(info.height), 1, depth ? GL_DEPTH_COMPONENT : GL_RGBA,
                        depth ? GL_FLOAT : GL_UNSIGNED_BYTE, static_cast<GLsizei>(bytes.size()),
                        bytes.data());
  return bytes;
}

}  // namespace binosplat::xr_test
