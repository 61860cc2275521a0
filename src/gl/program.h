#pragma once
// A compiled compute shader, or a fragment shader with its vertex shader, and the names of its blocks and
// uniforms.

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

  /// Loads the program from the cache, or starts to compile and link it; drivers may do so for several at
  /// once. A name that ends with .frag is a fragment shader's, linked with the vertex shader of the same
  /// name, or else with whole.vert.
  Program(const Functions& gl, const std::string& name, const Defines& defines,
          const std::filesystem::path& folder, const ProgramCache& cache);
  ~Program();

  /// Waits for compiler and linker, stores the result in the cache, and reads the names. Call it before using
  /// the program. Throws Error(no_gl) with the driver's log, in which places are file:line.
  void complete(const ProgramCache& cache);
  bool is_complete() const { return is_complete_; }
  /// Whether the cache lacked it; valid until it is complete.
  bool is_compiled() const { return !shaders_.empty(); }

  Program(Program&& other) noexcept;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  Program& operator=(Program&&) = delete;

  std::uint32_t id() const { return id_; }
  const std::string& name() const { return name_; }
  std::uint32_t local_size() const { return local_size_; }            // invocations of a work group; 1: none
  const std::vector<Block>& blocks() const { return blocks_; }        // only those that the shader uses
  const std::vector<Uniform>& uniforms() const { return uniforms_; }  // the same, outside blocks

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
  std::string text_;  // of all shaders, until they are compiled
  std::uint32_t id_ = 0;
  std::vector<Shader> shaders_;  // all its shaders, until it is complete
  bool is_complete_ = false;
  std::uint32_t local_size_ = 1;
  std::vector<Block> blocks_;
  std::vector<Uniform> uniforms_;
};

}  // namespace binosplat::gl
