#pragma once
// The source files of this repository, for tests that check them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

namespace binosplat::test {

using Sources = std::map<std::string, std::string>;  // path below the root -> text

/// Returns the files in these folders with one of these extensions. Missing folders are ignored.
inline Sources sources_of_tree(const std::set<std::string>& folders,
                               const std::set<std::string>& extensions) {
  namespace fs = std::filesystem;
  Sources sources;
  const fs::path root = BINOSPLAT_SOURCE_DIR;
  for (const std::string& folder : folders) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !extensions.count(entry.path().extension().string())) continue;
      std::ifstream in(entry.path(), std::ios::binary);
      sources[fs::relative(entry.path(), root).generic_string()] =
          std::string(std::istreambuf_iterator<char>(in), {});
    }
  }
  EXPECT_GT(sources.size(), 400u) << "the sources were not found in " << root;
  return sources;
}

}  // namespace binosplat::test
