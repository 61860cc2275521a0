#include "gl/shader_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "base/error.h"

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
    if (!file) fail("{}: no such shader, wanted by {}", (folder_ / name).string(), from);
    std::ostringstream body;
    body << file.rdbuf();
    return body.str();
  }
  const auto found = embedded_shaders().find(name);
  if (found == embedded_shaders().end()) fail("no shader named {}, wanted by {}", name, from);
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
  static const std::regex place(R"((^|\n|ERROR: )(\d+)[:(](\d+)\)?)");
  std::string out;
  auto at = log.cbegin();
  for (std::sregex_iterator m(log.begin(), log.end(), place), end; m != end; ++m) {
    out.append(at, (*m)[0].first);
    const std::size_t file = std::stoul((*m)[2].str());
    out += (*m)[1].str() + (file < files_.size() ? files_[file] : (*m)[2].str()) + ":" + (*m)[3].str();
    at = (*m)[0].second;
  }
  out.append(at, log.cend());
  return out;
}

}  // namespace binosplat::gl
