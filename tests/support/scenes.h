#pragma once
// Where tests find the shared scenes. BINOSPLAT_SCENES names the folder that `scenes/unpack` printed. Without
// it, tests of real scenes are skipped, or fail if BINOSPLAT_REQUIRE_SCENES=1.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace binosplat::test {

/// The folder of a scene, or an empty path if it is not there.
inline std::filesystem::path scene_folder(const std::string& name) {
  const char* scenes = std::getenv("BINOSPLAT_SCENES");
  if (scenes == nullptr || *scenes == '\0') return {};
  std::filesystem::path folder = std::filesystem::path(scenes) / name;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path{};
}

/// Whether an environment variable is set to 1: BINOSPLAT_REQUIRE_SCENES, BINOSPLAT_LONG.
inline bool switched_on(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace binosplat::test

// NOLINTBEGIN(bugprone-macro-parentheses): a name that is declared takes no parentheses.
/// Declares `path_variable`, the folder of scene `name`; skips or fails the test where there is none.
#define REQUIRE_SCENE(name, path_variable)                                                                  \
  const std::filesystem::path path_variable = ::binosplat::test::scene_folder(name);                        \
  if (path_variable.empty()) {                                                                              \
    if (::binosplat::test::switched_on("BINOSPLAT_REQUIRE_SCENES"))                                         \
      FAIL() << "scene " << (name)                                                                          \
             << " not found: set BINOSPLAT_SCENES to the folder of the unpacked scenes";                    \
    GTEST_SKIP() << "scene " << (name) << " not found: BINOSPLAT_SCENES is not set to the unpacked scenes"; \
  }                                                                                                         \
  static_assert(true)
// NOLINTEND(bugprone-macro-parentheses)
