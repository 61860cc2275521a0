#include "gl/context.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/thread_spans.h"
#include "gl/backends.h"
#include "gl/subgroups.h"

namespace binosplat::gl {

namespace {

void APIENTRY on_message(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message, const void*) {
  if (type == GL_DEBUG_TYPE_ERROR) log_warning("OpenGL: {}", message);
}

std::string text(const Functions& gl, GLenum name) {
  const auto* value = reinterpret_cast<const char*>(gl.GetString(name));
  return value == nullptr ? "" : value;
}

// Calls `open`. If it throws Error(no_gl), appends the reason to `reasons` and returns null.
template <typename Open>
std::unique_ptr<Context> attempt(const Open& open, std::string& reasons) {
  try {
    return open();
  } catch (const Error& error) {
    if (error.code() != ExitCode::no_gl) throw;
    const std::string reason = fmt::format("\n  {}", error.what());
    if (!reasons.ends_with(reason)) reasons += reason;  // two backends may lack the same library
    return nullptr;
  }
}

/// Returns the function that returns the current context, from the library that made it current; null:
/// unknown. get_proc_address would not help: GLX's and EGL's return a pointer even for unknown names.
void* (*find_current_handle())() {
  struct Source {
    const char *library, *function;
  };
  for (const Source& source :
       {Source{"libEGL.so.1", "eglGetCurrentContext"}, Source{"libGLX.so.0", "glXGetCurrentContext"},
        Source{"libGL.so.1", "glXGetCurrentContext"}, Source{"libOSMesa.so.8", "OSMesaGetCurrentContext"}}) {
    void* const library = dlopen(source.library, RTLD_LAZY | RTLD_NOLOAD);  // only if already loaded
    if (library == nullptr) continue;
    const auto found = reinterpret_cast<void* (*)()>(dlsym(library, source.function));
    if (found != nullptr && found() != nullptr) return found;
  }
  return nullptr;
}

}  // namespace

void fail_to_load(const char* library, const char* what_to_install) {
  const std::string why = dlerror();
  for (const char* no_room : {"failed to map segment", "annot allocate memory"}) {
    if (why.find(no_room) != std::string::npos)
      throw Error(ExitCode::out_of_memory, fmt::format("out of memory: no room for OpenGL: {}", why));
  }
  throw Error(ExitCode::no_gl, fmt::format("{}: {}. {}", library, why, what_to_install));
}

void ignore_overrides() {
  for (const char* name : {"MESA_EXTENSION_OVERRIDE", "MESA_GLSL_VERSION_OVERRIDE"}) {
    const char* const value = std::getenv(name);
    if (value == nullptr) continue;
    log_warning("{}={} makes Mesa report features that it lacks: ignored", name, value);
    unsetenv(name);
  }
}

std::unique_ptr<Context> Context::open(Backend backend, int device) {
  ignore_overrides();
  const auto tries = [&](Backend one) {
    return backend == one || (backend == Backend::automatic && (device < 0 || one == Backend::device));
  };
  std::string reasons;
  std::unique_ptr<Context> context;
  if (tries(Backend::device)) context = attempt([&] { return open_egl_device(device); }, reasons);
  if (context == nullptr && tries(Backend::surfaceless)) context = attempt(open_egl_surfaceless, reasons);
  if (context == nullptr && tries(Backend::osmesa)) context = attempt(open_osmesa, reasons);
  if (context == nullptr)
    throw Error(ExitCode::no_gl, fmt::format("no usable OpenGL 4.5 context. Tried:{}", reasons));
  return context;
}

void Context::initialise(GetProcAddress get_proc_address, std::string backend, bool own) {
  functions_ = load_functions(get_proc_address);
  if (own) functions_.DebugMessageCallback(on_message, nullptr);
  backend_ = std::move(backend);
  vendor_ = text(functions_, GL_VENDOR);
  renderer_ = text(functions_, GL_RENDERER);
  version_ = text(functions_, GL_VERSION);
  set_program_cache(ProgramCache::default_folder());
  if (own && has_extension(functions_, "GL_KHR_parallel_shader_compile"))
    functions_.MaxShaderCompilerThreadsKHR(
        UINT32_MAX);  // no limit; NVIDIA's driver compiles in parallel only after this call

  read_limits();
  GLint bindings = 0;
  functions_.GetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
  if (limits_.storage_blocks < storage_blocks_needed || bindings < GLint{storage_bindings_needed}) {
    throw Error(ExitCode::no_gl,
                fmt::format("{} offers {} storage blocks to a compute shader and {} bindings for them: "
                            "binosplat needs {} and {}",
                            renderer_, limits_.storage_blocks, bindings, storage_blocks_needed,
                            storage_bindings_needed));
  }
  for (const GLenum error : own ? std::vector<GLenum>() : take_errors())
    log_warning("OpenGL error 0x{:04x} was recorded before binosplat was called: it is the caller's", error);
  limits_.why_no_subgroups = gl::why_no_subgroups(*this);
  use_subgroups(true);
}

void Context::read_limits() {
  const auto integer = [&](GLenum name) {
    int value = 0;
    functions_.GetIntegerv(name, &value);
    return value;
  };
  int groups = 0;
  functions_.GetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  limits_.groups = static_cast<std::uint32_t>(groups);
  limits_.invocations = static_cast<std::uint32_t>(integer(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS));
  limits_.storage_blocks = static_cast<std::uint32_t>(integer(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS));
  limits_.shared_bytes = integer(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
  limits_.program_binaries = static_cast<std::uint32_t>(integer(GL_NUM_PROGRAM_BINARY_FORMATS));
  int bits = 0;
  functions_.GetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  limits_.timestamp_bits = static_cast<std::uint32_t>(bits);
  functions_.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limits_.storage_block_bytes);
  // llvmpipe reports 128 MiB, but 2 GiB work; reads beyond 2 GiB crash. Other drivers get this limit, too.
  const std::int64_t two_gib = std::int64_t{1} << 31;
  limits_.storage_block_bytes = software() ? two_gib : std::min(limits_.storage_block_bytes, two_gib);
}

bool Context::software() const { return renderer_.find("llvmpipe") != std::string::npos; }

std::unique_ptr<Context> Context::adopt(GetProcAddress get_proc_address) {
  std::unique_ptr<Context> context(new Context());
  context->initialise(get_proc_address, "caller's", false);
  context->current_handle_ = find_current_handle();
  if (context->current_handle_ != nullptr) context->handle_ = context->current_handle_();
  return context;
}

void Context::check_current() const {
  if (current_handle_ == nullptr ? functions_.GetString(GL_VERSION) != nullptr : current_handle_() == handle_)
    return;
  if (!another_is_current()) throw Error(ExitCode::no_gl, no_context);
  throw Error(ExitCode::no_gl,
              "another OpenGL context is current on this thread: make the renderer's context current first");
}

bool Context::another_is_current() const {
  const void* const handle = current_handle_ == nullptr ? nullptr : current_handle_();
  return handle != nullptr && handle != handle_;
}

const Program& Context::program(std::string_view name, std::span<const Number> variant) {
  auto of_shader = programs_.find(name);
  if (of_shader == programs_.end()) of_shader = programs_.try_emplace(std::string(name)).first;
  const std::uint64_t key = key_of(variant);
  auto found = of_shader->second.find(key);
  if (found == of_shader->second.end()) {
    const auto begin = Clock::now();
    Program made(functions_, of_shader->first, defines_of(variant), shader_folder_, *program_cache_);
    add_span((made.is_compiled() ? "compile " : "load ") + of_shader->first, begin);
    ++program_count_;
    compile_ms_ += ms_since(begin);
    found = of_shader->second.emplace(key, std::move(made)).first;
  }
  if (!is_preparing_ && !found->second.is_complete()) complete(of_shader->second, found);
  return found->second;
}

void Context::complete(Variants& variants, Variants::iterator program) {
  try {
    const auto begin = Clock::now();
    const bool is_compiled = program->second.is_compiled();
    program->second.complete(*program_cache_);
    compile_ms_ += ms_since(begin);
    if (is_compiled) add_span("compile " + program->second.name(), begin);
  } catch (...) {
    variants.erase(program);
    throw;
  }
}

std::int64_t Context::gpu_time_ns() const {
  std::int64_t ns = 0;
  functions_.GetInteger64v(GL_TIMESTAMP, &ns);
  return ns;
}

void Context::prepare(const std::function<void()>& record) {
  is_preparing_ = true;
  try {
    record();
  } catch (...) {
    is_preparing_ = false;
    throw;
  }
  is_preparing_ = false;
  for (auto& [name, variants] : programs_) {
    for (auto next = variants.begin(); next != variants.end();) {
      const auto program = next++;
      try {
        if (!program->second.is_complete()) complete(variants, program);
      } catch (const Error&) {  // reported when the program is used
      }
    }
  }
}

void Context::set_shader_folder(const std::filesystem::path& folder) {
  shader_folder_ = folder;
  programs_.clear();
}

void Context::count_allocation(std::int64_t bytes) {
  allocated_ += bytes;
  peak_ = std::max(peak_, allocated_);
}

void Context::set_program_cache(const std::filesystem::path& folder) {
  program_cache_ = std::make_unique<ProgramCache>(folder, vendor_ + "\n" + renderer_ + "\n" + version_);
  programs_.clear();
}

std::vector<GLenum> Context::take_errors() const {
  // A lost context may report errors without end.
  constexpr std::size_t most = 16;
  std::vector<GLenum> errors;
  while (errors.size() < most) {
    const GLenum error = functions_.GetError();
    if (error == GL_NO_ERROR) break;
    errors.push_back(error);
  }
  return errors;
}

void Context::check_alive() const {
  const GLenum status = functions_.GetGraphicsResetStatus();
  if (status == GL_NO_ERROR) return;
  const char* const whose = status == GL_GUILTY_CONTEXT_RESET     ? "by this program"
                            : status == GL_INNOCENT_CONTEXT_RESET ? "by another program"
                                                                  : "for a reason unknown to the driver";
  throw Error(
      ExitCode::no_gl,
      fmt::format("the GPU {} was reset {}: its memory is lost; start the program again", renderer_, whose));
}

void Context::check(const std::string& what) const {
  const GLenum error = functions_.GetError();
  if (error == GL_NO_ERROR) return;
  check_alive();
  if (error == GL_OUT_OF_MEMORY) {
    throw Error(
        ExitCode::out_of_memory,
        fmt::format("{}: the GPU is out of memory ({} MiB in use by this program)", what, allocated_ >> 20));
  }
  throw std::runtime_error(fmt::format("{}: OpenGL error 0x{:04x}", what, error));
}

}  // namespace binosplat::gl
