#pragma once
// Finds the shared scenes in the folder BINOSPLAT_SCENES, which `scenes/unpack` prints. If the variable is
// not set, tests of real scenes are skipped, or fail if BINOSPLAT_REQUIRE_SCENES=1.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace binosplat::test {

/// Returns the folder of a scene, or an empty path if there is none.
inline std::filesystem::path scene_folder(const std::string& name) {
  const char* scenes = std::getenv("BINOSPLAT_SCENES");
  if (scenes == nullptr || *scenes == '\0') return {};
  std::filesystem::path folder = std::filesystem::path(scenes) / name;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path{};
}

/// Returns whether an environment variable, such as BINOSPLAT_REQUIRE_SCENES or BINOSPLAT_LONG, is 1.
inline bool switched_on(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace binosplat::test

// NOLINTBEGIN(bugprone-macro-parentheses): the name in a declaration takes no parentheses.
/// Declares `path_variable`, the folder of scene `name`. If there is none, skips or fails the test.
#define REQUIRE_SCENE(name, path_variable)                                                      \
  const std::filesystem::path path_variable = ::binosplat::test::scene_folder(name);            \
  if (path_variable.empty()) {                                                                  \
    const std::string missing = std::string("scene ") + (name) +                                \
                                " not found: BINOSPLAT_SCENES is not set to the folder of the " \
                                "unpacked scenes (docs/scenes.md)";                             \
    if (::binosplat::test::switched_on("BINOSPLAT_REQUIRE_SCENES")) FAIL() << missing;          \
    GTEST_SKIP() << missing;                                                                    \
  }                                                                                             \
  static_assert(true)
// NOLINTEND(bugprone-macro-parentheses)
