#pragma once
// A compiled compute shader, or fragment and vertex shader, and the names of its blocks and uniforms.

#include <cstdint>
#include <string>
#include <vector>

#include "gl/functions.h"
#include "gl/program_cache.h"
#include "gl/shader_source.h"

namespace binosplat::gl {

class Program {
 public:
  struct Block {
    std::string name;
    std::uint32_t binding;
    GLenum target;  // GL_SHADER_STORAGE_BUFFER or GL_UNIFORM_BUFFER
  };

  struct Uniform {
    std::string name;
    std::int32_t location;
  };

  /// Loads the program from the cache, or starts to compile and link it; drivers may compile several at once.
  /// `name` is a shader file. NAME.frag is linked with NAME.vert, or with fullscreen.vert if there is none.
  Program(const Functions& gl, const std::string& name, const Defines& defines,
          const std::filesystem::path& folder, const ProgramCache& cache);
  ~Program();

  /// Waits for compiler and linker, stores the binary in the cache, and reads the names of blocks and
  /// uniforms. Call it before using the program. If compiling or linking fails, throws Error(no_gl) with the
  /// driver's log, whose places are converted to file:line.
  void complete(const ProgramCache& cache);
  bool is_complete() const { return is_complete_; }
  /// Whether the program is compiled because the cache lacked it. Valid until complete().
  bool is_compiled() const { return !shaders_.empty(); }

  Program(Program&& other) noexcept;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  Program& operator=(Program&&) = delete;

  std::uint32_t id() const { return id_; }
  const std::string& name() const { return name_; }
  std::uint32_t local_size() const { return local_size_; }      // invocations of a work group; 1 for .frag
  const std::vector<Block>& blocks() const { return blocks_; }  // only blocks that the shader uses
  const std::vector<Uniform>& uniforms() const { return uniforms_; }  // only used uints outside of blocks

 private:
  /// A shader that the driver is compiling.
  struct Shader {
    std::uint32_t id = 0;
    ShaderSource source;
  };

  void check_compiled(const Shader& shader);
  void check_linked();
  [[noreturn]] void refuse(const char* what, const std::string& log, const ShaderSource& source);
  void read_local_size();
  void reflect();

  const Functions* gl_;
  std::string name_;
  std::string text_;  // source of all shaders; the cache's key; empty once complete
  std::uint32_t id_ = 0;
  std::vector<Shader> shaders_;  // empty once complete, or if the cache had the program
  bool is_complete_ = false;
  std::uint32_t local_size_ = 1;
  std::vector<Block> blocks_;
  std::vector<Uniform> uniforms_;
};

}  // namespace binosplat::gl
