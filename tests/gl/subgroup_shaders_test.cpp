// Shaders that llvmpipe never compiles, because it has no subgroups, through Khronos's reference compiler.

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "gl/shader_source.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

// Shaders that the compiler is given together: it starts once.
class Compiled {
 public:
  void add(const std::string& name, const Defines& defines, const std::filesystem::path& shaders = {}) {
    test::write_text(folder_ / (std::to_string(names_.size()) + ".comp"),
                     ShaderSource(name, defines, shaders).text());
    names_.push_back(name);
    for (const auto& [define, value] : defines) names_.back() += " " + define + "=" + value;
  }

  /// What the compiler says of those that are not good, with their names; empty if all are.
  std::string errors() const {
    const std::string said = folder_ / "said";
    const std::string command = "cd " + folder_.path().string() + " && glslangValidator *.comp > said";
    if (std::system(command.c_str()) == 0) return "";
    std::string errors, file;
    std::istringstream lines(test::read_text(said));
    for (std::string line; std::getline(lines, line);) {
      if (line.ends_with(".comp")) file = line;
      if (line.starts_with("ERROR")) errors += names_.at(std::stoul(file)) + ": " + line + "\n";
    }
    return errors.empty() ? test::read_text(said) : errors;
  }

 private:
  test::TempFolder folder_;
  std::vector<std::string> names_;
};

class SubgroupShaders : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v glslangValidator > /dev/null") != 0)
      GTEST_SKIP() << "no glslangValidator: apt install glslang-tools";
  }
};

// In both projections, with a probe and without, of whole pictures and of parts.
void add_modes(Compiled& compiled, const std::string& name, const Defines& some) {
  for (const char* projection : {"affine", "tangent"}) {
    for (const char* probed : {"0", "1", "parts"}) {
      Defines defines = some;
      defines.emplace_back("PROBED", *probed == '1' ? "1" : "0");
      defines.emplace_back("PARTS", *probed == 'p' ? "1" : "0");
      defines.emplace_back("PROJECTION_NAME", projection);
      defines.emplace_back("PROJECTION", *projection == 'a' ? "0" : "1");
      defines.emplace_back("ORDER", "0");
      compiled.add(name, defines);
    }
  }
}

TEST_F(SubgroupShaders, Compile) {
  Compiled compiled;
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
        add_modes(compiled, "blend_subgroups.comp", defines);
      }
    }
  }
  for (const char* name : {"pairs.comp", "project_count_tall.comp"}) {
    const Defines defines = {{"TILES_NAME", "ellipse"}, {"TILES", "0"},          {"TH", "0"},
                             {"TILE_SIZE", "16"},       {"SUPERTILE_SIDE", "2"}, {"HALF", "0"},
                             {"WITH_SUBGROUPS", "1"}};
    add_modes(compiled, name, defines);
  }
  for (const char* half : {"0", "1"}) {
    const Defines defines = {{"TILES_NAME", "ellipse"}, {"TILES", "1"},         {"TH", "0"},
                             {"TH_NAME", "tau"},        {"TRANSMITTANCE", "0"}, {"TILE_SIZE", "16"},
                             {"SUPERTILE_SIDE", "2"},   {"HALF", half},         {"ANTIALIASED", "0"},
                             {"OFFSETS", "0"},          {"SH_DEGREE", "1"},     {"RECORDS", "1"},
                             {"WITH_SUBGROUPS", "1"}};
    add_modes(compiled, "project.comp", defines);
  }
  for (const char* writes : {"0", "1"})
    compiled.add("ranges_of_tiles.comp",
                 {{"SUPERTILE_SIDE", "2"}, {"WITH_SUBGROUPS", "1"}, {"WRITES", writes}});
  Defines check = {{"COLUMNS", "32"}, {"ROWS", "4"}};
  for (const char* fault :
       {"OF_OTHER_SIZE", "IN_OTHER_ORDER", "VOTE_WITH_OTHERS", "SHUFFLE_OTHERS", "ADD_OTHERS"})
    check.emplace_back(std::string("SUBGROUPS_") + fault, "1u");
  compiled.add("subgroups_check.comp", check);
  for (const char* block : {"1024", "2048"}) {
    for (const char* bits : {"8", "9"}) {
      compiled.add("primitives/sort_scatter_subgroups.comp", {{"SORT_BLOCK", block}, {"DIGIT_BITS", bits}});
      compiled.add("primitives/sort_digits.comp",
                   {{"SORT_BLOCK", block}, {"DIGIT_BITS", bits}, {"PASSES", "3"}});
    }
    compiled.add("project_compact.comp", {{"SORT_BLOCK", block}, {"LOOKS_BACK", "1"}});
    for (const char* both_eyes : {"0", "1"})
      compiled.add("pairs_count.comp",
                   {{"SORT_BLOCK", block}, {"LOOKS_BACK", "1"}, {"BOTH_EYES", both_eyes}});
  }
  EXPECT_EQ(compiled.errors(), "");
}

TEST_F(SubgroupShaders, AWordThatIsNotThereIsNoticed) {
  const test::TempFolder shaders;
  test::write_text(shaders / "a.comp", "layout(local_size_x = 1) in;\nvoid main() { subgroupBarrier(); }\n");
  Compiled compiled;
  compiled.add("ranges_clear.comp", {});
  compiled.add("a.comp", {{"WHICH", "1"}}, shaders.path());
  EXPECT_TRUE(compiled.errors().starts_with("a.comp WHICH=1: ERROR")) << compiled.errors();
}

}  // namespace
}  // namespace binosplat::gl
