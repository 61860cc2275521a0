#pragma once
// The application's OpenGL context, in which the swapchains' textures are made and read.

#include <GL/glcorearb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "xr/runtime/openxr.h"

namespace binosplat::xr_test {

#define BINOSPLAT_XR_GL(X)                  \
  X(BindBuffer, BINDBUFFER)                 \
  X(BindTexture, BINDTEXTURE)               \
  X(CreateTextures, CREATETEXTURES)         \
  X(DeleteTextures, DELETETEXTURES)         \
  X(GenTextures, GENTEXTURES)               \
  X(GetIntegerv, GETINTEGERV)               \
  X(GetTextureSubImage, GETTEXTURESUBIMAGE) \
  X(MemoryBarrier, MEMORYBARRIER)           \
  X(PixelStorei, PIXELSTOREI)               \
  X(TexImage2D, TEXIMAGE2D)                 \
  X(TexParameteri, TEXPARAMETERI)           \
  X(TextureStorage2D, TEXTURESTORAGE2D)

/// What xrCreateSession was given.
struct Binding {
  std::string name;  // "egl", "xlib"
  void* display = nullptr;
  unsigned long drawable = 0;
  void* context = nullptr;
#define BINOSPLAT_MEMBER(name, upper) PFNGL##upper##PROC name = nullptr;
  BINOSPLAT_XR_GL(BINOSPLAT_MEMBER)
#undef BINOSPLAT_MEMBER
  // EGL's, or GLX's by the same shape.
  void* (*current)() = nullptr;
  void* egl_make_current = nullptr;
  void* glx_make_current = nullptr;
};

/// The binding in a chain of structures, its functions loaded. Throws Refusal for none, or one that was not
/// enabled.
Binding binding_from(const void* next, bool egl_enabled, bool xlib_enabled);

/// Makes the binding's context current where it is not, and what was current again afterwards.
class Current {
 public:
  explicit Current(const Binding& binding);
  ~Current();
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  const Binding& binding_;
  bool switched_ = false;
};

XrVersion version_of(const Binding& gl);
bool is_depth(std::int64_t format);
std::uint32_t make_texture(const Binding& gl, const XrSwapchainCreateInfo& info, bool immutable);
/// RGBA8, or float32 of depth; the lowest row first.
std::vector<std::uint8_t> read_texture(const Binding& gl, std::uint32_t texture,
                                       const XrSwapchainCreateInfo& info);

}  // namespace binosplat::xr_test
