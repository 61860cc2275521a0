#pragma once
// An OpenGL 4.5 core context, without a window or the caller's own. It owns the entry points, limits,
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

/// The source of a context. `automatic` takes the first GPU of EGL's device platform, else Mesa's surfaceless
/// platform (software: llvmpipe), else OSMesa, Mesa as a library (also llvmpipe, without EGL). None of them
/// needs a display server.
///
/// Contexts of both libraries may exist in one process. Both libraries then draw with the context that was
/// last made current; opening does so, too.
enum class Backend { automatic, device, surfaceless, osmesa };

/// Storage blocks of binosplat's largest shader, and the bindings that all shaders use, from 0 on.
constexpr std::uint32_t storage_blocks_needed = 13;
constexpr std::uint32_t storage_bindings_needed = 14;

struct Limits {
  std::int64_t storage_block_bytes = 0;  // largest storage binding that is safe on this driver
  std::uint32_t groups = 0;              // work groups of one dispatch along x
  std::uint32_t invocations = 0;         // of one work group
  std::uint32_t storage_blocks = 0;      // of one compute shader
  std::int64_t shared_bytes = 0;         // of one work group
  std::uint32_t program_binaries = 0;    // formats; 0: programs cannot be stored
  std::uint32_t timestamp_bits = 0;      // 0: stages cannot be timed
  /// Whether programs may use subgroups of 32 invocations (gl/subgroups.h), and why not.
  bool subgroups_of_32 = false;
  std::string why_no_subgroups;
};

/// Removes environment variables that make Mesa report other extensions or another GLSL than it has; users
/// set them for other programs. Warns of each. Call it before opening a context.
void ignore_overrides();

class Context {
 public:
  /// Opens a context and makes it current. `device` indexes EGL's devices (only for Backend::device and
  /// automatic; -1: the first GPU). Throws Error(no_gl) that lists the attempts and what to install.
  static std::unique_ptr<Context> open(Backend backend = Backend::automatic, int device = -1);

  /// The number of devices of EGL's device platform, including software; 0 without that platform. Throws
  /// Error(no_gl) without EGL.
  static int device_count();

  /// Wraps the caller's current context, of 4.5 core or later. It stays the caller's, and its state is
  /// unchanged. It must be current whenever objects of the result are used or destroyed. Takes its recorded
  /// errors, and logs them as warnings. Throws Error(no_gl) that names what it lacks.
  static std::unique_ptr<Context> adopt(GetProcAddress get_proc_address);

  /// Throws Error(no_gl) unless the adopted context is current on this thread. If no library reports the
  /// current context, accepts any.
  void check_current() const;
  bool another_is_current() const;

  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Functions& gl() const { return functions_; }
  const Limits& limits() const { return limits_; }
  /// Limits the groups of a dispatch along x; tests lower it to split dispatches.
  void limit_groups(std::uint32_t groups) { limits_.groups = groups; }
  /// Whether programs may use subgroups, if available; tests turn them off.
  void use_subgroups(bool use) { limits_.subgroups_of_32 = use && limits_.why_no_subgroups.empty(); }

  const std::string& backend() const { return backend_; }    // "EGL device 0", "OSMesa", "caller's"
  const std::string& renderer() const { return renderer_; }  // GL_RENDERER
  const std::string& version() const { return version_; }    // GL_VERSION
  bool software() const;                                     // llvmpipe

  /// Returns the program of a shader file in a variant; compiles it at first use.
  const Program& program(std::string_view name, std::span<const Number> variant = {});
  const Program& program(std::string_view name, const Number& variant) {
    return program(name, {&variant, 1});
  }
  /// The same for a variant that is a struct with numbers().
  template <typename Variant>
  requires requires(const Variant& variant) { variant.numbers(); }
  const Program& program(std::string_view name, const Variant& variant) {
    const auto numbers = variant.numbers();
    return program(name, std::span<const Number>(numbers));
  }
  /// Calls `record`, and compiles all programs that it requests before it returns: drivers can then compile
  /// them in parallel. Dispatchers run nothing meanwhile (dispatch.h).
  void prepare(const std::function<void()>& record);
  /// The number of programs that were compiled, or loaded from the cache, so far.
  int programs_made() const { return programs_made_; }
  /// The time that this took, in ms.
  double compile_ms() const { return compile_ms_; }
  bool is_preparing() const { return is_preparing_; }

  /// From now on reads shaders from this folder; empty: the embedded ones.
  void set_shader_folder(const std::filesystem::path& folder);
  /// From now on stores compiled programs in this folder; empty: nowhere. The default is
  /// ProgramCache::default_folder().
  void set_program_cache(const std::filesystem::path& folder);
  const ProgramCache& program_cache() const { return *program_cache_; }

  /// The GPU's clock, once it has received all earlier commands. Stages are timed by this clock.
  std::int64_t gpu_time_ns() const;

  /// Bytes in buffers, now and at their peak; buffers report their sizes to count_allocation().
  std::int64_t allocated_bytes() const { return allocated_; }
  std::int64_t peak_bytes() const { return peak_; }
  void count_allocation(std::int64_t bytes);

  /// Returns and clears the recorded GL errors, oldest first. Before drawing, they are the caller's.
  std::vector<GLenum> take_errors() const;

  /// Throws Error(no_gl) if the GPU was reset, after which no object on it is usable. Drivers report it only
  /// to contexts that requested it, such as the preview's.
  void check_alive() const;

  /// Throws as check_alive() does, Error(out_of_memory) for GL_OUT_OF_MEMORY, and std::runtime_error, which
  /// names `what`, for another recorded GL error.
  void check(const std::string& what) const;

 protected:
  Context() = default;
  /// `own`: only this object sets the context's state, such as the debug callback.
  void initialise(GetProcAddress get_proc_address, std::string backend, bool own = true);
  /// For a destructor that ends the context: destroys the programs first.
  void release_programs() { programs_.clear(); }

 private:
  using Variants = std::map<std::uint64_t, Program>;  // by key_of()
  void read_limits();
  void complete(Variants& variants, Variants::iterator program);

  Functions functions_;
  void* (*current_handle_)() = nullptr;  // EGL's, OSMesa's or glX's; null: unknown
  void* handle_ = nullptr;               // its result for an adopted context
  Limits limits_;
  std::string backend_, vendor_, renderer_, version_;
  std::filesystem::path shader_folder_;
  std::unique_ptr<ProgramCache> program_cache_;
  std::map<std::string, Variants, std::less<>> programs_;  // by shader
  bool is_preparing_ = false;
  int programs_made_ = 0;
  double compile_ms_ = 0.0;
  std::int64_t allocated_ = 0, peak_ = 0;
};

}  // namespace binosplat::gl
