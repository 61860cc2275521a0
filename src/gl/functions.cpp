#include "gl/functions.h"

#include "base/error.h"

namespace binosplat::gl {

namespace {

// Checks the version before functions are loaded: an older context lacks some, and an error about the first
// missing function would not name the cause.
void check_version(GetProcAddress get_proc_address) {
  if (get_proc_address == nullptr)
    fail("get_proc_address is null: expected a function such as eglGetProcAddress");
  const auto get_string = reinterpret_cast<PFNGLGETSTRINGPROC>(get_proc_address("glGetString"));
  if (get_string == nullptr) {
    throw Error(ExitCode::no_gl,
                "get_proc_address finds no glGetString: expected a function such as eglGetProcAddress that "
                "works in the current context");
  }
  const auto text = [&](GLenum name) {
    const auto* const found = reinterpret_cast<const char*>(get_string(name));
    return std::string_view(found == nullptr ? "" : found);
  };
  const std::string_view version = text(GL_VERSION);
  if (version.empty()) throw Error(ExitCode::no_gl, no_context);
  // The text is "4.6.0 DRIVER" or "OpenGL ES 3.2 DRIVER".
  const bool is_es = version.starts_with("OpenGL ES");
  if (!is_es && version >= "4.5") return;
  throw Error(
      ExitCode::no_gl,
      fmt::format("the current context has {}{} ({}): binosplat needs OpenGL 4.5 core or later{}",
                  is_es ? "" : "OpenGL ", version, text(GL_RENDERER), is_es ? ", not OpenGL ES" : ""));
}

}  // namespace

Functions load_functions(GetProcAddress get_proc_address) {
  check_version(get_proc_address);
  Functions table;
#define BINOSPLAT_GL_LOAD(name, upper)                                                               \
  table.name = reinterpret_cast<PFNGL##upper##PROC>(get_proc_address("gl" #name));                   \
  if (table.name == nullptr) {                                                                       \
    throw Error(ExitCode::no_gl, "this OpenGL has no gl" #name ": binosplat needs OpenGL 4.5 core"); \
  }
  BINOSPLAT_GL_FUNCTIONS(BINOSPLAT_GL_LOAD)
#undef BINOSPLAT_GL_LOAD
  table.MaxShaderCompilerThreadsKHR = reinterpret_cast<PFNGLMAXSHADERCOMPILERTHREADSKHRPROC>(
      get_proc_address("glMaxShaderCompilerThreadsKHR"));
  table.GetUnsignedBytei_vEXT =
      reinterpret_cast<Functions::GetBytes>(get_proc_address("glGetUnsignedBytei_vEXT"));
  return table;
}

bool has_extension(const Functions& gl, std::string_view name) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* found = reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (found != nullptr && name == found) return true;
  }
  return false;
}

}  // namespace binosplat::gl
