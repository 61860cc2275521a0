#pragma once
// Faults planted in shaders.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "gl/shader_source.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::test {

/// While it lives, new programs of gl_context() are made of the built-in shaders with a fault in place of
/// `sought`, which must stand in the shader `name` and in no other.
class FaultyShaders {
 public:
  FaultyShaders(const std::string& name, const std::string& sought, const std::string& fault) {
    for (const auto& [other, text] : gl::embedded_shaders()) {
      std::string faulty = text;
      const std::size_t at = faulty.find(sought);
      EXPECT_EQ(at != std::string::npos, other == name) << other;
      if (at != std::string::npos) faulty.replace(at, sought.size(), fault);
      std::filesystem::create_directories((folder_ / other).parent_path());
      write_text(folder_ / other, faulty);
    }
    gl_context().set_shader_folder(folder_.path());
  }
  ~FaultyShaders() { gl_context().set_shader_folder({}); }
  FaultyShaders(const FaultyShaders&) = delete;
  FaultyShaders& operator=(const FaultyShaders&) = delete;

 private:
  TempFolder folder_;
};

}  // namespace binosplat::test
