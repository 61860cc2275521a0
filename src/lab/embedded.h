#pragma once
// Files embedded into the program at build time (cmake/embed.cmake), by path.

#include <map>
#include <string>

namespace binosplat::lab {

const std::map<std::string, std::string>& page_files();         // below src/lab/page
const std::map<std::string, std::string>& third_party_files();  // below third_party
const std::map<std::string, std::string>& preset_files();       // below src/lab/presets

}  // namespace binosplat::lab
