#pragma once
// An OpenGL 4.5 core context without a window, or a caller's own, and everything that belongs to it: entry
// points, limits, compiled programs, memory taken.

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

/// Where a context comes from. `automatic` takes the first GPU that EGL's device platform offers, else Mesa's
/// surfaceless platform (software: llvmpipe), else Mesa as a library, OSMesa (llvmpipe, too, without EGL).
/// None of them needs a display server.
///
/// Contexts of both libraries may live in one process; the last one made current, which opening does, is the
/// one that both libraries draw with.
enum class Backend { automatic, device, surfaceless, osmesa };

/// Storage blocks that binosplat's largest shader uses, and the bindings that all use, from 0 on.
constexpr std::uint32_t storage_blocks_needed = 13;
constexpr std::uint32_t storage_bindings_needed = 14;

struct Limits {
  std::int64_t storage_block_bytes = 0;  // largest binding of a storage buffer that is safe on this driver
  std::uint32_t groups = 0;              // work groups of one dispatch along x
  std::uint32_t invocations = 0;         // of one work group
  std::uint32_t storage_blocks = 0;      // of one compute shader
  std::int64_t shared_bytes = 0;         // of one work group
  std::uint32_t program_binaries = 0;    // formats; 0: programs cannot be kept
  std::uint32_t timestamp_bits = 0;      // 0: stages cannot be timed
  /// Whether programs may use subgroups of 32 invocations, as found by gl/subgroups.h, and why not.
  bool subgroups_of_32 = false;
  std::string why_no_subgroups;
};

/// Takes variables out of the environment that make Mesa report extensions and a GLSL other than it has,
/// which some set for other programs; warns of each. Call it before a context is made.
void ignore_overrides();

class Context {
 public:
  /// Opens and makes current. `device` counts EGL's devices (only for Backend::device and automatic; -1: the
  /// first GPU). Throws Error(no_gl) that lists what was tried and what to install.
  static std::unique_ptr<Context> open(Backend backend = Backend::automatic, int device = -1);

  /// How many devices EGL's device platform lists, software ones included; 0 where it has no such platform.
  /// Throws Error(no_gl) without EGL.
  static int device_count();

  /// Wraps a context of the caller's that is current, 4.5 core or later; it stays the caller's, its state is
  /// left as it is, and it must be current whenever what is made with the result is used or destroyed. Errors
  /// that it has recorded are told as warnings, and taken. Throws Error(no_gl) that says what it lacks.
  static std::unique_ptr<Context> adopt(GetProcAddress get_proc_address);

  /// Throws Error(no_gl) unless the context that was adopted is current on this thread. Where no library
  /// tells which one is, any will do.
  void check_current() const;
  bool another_is_current() const;

  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Functions& gl() const { return functions_; }
  const Limits& limits() const { return limits_; }
  /// Largest group count that a dispatch may use along x; a test may lower it to see dispatches split.
  void limit_groups(std::uint32_t groups) { limits_.groups = groups; }
  /// Whether programs may use subgroups, if there are any; a test may see what is drawn without them.
  void use_subgroups(bool use) { limits_.subgroups_of_32 = use && limits_.why_no_subgroups.empty(); }

  const std::string& backend() const { return backend_; }    // "EGL device 0", "OSMesa", "caller's"
  const std::string& renderer() const { return renderer_; }  // GL_RENDERER
  const std::string& version() const { return version_; }    // GL_VERSION
  bool software() const;                                     // llvmpipe

  /// The program of a shader file in a variant, compiled at first use.
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
  /// Calls `record` for the programs that it asks for, which are made when this returns: drivers that can
  /// compile them all at once. Dispatchers run nothing meanwhile (dispatch.h).
  void prepare(const std::function<void()>& record);
  /// How many programs were compiled, or loaded from the cache, so far.
  int programs_made() const { return programs_made_; }
  /// What that took, in ms.
  double making_ms() const { return making_ms_; }
  bool is_preparing() const { return is_preparing_; }

  /// Shaders are read from this folder from now on; empty: the embedded ones.
  void set_shader_folder(const std::filesystem::path& folder);
  /// Compiled programs are kept in this folder from now on; empty: nowhere. At first it is
  /// ProgramCache::default_folder().
  void set_program_cache(const std::filesystem::path& folder);
  const ProgramCache& program_cache() const { return *program_cache_; }

  /// What the GPU's clock says once it has what was handed to it so far; stages are timed by this clock.
  std::int64_t gpu_time_ns() const;

  /// Bytes in buffers now and at most; buffers report here.
  std::int64_t allocated_bytes() const { return allocated_; }
  std::int64_t peak_bytes() const { return peak_; }
  void count_allocation(std::int64_t bytes);

  /// GL errors recorded before this call, oldest first; where it is called before drawing they are the
  /// caller's.
  std::vector<GLenum> take_errors() const;

  /// Throws Error(no_gl) if the GPU was reset, after which nothing that was on it can be used. Drivers tell
  /// it contexts that asked to be told, as the preview's does.
  void check_alive() const;

  /// Throws as check_alive() does, std::runtime_error naming `what` if GL has recorded an error,
  /// Error(out_of_memory) for GL_OUT_OF_MEMORY.
  void check(const std::string& what) const;

 protected:
  Context() = default;
  /// `own`: nobody else sets its state, such as who hears of its errors.
  void initialise(GetProcAddress get_proc_address, std::string backend, bool own = true);
  /// For a destructor that ends the context: programs go before it.
  void release_programs() { programs_.clear(); }

 private:
  using Variants = std::map<std::uint64_t, Program>;  // by key_of()
  void read_limits();
  void complete(Variants& variants, Variants::iterator program);

  Functions functions_;
  void* (*current_handle_)() = nullptr;  // EGL's, OSMesa's or glX's; null: not known
  void* handle_ = nullptr;               // what that gives of an adopted context
  Limits limits_;
  std::string backend_, vendor_, renderer_, version_;
  std::filesystem::path shader_folder_;
  std::unique_ptr<ProgramCache> program_cache_;
  std::map<std::string, Variants, std::less<>> programs_;  // by shader
  bool is_preparing_ = false;
  int programs_made_ = 0;
  double making_ms_ = 0.0;
  std::int64_t allocated_ = 0, peak_ = 0;
};

}  // namespace binosplat::gl
