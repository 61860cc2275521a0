#include "gl/program_cache.h"

#include <gtest/gtest.h>

#include "gl/program.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

const char* const name = "recolour.comp";

std::filesystem::path only_file(const test::TempFolder& folder) {
  EXPECT_EQ(folder.names().size(), 1u);
  return folder / *folder.names().begin();
}

Program compiled(const ProgramCache& cache) {
  Program program(test::gl_context().gl(), name, {}, {}, cache);
  program.complete(cache);
  return program;
}

// Returns whether the cache has the program, as Program queries it.
bool has(const ProgramCache& cache) {
  const Functions& gl = test::gl_context().gl();
  const std::uint32_t program = gl.CreateProgram();
  const bool found = cache.load(gl, program, ShaderSource(name, {}, {}).text());
  gl.DeleteProgram(program);
  return found;
}

bool driver_has_binaries() {
  int formats = 0;
  test::gl_context().gl().GetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  return formats > 0;
}

TEST(ProgramCache, KeepsProgramsPerDriver) {
  if (!driver_has_binaries()) GTEST_SKIP() << "this driver gives no program binaries";
  const test::TempFolder folder;
  const ProgramCache cache(folder.path(), "driver 1");
  EXPECT_FALSE(has(cache));
  const Program program = compiled(cache);
  EXPECT_TRUE(has(cache));
  EXPECT_FALSE(has(ProgramCache(folder.path(), "driver 2")));
  const Program again = compiled(cache);  // this one is from the cache
  EXPECT_EQ(again.local_size(), program.local_size());
  ASSERT_EQ(again.blocks().size(), program.blocks().size());
  EXPECT_EQ(again.blocks()[0].name, program.blocks()[0].name);
  EXPECT_EQ(again.uniforms().size(), program.uniforms().size());
}

TEST(ProgramCache, RecompilesDamagedEntries) {
  if (!driver_has_binaries()) GTEST_SKIP() << "this driver gives no program binaries";
  const test::TempFolder folder;
  const ProgramCache cache(folder.path(), "driver");
  { const Program program = compiled(cache); }
  const std::string whole = test::read_text(only_file(folder));
  std::string broken = whole;
  for (std::size_t k = broken.size() / 2; k < broken.size(); ++k) broken[k] = static_cast<char>(~broken[k]);
  const std::vector<std::string> damaged = {broken, whole.substr(0, whole.size() / 2), whole.substr(0, 10),
                                            std::string()};
  for (const std::string& content : damaged) {
    test::write_text(only_file(folder), content);
    const Program program = compiled(cache);
    EXPECT_EQ(program.uniforms().size(), 1u);
    EXPECT_TRUE(has(cache));  // repaired
  }
}

TEST(ProgramCache, KeepsResultsPerDriver) {
  const test::TempFolder folder;
  const ProgramCache cache(folder.path(), "driver 1");
  EXPECT_EQ(cache.load_result("shader"), std::nullopt);
  cache.store_result("shader", "");
  cache.store_result("other", "its subgroups vote");
  EXPECT_EQ(cache.load_result("shader"), "");
  EXPECT_EQ(cache.load_result("other"), "its subgroups vote");
  EXPECT_EQ(cache.load_result("another"), std::nullopt);
  EXPECT_EQ(ProgramCache(folder.path(), "driver 2").load_result("other"), std::nullopt);
  for (const std::string& file : folder.names()) {
    const std::string kept = test::read_text(folder / file);
    test::write_text(folder / file, kept.substr(0, kept.size() - 1));
  }
  EXPECT_EQ(cache.load_result("shader"), std::nullopt) << "damaged";
  EXPECT_EQ(cache.load_result("other"), std::nullopt) << "damaged";
  ProgramCache({}, "driver 1").store_result("shader", "");
  EXPECT_EQ(ProgramCache({}, "driver 1").load_result("shader"), std::nullopt) << "no folder";
}

TEST(ProgramCache, WorksWithUnwritableFolder) {
  const test::TempFolder folder;
  test::write_text(folder / "file", "");
  const Program program = compiled(ProgramCache(folder / "file" / "below", "driver"));
  EXPECT_EQ(program.uniforms().size(), 1u);
  const Program uncached = compiled(ProgramCache({}, "driver"));
  EXPECT_EQ(uncached.uniforms().size(), 1u);
}

}  // namespace
}  // namespace binosplat::gl
