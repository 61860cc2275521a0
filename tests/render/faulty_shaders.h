#pragma once
// Injects faults into shaders.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "gl/shader_source.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::test {

/// A text that occurs only in the shader `name`, and the text that replaces it.
struct ShaderFault {
  std::string name, sought, fault;
};

/// While this object lives, gl_context() builds new programs from the built-in shaders with these faults.
class FaultyShaders {
 public:
  explicit FaultyShaders(const std::vector<ShaderFault>& faults) {
    for (const auto& [name, text] : gl::embedded_shaders()) {
      std::string faulty = text;
      for (const ShaderFault& f : faults) {
        const std::size_t at = faulty.find(f.sought);
        EXPECT_EQ(at != std::string::npos, name == f.name) << name << ": " << f.sought;
        if (at != std::string::npos) faulty.replace(at, f.sought.size(), f.fault);
      }
      std::filesystem::create_directories((folder_ / name).parent_path());
      write_text(folder_ / name, faulty);
    }
    gl_context().set_shader_folder(folder_.path());
  }
  FaultyShaders(const std::string& name, const std::string& sought, const std::string& fault)
      : FaultyShaders(std::vector{ShaderFault{name, sought, fault}}) {}
  ~FaultyShaders() { gl_context().set_shader_folder({}); }
  FaultyShaders(const FaultyShaders&) = delete;
  FaultyShaders& operator=(const FaultyShaders&) = delete;

 private:
  TempFolder folder_;
};

}  // namespace binosplat::test
