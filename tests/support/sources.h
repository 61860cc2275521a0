#pragma once
// The sources of this tree, for the tests that read them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

namespace binosplat::test {

using Sources = std::map<std::string, std::string>;  // path below the root of the tree -> text

/// Those in the folders, or in as many of them as there are, whose names end as `extensions` say.
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
