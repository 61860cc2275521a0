#include "gl/functions.h"

#include "base/error.h"

namespace binosplat::gl {

Functions load_functions(GetProcAddress get_proc_address) {
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
