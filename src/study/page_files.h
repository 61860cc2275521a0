#pragma once
// The files that the page is put together from, as they were at build time (cmake/embed.cmake), by their
// path.

#include <map>
#include <string>

namespace binosplat::study {

const std::map<std::string, std::string>& page_files();         // below src/study/page
const std::map<std::string, std::string>& third_party_files();  // below third_party

}  // namespace binosplat::study
