// Shaders that llvmpipe never compiles, because it has no subgroups, through Khronos's reference compiler.

#include <gtest/gtest.h>

#include <cstdlib>

#include "gl/shader_source.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

// What the compiler says of a shader; empty if it is good.
std::string said_of(const std::string& name, const Defines& defines, const std::filesystem::path& shaders) {
  const test::TempFolder folder;
  test::write_text(folder / "shader.comp", ShaderSource(name, defines, shaders).text());
  const std::string said = folder / "said";
  const std::string command = "glslangValidator " + (folder / "shader.comp").string() + " > " + said;
  return std::system(command.c_str()) == 0 ? "" : test::read_text(said);
}

class SubgroupShaders : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v glslangValidator > /dev/null") != 0)
      GTEST_SKIP() << "no glslangValidator: apt install glslang-tools";
  }
};

// In both projections, with a probe and without, of whole pictures and of parts.
void expect_compiles(const std::string& name, const Defines& some, const std::string& what = "") {
  for (const char* projection : {"affine", "tangent"}) {
    for (const char* probed : {"0", "1", "parts"}) {
      Defines defines = some;
      defines.emplace_back("PROBED", *probed == '1' ? "1" : "0");
      defines.emplace_back("PARTS", *probed == 'p' ? "1" : "0");
      defines.emplace_back("PROJECTION_NAME", projection);
      defines.emplace_back("PROJECTION", *projection == 'a' ? "0" : "1");
      defines.emplace_back("ORDER", "0");
      EXPECT_EQ(said_of(name, defines, {}), "")
          << name << " " << what << ", " << projection << ", probed " << probed;
    }
  }
}

TEST_F(SubgroupShaders, Compile) {
  for (const char* half : {"0", "1"}) {
    for (const char* supertile_side : {"1", "2"}) {
      const Defines tiles = {{"TILE_SIZE", "16"}, {"SUPERTILE_SIDE", supertile_side}, {"HALF", half}};
      for (const auto& [lists, column, sums, depth, lossy, canvases] :
           {std::array{"0", "2", "0", "1", "0", "0"},
            {"1", "1", "0", "1", "1", "0"},
            {"0", "2", "0", "2", "1", "0"},
            {"1", "1", "0", "3", "0", "2"},
            {"0", "2", "0", "3", "0", "4"},
            {"0", "2", "0", "0", "0", "4"},
            {"0", "2", "3", "0", "0", "0"},
            {"0", "4", "3", "0", "0", "0"},
            {"1", "1", "3", "0", "0", "0"}}) {
        Defines defines = {{"COLUMN", column},    {"AHEAD", *lists == '1' ? "8" : "4"},
                           {"LISTS", lists},      {"RECORDS", "0"},
                           {"SUMS", sums},        {"SHOW", "0"},
                           {"DEPTH", depth},      {"LOSSY", lossy},
                           {"CANVASES", canvases}};
        defines.insert(defines.end(), tiles.begin(), tiles.end());
        expect_compiles("blend_subgroups.comp", defines, std::string(lists) + sums + supertile_side + half);
      }
    }
  }
  for (const char* name : {"pairs.comp", "project_count_tall.comp"}) {
    const Defines defines = {{"TILES_NAME", "ellipse"}, {"TILES", "0"},          {"TH", "0"},
                             {"TILE_SIZE", "16"},       {"SUPERTILE_SIDE", "2"}, {"HALF", "0"},
                             {"WITH_SUBGROUPS", "1"}};
    expect_compiles(name, defines);
  }
  for (const char* half : {"0", "1"}) {
    const Defines defines = {{"TILES_NAME", "ellipse"}, {"TILES", "1"},         {"TH", "0"},
                             {"TH_NAME", "tau"},        {"TRANSMITTANCE", "0"}, {"TILE_SIZE", "16"},
                             {"SUPERTILE_SIDE", "2"},   {"HALF", half},         {"ANTIALIASED", "0"},
                             {"OFFSETS", "0"},          {"SH_DEGREE", "1"},     {"RECORDS", "1"},
                             {"WITH_SUBGROUPS", "1"}};
    expect_compiles("project.comp", defines, half);
  }
  for (const char* writes : {"0", "1"})
    EXPECT_EQ(said_of("ranges_of_tiles.comp",
                      {{"SUPERTILE_SIDE", "2"}, {"WITH_SUBGROUPS", "1"}, {"WRITES", writes}}, {}),
              "");
  Defines check = {{"COLUMNS", "32"}, {"ROWS", "4"}};
  for (const char* fault :
       {"OF_OTHER_SIZE", "IN_OTHER_ORDER", "VOTE_WITH_OTHERS", "SHUFFLE_OTHERS", "ADD_OTHERS"})
    check.emplace_back(std::string("SUBGROUPS_") + fault, "1u");
  EXPECT_EQ(said_of("subgroups_check.comp", check, {}), "");
  for (const char* block : {"1024", "2048"}) {
    for (const char* bits : {"8", "9"}) {
      EXPECT_EQ(said_of("primitives/sort_scatter_subgroups.comp",
                        {{"SORT_BLOCK", block}, {"DIGIT_BITS", bits}}, {}),
                "");
      EXPECT_EQ(said_of("primitives/sort_digits.comp",
                        {{"SORT_BLOCK", block}, {"DIGIT_BITS", bits}, {"PASSES", "3"}}, {}),
                "");
    }
    EXPECT_EQ(said_of("project_compact.comp", {{"SORT_BLOCK", block}, {"LOOKS_BACK", "1"}}, {}), "");
    for (const char* both_eyes : {"0", "1"})
      EXPECT_EQ(said_of("pairs_count.comp",
                        {{"SORT_BLOCK", block}, {"LOOKS_BACK", "1"}, {"BOTH_EYES", both_eyes}}, {}),
                "");
  }
}

TEST_F(SubgroupShaders, AWordThatIsNotThereIsNoticed) {
  const test::TempFolder shaders;
  test::write_text(shaders / "a.comp", "layout(local_size_x = 1) in;\nvoid main() { subgroupBarrier(); }\n");
  EXPECT_NE(said_of("a.comp", {}, shaders.path()), "");
}

}  // namespace
}  // namespace binosplat::gl
