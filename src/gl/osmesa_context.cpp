// OSMesa, Mesa as a library, loaded at run time: the program, and its bundles for GPUs, do not depend on
// Mesa. This file defines OSMesa's few constants, so that the build needs no headers of Mesa.

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string>

#include "base/error.h"
#include "gl/backends.h"

namespace binosplat::gl {

namespace {

constexpr const char* osmesa_to_install = "On Debian: apt install libosmesa6.";

// From GL/osmesa.h.
constexpr int osmesa_format = 0x22;
constexpr int osmesa_profile = 0x33;
constexpr int osmesa_core_profile = 0x34;
constexpr int osmesa_context_major_version = 0x36;
constexpr int osmesa_context_minor_version = 0x37;

struct OsMesa {
  void* (*create_context)(const int* attributes, void* shared) = nullptr;
  void (*destroy_context)(void* context) = nullptr;
  GLboolean (*make_current)(void* context, void* buffer, GLenum type, GLsizei width,
                            GLsizei height) = nullptr;
  GetProcAddress get_proc_address = nullptr;
};

const OsMesa& osmesa() {
  static const OsMesa loaded = [] {
    void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) fail_to_load("OSMesa", osmesa_to_install);
    OsMesa o;
    const auto load = [&](const char* name, auto& function) {
      load_function(library, "OSMesa", name, osmesa_to_install, function);
    };
    load("OSMesaCreateContextAttribs", o.create_context);
    load("OSMesaDestroyContext", o.destroy_context);
    load("OSMesaMakeCurrent", o.make_current);
    load("OSMesaGetProcAddress", o.get_proc_address);
    return o;
  }();
  return loaded;
}

/// Selects llvmpipe in the environment during its lifetime: OSMesa's other drivers lack OpenGL 4.5. OSMesa
/// crashes if the environment selects a driver that its build lacks, such as d3d12, which users of WSL set.
class WithLlvmpipe {
 public:
  WithLlvmpipe() {
    const char* const asked = std::getenv(name);
    if (asked == nullptr) return;
    asked_ = asked;
    setenv(name, "llvmpipe", 1);
  }
  ~WithLlvmpipe() {
    if (asked_) setenv(name, asked_->c_str(), 1);
  }
  WithLlvmpipe(const WithLlvmpipe&) = delete;
  WithLlvmpipe& operator=(const WithLlvmpipe&) = delete;

 private:
  static constexpr const char* name = "GALLIUM_DRIVER";
  std::optional<std::string> asked_;
};

class OsMesaContext final : public Context {
 public:
  OsMesaContext() {
    const std::array<int, 9> attributes = {osmesa_format,
                                           GL_RGBA,
                                           osmesa_profile,
                                           osmesa_core_profile,
                                           osmesa_context_major_version,
                                           4,
                                           osmesa_context_minor_version,
                                           5,
                                           0};
    const WithLlvmpipe with_llvmpipe;
    context_ = osmesa().create_context(attributes.data(), nullptr);
    if (context_ == nullptr) throw Error(ExitCode::no_gl, "OSMesa: no OpenGL 4.5 core context");
    if (osmesa().make_current(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1) == GL_FALSE) {
      osmesa().destroy_context(context_);
      throw Error(ExitCode::no_gl, "OSMesa: the context cannot be used");
    }
    initialise(osmesa().get_proc_address, "OSMesa");
  }

  ~OsMesaContext() override {
    release_programs();
    osmesa().destroy_context(context_);
  }

 private:
  void* context_ = nullptr;
  std::array<std::uint8_t, 4> pixel_{};  // the default framebuffer, which is not used
};

}  // namespace

std::unique_ptr<Context> open_osmesa() { return std::make_unique<OsMesaContext>(); }

}  // namespace binosplat::gl
