// Compiles the shaders that llvmpipe never compiles, as it has no subgroups, with Khronos's reference
// compiler. tests/render/variants_test.cpp has those of the blend.

#include <gtest/gtest.h>

#include <cstdlib>

#include "gl/shader_source.h"
#include "support/compiled_shaders.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

class SubgroupShaders : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_glslang()) GTEST_SKIP() << "no glslangValidator: apt install glslang-tools";
  }
};

// Adds a shader for both projections, with and without a probe, for whole views and view regions.
void add_modes(test::CompiledShaders& compiled, const std::string& name, const Defines& some) {
  for (const char* projection : {"affine", "tangent"}) {
    for (const char* probed : {"0", "1", "parts"}) {
      Defines defines = some;
      defines.emplace_back("PROBED", *probed == '1' ? "1" : "0");
      defines.emplace_back("REGIONS", *probed == 'p' ? "1" : "0");
      defines.emplace_back("PROJECTION_NAME", projection);
      defines.emplace_back("PROJECTION", *projection == 'a' ? "0" : "1");
      defines.emplace_back("ORDER", "0");
      compiled.add(name, defines);
    }
  }
}

TEST_F(SubgroupShaders, Compile) {
  test::CompiledShaders compiled;
  for (const char* views : {"1", "2"}) {  // lists of each view, or shared by both eyes
    const Defines::value_type list_views = {"LIST_VIEWS", views};
    add_modes(compiled, "bin_large.comp",
              {{"TILES_NAME", "ellipse"},
               {"TILES", "0"},
               {"THRESHOLD", "0"},
               {"HALF", "0"},
               {"WITH_SUBGROUPS", "1"},
               list_views});
    for (const char* half : {"0", "1"}) {
      const Defines defines = {{"TILES_NAME", "ellipse"},   {"TILES", "1"},          {"THRESHOLD", "0"},
                               {"THRESHOLD_NAME", "exact"}, {"TRANSMITTANCE", "0"},  {"HALF", half},
                               {"ANTIALIASED", "0"},        {"OFFSETS", "0"},        {"SH_DEGREE", "1"},
                               {"MEASURES", "1"},           {"WITH_SUBGROUPS", "1"}, list_views};
      add_modes(compiled, "project.comp", defines);
    }
    compiled.add("sort_split.comp", {{"WITH_SUBGROUPS", "1"}, list_views});
    for (const char* threads : {"32", "1024"}) {
      compiled.add("sort_lists.comp",
                   {{"WITH_SUBGROUPS", "1"}, {"LIST_THREADS", threads}, {"LIST_EACH", "4"}, list_views});
    }
  }
  Defines check = {{"COLUMNS", "32"}, {"ROWS", "4"}};
  for (const char* fault :
       {"OF_OTHER_SIZE", "IN_OTHER_ORDER", "VOTE_WITH_OTHERS", "SHUFFLE_OTHERS", "ADD_OTHERS"})
    check.emplace_back(std::string("SUBGROUPS_") + fault, "1u");
  compiled.add("subgroups_check.comp", check);
  compiled.add("project_compact.comp", {{"LOOKS_BACK", "1"}});
  EXPECT_EQ(compiled.errors(), "");
}

TEST_F(SubgroupShaders, CheckDetectsUndefinedName) {
  const test::TempFolder shaders;
  test::write_text(shaders / "a.comp", "layout(local_size_x = 1) in;\nvoid main() { subgroupBarrier(); }\n");
  test::CompiledShaders compiled;
  compiled.add("bin_place.comp", {});
  compiled.add("a.comp", {{"WHICH", "1"}}, shaders.path());
  EXPECT_TRUE(compiled.errors().starts_with("a.comp WHICH=1: ERROR")) << compiled.errors();
}

}  // namespace
}  // namespace binosplat::gl
