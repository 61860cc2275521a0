#include "gl/shader_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::gl {

ShaderSource::ShaderSource(const std::string& name, const Defines& defines,
                           const std::filesystem::path& folder)
    : defines_(defines), folder_(folder) {
  text_ = "#version 450 core\n";
  for (const auto& [key, value] : defines) text_ += fmt::format("#define {} {}\n", key, value);
  append(name, "the program");
}

std::string ShaderSource::read(const std::string& name, const std::string& from) const {
  if (!folder_.empty()) {
    std::ifstream file(folder_ / name);
    if (!file) fail("{}: no such shader, required by {}", (folder_ / name).string(), from);
    std::ostringstream body;
    body << file.rdbuf();
    return body.str();
  }
  const auto found = embedded_shaders().find(name);
  if (found == embedded_shaders().end()) fail("no shader named {}, required by {}", name, from);
  return found->second;
}

std::string ShaderSource::filled(std::string path) const {
  for (const auto& [key, value] : defines_) {
    const std::size_t at = path.find("{" + key + "}");
    if (at != std::string::npos) path.replace(at, key.size() + 2, value);
  }
  return path;
}

void ShaderSource::append(const std::string& name, const std::string& from) {
  if (std::find(files_.begin(), files_.end(), name) != files_.end()) return;
  const std::size_t number = files_.size();
  files_.push_back(name);
  std::istringstream body(read(name, from));
  text_ += fmt::format("#line 1 {}\n", number);
  std::string line;
  for (int at = 1; std::getline(body, line); ++at) {
    if (line.rfind("#include \"", 0) == 0) {
      const std::size_t end = line.find('"', 10);
      append(filled(line.substr(10, end - 10)), fmt::format("{}:{}", name, at));
      text_ += fmt::format("#line {} {}\n", at + 1, number);
    } else {
      text_ += line + "\n";
    }
  }
}

std::string ShaderSource::with_file_names(const std::string& log) const {
  std::string out;
  for (std::string_view rest = log; !rest.empty();) {
    // Replaces a place of the form FILE:LINE or FILE(LINE) at the begin of a line.
    std::string_view after = rest;
    const bool may_be_place = out.empty() || out.ends_with('\n') || out.ends_with("ERROR: ");
    const auto file = may_be_place ? take_number(after) : std::nullopt;
    if (file && *file < files_.size() && (after.starts_with(':') || after.starts_with('('))) {
      after.remove_prefix(1);
      if (const auto line = take_number(after)) {
        out += fmt::format("{}:{}", files_[*file], *line);
        rest = after.starts_with(')') ? after.substr(1) : after;
        continue;
      }
    }
    out += rest.front();
    rest.remove_prefix(1);
  }
  return out;
}

}  // namespace binosplat::gl
