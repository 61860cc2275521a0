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
  return table;
}

}  // namespace binosplat::gl
