// The variants of the blend: which there are, and that they compile.

#include "render/variants.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/compiled_shaders.h"

namespace binosplat::render {
namespace {

using Defined = std::pair<std::string, std::string>;

TEST(BlendVariants, HaveDistinctKeys) {
  const std::vector<BlendVariant> all = blend_variants();
  std::map<std::pair<std::string_view, std::uint64_t>, gl::Defines> known;
  for (const BlendVariant& v : all) {
    ASSERT_TRUE(v.is_legal());
    const auto numbers = v.numbers();
    const gl::Defines defines = gl::defines_of(numbers);
    EXPECT_EQ(known.emplace(std::pair(v.shader(), gl::key_of(numbers)), defines).first->second, defines);
  }
  RecordProperty("variants", static_cast<int>(known.size()));
  EXPECT_EQ(known.size(), all.size()) << "one is there twice";
  std::printf("%zu variants of the blend are legal\n", all.size());
  EXPECT_LE(all.size(), 1712u) << "more than anyone compiles";
}

TEST(BlendVariants, RejectUnusedCombinations) {
  EXPECT_FALSE((BlendVariant{.measure = MEASURE_VISIBILITY, .approximate = true}).is_legal());
  EXPECT_FALSE((BlendVariant{.program = BlendProgram::subgroups, .measure = MEASURE_CHANGES}).is_legal());
  EXPECT_FALSE((BlendVariant{.depth = DEPTH_VISIBILITY, .canvases = true}).is_legal());
  auto numbers = BlendVariant{}.numbers();
  numbers.front().value = numbers.front().count;  // injected: a value that would be another number's
  EXPECT_THROW(gl::key_of(numbers), std::logic_error);
}

// Compiles enough variants that any two values occur together in one of them if any variant has both.
TEST(BlendVariants, Compile) {
  if (!test::has_glslang()) GTEST_SKIP() << "no glslangValidator: apt install glslang-tools";
  test::CompiledShaders compiled;
  std::set<std::tuple<std::string_view, Defined, Defined>> seen;
  const std::vector<BlendVariant> all = blend_variants();
  int count = 0;
  for (const BlendVariant& v : all) {
    const gl::Defines defines = gl::defines_of(v.numbers());
    bool is_new = false;
    for (std::size_t i = 0; i < defines.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k)
        is_new = seen.emplace(v.shader(), defines[i], defines[k]).second || is_new;
    }
    if (!is_new) continue;
    compiled.add(std::string(v.shader()), defines);
    ++count;
  }
  std::printf("%d of %zu variants of the blend\n", count, all.size());
  EXPECT_EQ(compiled.errors(), "");
}

}  // namespace
}  // namespace binosplat::render
