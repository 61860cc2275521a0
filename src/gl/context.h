#pragma once
// An OpenGL 4.5 core context: opened without a window, or the caller's. Holds the entry points, limits,
// compiled programs and the count of allocated memory.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gl/functions.h"
#include "gl/program.h"
#include "gl/variant.h"

namespace binosplat::gl {

/// The source of a context; none needs a display server. `automatic` takes the first that works: the first
/// GPU of EGL's device platform, Mesa's surfaceless platform (llvmpipe in software), OSMesa (llvmpipe without
/// EGL). EGL's and OSMesa's contexts may exist in one process. Opening a context makes it current, and GL
/// calls go to the context that was last made current.
enum class Backend { automatic, device, surfaceless, osmesa };

/// The number of storage blocks in binosplat's largest shader. Its shaders together use the storage bindings
/// from 0 to storage_bindings_needed - 1.
constexpr std::uint32_t storage_blocks_needed = 13;
constexpr std::uint32_t storage_bindings_needed = 14;

struct Limits {
  std::int64_t storage_block_bytes = 0;  // size of the largest storage binding that works on this driver
  std::uint32_t groups = 0;              // work groups of one dispatch along x
  std::uint32_t invocations = 0;         // of one work group
  std::uint32_t storage_blocks = 0;      // of one compute shader
  std::int64_t shared_bytes = 0;         // of one work group
  std::uint32_t program_binaries = 0;    // number of binary formats; 0: programs cannot be stored
  std::uint32_t timestamp_bits = 0;      // of GL_TIMESTAMP; 0: stages cannot be timed
  /// Whether programs may use subgroups of 32 invocations (gl/subgroups.h), and if not, the reason.
  bool subgroups_of_32 = false;
  std::string why_no_subgroups;
};

/// Removes environment variables with which Mesa reports extensions or a GLSL version that it lacks. Users
/// set them for other programs. Logs a warning for each. Call it before opening a context.
void ignore_overrides();

class Context {
 public:
  /// Opens a context and makes it current. `device` is an index into EGL's devices, -1 the first GPU. Only
  /// Backend::device and automatic use it; with an index, automatic tries only the device platform. Throws
  /// Error(no_gl) that lists the attempts and what to install.
  static std::unique_ptr<Context> open(Backend backend = Backend::automatic, int device = -1);

  /// The number of EGL's devices, including software; 0 without the device platform. Without EGL, throws
  /// Error(no_gl).
  static int device_count();

  /// Wraps the caller's current context, of 4.5 core or later, and leaves its state unchanged. The context
  /// must be current whenever the result, or an object made with it, is used or destroyed. Logs and clears
  /// the GL errors that the context has recorded. Throws Error(no_gl) that names what the context lacks.
  static std::unique_ptr<Context> adopt(GetProcAddress get_proc_address);

  /// Throws Error(no_gl) unless the adopted context is current on this thread. If neither EGL, GLX nor OSMesa
  /// reports the current context, any context passes.
  void check_current() const;
  bool another_is_current() const;

  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Functions& gl() const { return functions_; }
  const Limits& limits() const { return limits_; }
  /// Sets the largest number of work groups along x. Tests lower it, so that dispatches are split.
  void limit_groups(std::uint32_t groups) { limits_.groups = groups; }
  /// Allows programs to use subgroups, if available. Tests turn subgroups off.
  void use_subgroups(bool use) { limits_.subgroups_of_32 = use && limits_.why_no_subgroups.empty(); }

  const std::string& backend() const { return backend_; }    // "EGL device 0", "OSMesa", "caller's"
  const std::string& renderer() const { return renderer_; }  // GL_RENDERER
  const std::string& version() const { return version_; }    // GL_VERSION
  bool software() const;                                     // llvmpipe

  /// Returns the program of a shader file in a variant; loads or compiles it at first use.
  const Program& program(std::string_view name, std::span<const Number> variant = {});
  const Program& program(std::string_view name, const Number& variant) {
    return program(name, {&variant, 1});
  }
  template <typename Variant>
  requires requires(const Variant& variant) { variant.numbers(); }
  const Program& program(std::string_view name, const Variant& variant) {
    const auto numbers = variant.numbers();
    return program(name, std::span<const Number>(numbers));
  }
  /// Calls `record`. Once `record` has returned, completes all programs that it has requested, so that
  /// drivers can compile them in parallel. During this call dispatchers run nothing (dispatch.h).
  void prepare(const std::function<void()>& record);
  /// The number of programs that have been compiled or loaded from the cache.
  int program_count() const { return program_count_; }
  /// The time spent on compiling and loading programs, in ms.
  double compile_ms() const { return compile_ms_; }
  bool is_preparing() const { return is_preparing_; }

  /// Reads shaders from this folder from now on; empty: uses the embedded shaders.
  void set_shader_folder(const std::filesystem::path& folder);
  /// Stores compiled programs here from now on; empty: none. Default: ProgramCache::default_folder().
  void set_program_cache(const std::filesystem::path& folder);
  const ProgramCache& program_cache() const { return *program_cache_; }

  /// Returns the GPU's clock after all earlier commands have reached the GPU. Stages are timed by this clock.
  std::int64_t gpu_time_ns() const;

  /// Bytes in buffers, now and at their peak; buffers report their sizes to count_allocation().
  std::int64_t allocated_bytes() const { return allocated_; }
  std::int64_t peak_bytes() const { return peak_; }
  void count_allocation(std::int64_t bytes);

  /// Returns and clears the recorded GL errors, oldest first. If called before binosplat draws, they are
  /// errors of the caller.
  std::vector<GLenum> take_errors() const;

  /// Throws Error(no_gl) if the GPU was reset: all objects on it are then lost. Drivers report resets only to
  /// contexts that were created with reset notification, such as the preview's.
  void check_alive() const;

  /// If a GL error is recorded, throws: as check_alive() does, Error(out_of_memory) for GL_OUT_OF_MEMORY, or
  /// std::runtime_error. Texts of the last two name the action `what`.
  void check(const std::string& what) const;

 protected:
  Context() = default;
  /// `own`: the context is not the caller's, so this object may set its state, such as the debug callback.
  void initialise(GetProcAddress get_proc_address, std::string backend, bool own = true);
  /// Destroys the programs. A derived class calls it before it destroys the context.
  void release_programs() { programs_.clear(); }

 private:
  using Variants = std::map<std::uint64_t, Program>;  // the key is key_of() of variant.h
  void read_limits();
  void complete(Variants& variants, Variants::iterator program);

  Functions functions_;
  void* (*current_handle_)() = nullptr;  // returns the current context of EGL, GLX or OSMesa; null: unknown
  void* handle_ = nullptr;               // result of current_handle_() when the context was adopted
  Limits limits_;
  std::string backend_, vendor_, renderer_, version_;
  std::filesystem::path shader_folder_;
  std::unique_ptr<ProgramCache> program_cache_;
  std::map<std::string, Variants, std::less<>> programs_;  // by shader file
  bool is_preparing_ = false;
  int program_count_ = 0;
  double compile_ms_ = 0.0;
  std::int64_t allocated_ = 0, peak_ = 0;
};

}  // namespace binosplat::gl
