#pragma once
// Compiles shaders with Khronos's reference compiler.

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "gl/shader_source.h"
#include "support/program.h"

namespace binosplat::test {

inline bool has_glslang() { return std::system("command -v glslangValidator > /dev/null") == 0; }

/// Shaders for one run of Khronos's reference compiler, since its start takes long.
class CompiledShaders {
 public:
  void add(const std::string& name, const gl::Defines& defines, const std::filesystem::path& shaders = {}) {
    write_text(folder_ / (std::to_string(names_.size()) + ".comp"),
               gl::ShaderSource(name, defines, shaders).text());
    names_.push_back(name);
    for (const auto& [define, value] : defines) names_.back() += " " + define + "=" + value;
  }

  /// Returns the compiler's errors with the shaders' names; empty if all shaders compile.
  std::string errors() const {
    const std::string said = folder_ / "said";
    const std::string command = "cd " + folder_.path().string() + " && glslangValidator *.comp > said";
    if (std::system(command.c_str()) == 0) return "";
    std::string errors, file;
    std::istringstream lines(read_text(said));
    for (std::string line; std::getline(lines, line);) {
      if (line.ends_with(".comp")) file = line;
      if (line.starts_with("ERROR")) errors += names_.at(std::stoul(file)) + ": " + line + "\n";
    }
    return errors.empty() ? read_text(said) : errors;
  }

 private:
  TempFolder folder_;
  std::vector<std::string> names_;
};

}  // namespace binosplat::test
