#pragma once
// Finds real files of every format in the folder BINOSPLAT_FORMATS. That folder also has truth.json, with the
// values that an independent decoder read from the files. If the variable is not set, such tests are skipped,
// or fail if BINOSPLAT_REQUIRE_SCENES=1.

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/scenes.h"

namespace binosplat::test {

inline std::filesystem::path fixtures_folder() {
  const char* folder = std::getenv("BINOSPLAT_FORMATS");
  return folder != nullptr && std::filesystem::is_directory(folder) ? folder : "";
}

inline nlohmann::json load_json(const std::filesystem::path& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}

}  // namespace binosplat::test

/// Declares `path_variable`, the folder of the files. If there is none, skips or fails the test.
#define REQUIRE_FIXTURES(path_variable)                                                                   \
  const std::filesystem::path path_variable = ::binosplat::test::fixtures_folder();                       \
  if ((path_variable).empty()) {                                                                          \
    if (::binosplat::test::switched_on("BINOSPLAT_REQUIRE_SCENES"))                                       \
      FAIL() << "files of every format not found: set BINOSPLAT_FORMATS to their folder, scenes/formats"; \
    GTEST_SKIP() << "files of every format not found: BINOSPLAT_FORMATS is not set to their folder";      \
  }                                                                                                       \
  static_assert(true)
