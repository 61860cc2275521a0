#pragma once
// Only for placed.cpp: records the inputs of --place (base/inputs.h).

#include <filesystem>
#include <string>

#include "base/inputs.h"
#include "formats/files_of_model.h"

namespace binosplat::app {

inline std::string content_key(const std::filesystem::path& path) {
  for (const std::filesystem::path& file : files_of_model(path)) note_input(file);
  return "";
}
inline std::string text_key(const std::string& text) { return text; }
inline std::string file_key(const std::filesystem::path&) { return ""; }

}  // namespace binosplat::app
