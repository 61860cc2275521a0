// Levels of detail, an inset, meshes and the budget, by what is installed alone.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "support/program.h"

namespace binosplat {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr const char* sanitizers = "-fsanitize=address,undefined";
#else
constexpr const char* sanitizers = "";
#endif

TEST(Install, AnotherProgramDrawsLevelsWithAnInsetAmongMeshes) {
  const test::TempFolder folder;
  const std::string prefix = (folder / "prefix").string(), build = (folder / "build").string(),
                    city = (folder / "city").string();
  const auto shell = [&](const std::string& command) {
    const std::string to = (folder / "said").string();
    return std::system((command + " > " + to + " 2>&1").c_str()) == 0 ? std::string()
                                                                      : test::read_text(folder / "said");
  };
  ASSERT_EQ(shell(std::string("cmake --install ") + BINOSPLAT_BUILD_DIR + " --prefix " + prefix), "");
  // The two lines of docs/embedding.md, and EGL.
  test::write_text(folder / "CMakeLists.txt",
                   "cmake_minimum_required(VERSION 3.25)\nproject(levels LANGUAGES CXX)\n"
                   "find_package(binosplat 0.1 REQUIRED)\nadd_executable(levels " BINOSPLAT_SOURCE_DIR
                   "/tests/install/levels_program.cpp)\n"
                   "target_link_libraries(levels binosplat::binosplat)\n"
                   "target_link_libraries(levels EGL OpenGL)\n");
  ASSERT_EQ(shell("cmake -G Ninja -S " + folder.path().string() + " -B " + build + " -DCMAKE_PREFIX_PATH=" +
                  prefix + " -DCMAKE_CXX_COMPILER=" + BINOSPLAT_CXX + " -DCMAKE_CXX_FLAGS='" +
                  BINOSPLAT_CXX_FLAGS + " " + sanitizers + "' && cmake --build " + build),
            "");
  ASSERT_EQ(test::run_program({"levels", "demo:city", "--count", "20000", "-o", city}).code, 0);
  const test::Outcome drawn = test::run_program(
      {city}, {.variables = {{"ASAN_OPTIONS", "detect_leaks=0"}}, .program = build + "/levels"});
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  std::size_t first = 0, last = 0;
  int open = 0, covered = 0;
  ASSERT_EQ(std::sscanf(drawn.out.c_str(), "%zu %zu %d %d", &first, &last, &open, &covered), 4) << drawn.out;
  EXPECT_GT(last, first);
  EXPECT_GT(open, 500);
  EXPECT_EQ(covered, 0);
}

}  // namespace
}  // namespace binosplat
