#pragma once
// A program with an OpenGL context, as binosplat's callers have: the functions that it calls, and textures to
// draw into.

#include <dlfcn.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "gl/context.h"

namespace binosplat::test {

// Functions that binosplat itself does not call.
#define BINOSPLAT_CALLER_FUNCTIONS(X)       \
  X(ActiveTexture, ACTIVETEXTURE)           \
  X(BindSampler, BINDSAMPLER)               \
  X(BindTexture, BINDTEXTURE)               \
  X(BindVertexArray, BINDVERTEXARRAY)       \
  X(BlendFunc, BLENDFUNC)                   \
  X(ClipControl, CLIPCONTROL)               \
  X(ColorMaski, COLORMASKI)                 \
  X(CreateSamplers, CREATESAMPLERS)         \
  X(CreateVertexArrays, CREATEVERTEXARRAYS) \
  X(DepthFunc, DEPTHFUNC)                   \
  X(DepthMask, DEPTHMASK)                   \
  X(GetBooleani_v, GETBOOLEANI_V)           \
  X(GetFloati_v, GETFLOATI_V)               \
  X(GetFloatv, GETFLOATV)                   \
  X(GetTextureSubImage, GETTEXTURESUBIMAGE) \
  X(PixelStorei, PIXELSTOREI)               \
  X(PolygonMode, POLYGONMODE)               \
  X(ScissorIndexed, SCISSORINDEXED)         \
  X(TexImage2D, TEXIMAGE2D)                 \
  X(TextureParameteri, TEXTUREPARAMETERI)   \
  X(TextureStorage3D, TEXTURESTORAGE3D)     \
  X(TextureSubImage2D, TEXTURESUBIMAGE2D)   \
  X(TextureSubImage3D, TEXTURESUBIMAGE3D)   \
  X(ViewportIndexedf, VIEWPORTINDEXEDF)

/// At its end, makes the EGL context current that was current at its start, if there was one. Other tests of
/// the program share that context.
class CurrentAgain {
 public:
  CurrentAgain() {
    if (library_ == nullptr) return;
    display_ = call<void*()>("eglGetCurrentDisplay")();
    context_ = call<void*()>("eglGetCurrentContext")();
  }
  ~CurrentAgain() {
    using MakeCurrent = unsigned(void*, void*, void*, void*);
    if (context_ != nullptr) call<MakeCurrent>("eglMakeCurrent")(display_, nullptr, nullptr, context_);
  }
  CurrentAgain(const CurrentAgain&) = delete;
  CurrentAgain& operator=(const CurrentAgain&) = delete;

 private:
  template <typename F>
  F* call(const char* name) const {
    return reinterpret_cast<F*>(dlsym(library_, name));
  }

  void* library_ = dlopen("libEGL.so.1", RTLD_NOW);
  void *display_ = nullptr, *context_ = nullptr;
};

/// The caller's context, which becomes current, and its functions.
struct Caller {
  Caller() : context(gl::Context::open()), gl(context->gl()) {
#define BINOSPLAT_CALLER_LOAD(name, upper) \
  name = reinterpret_cast<PFNGL##upper##PROC>(get_proc_address()("gl" #name));
    BINOSPLAT_CALLER_FUNCTIONS(BINOSPLAT_CALLER_LOAD)
#undef BINOSPLAT_CALLER_LOAD
  }

  gl::GetProcAddress get_proc_address() const {
    const bool osmesa = context->backend() == "OSMesa";
    void* library = dlopen(osmesa ? "libOSMesa.so.8" : "libEGL.so.1", RTLD_NOW);
    void* found =
        library == nullptr ? nullptr : dlsym(library, osmesa ? "OSMesaGetProcAddress" : "eglGetProcAddress");
    if (found == nullptr) throw std::runtime_error("the caller has no getProcAddress");
    return reinterpret_cast<gl::GetProcAddress>(found);
  }

  std::uint32_t texture(GLenum format, int width, int height, int layers = 0) const {
    std::uint32_t id = 0;
    gl.CreateTextures(layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &id);
    if (layers > 0) {
      TextureStorage3D(id, 1, format, width, height, layers);
    } else {
      gl.TextureStorage2D(id, 1, format, width, height);
    }
    return id;
  }

  /// Creates a framebuffer that draws into a texture.
  std::uint32_t framebuffer(std::uint32_t of_texture) const {
    std::uint32_t id = 0;
    gl.CreateFramebuffers(1, &id);
    gl.NamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, of_texture, 0);
    return id;
  }

  /// Reads a layer, bottom row first: RGBA, or one number a pixel for other values of `what`.
  template <typename T>
  std::vector<T> read(std::uint32_t id, int width, int height, int layer = 0, GLenum what = GL_RGBA) const {
    std::vector<T> pixels((what == GL_RGBA ? 4 : 1) * static_cast<std::size_t>(width) *
                          static_cast<std::size_t>(height));
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    PixelStorei(GL_PACK_ALIGNMENT, 1);
    GetTextureSubImage(id, 0, 0, 0, layer, width, height, 1, what,
                       sizeof(T) == 4 ? GL_FLOAT : GL_UNSIGNED_BYTE,
                       static_cast<GLsizei>(pixels.size() * sizeof(T)), pixels.data());
    return pixels;
  }

  std::vector<float> read_depths(std::uint32_t id, int width, int height, int layer = 0) const {
    return read<float>(id, width, height, layer, GL_DEPTH_COMPONENT);
  }

  CurrentAgain before;
  std::unique_ptr<gl::Context> context;
  const gl::Functions& gl;
#define BINOSPLAT_CALLER_MEMBER(name, upper) PFNGL##upper##PROC name = nullptr;
  BINOSPLAT_CALLER_FUNCTIONS(BINOSPLAT_CALLER_MEMBER)
#undef BINOSPLAT_CALLER_MEMBER
};

}  // namespace binosplat::test
