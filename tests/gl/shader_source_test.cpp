#include "gl/shader_source.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "base/error.h"
#include "gl/context.h"
#include "gl/program.h"
#include "support/errors.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

TEST(ShaderSource, PutsDefinesFirstAndIncludesOnce) {
  test::TempFolder folder;
  test::write_text(folder / "a.comp", "#include \"b.glsl\"\n#include \"b.glsl\"\nint a;\n");
  test::write_text(folder / "b.glsl", "int b;\n");
  const ShaderSource source("a.comp", {{"SIZE", "16"}}, folder.path());
  EXPECT_EQ(
      source.text(),
      "#version 450 core\n#define SIZE 16\n#line 1 0\n#line 1 1\nint b;\n#line 2 0\n#line 3 0\nint a;\n");
}

TEST(ShaderSource, UsesOnlySavedBindings) {
  const std::regex block(R"(layout\(std430, binding = (\d+)\))");
  std::uint32_t most = 0;
  for (const auto& [name, text] : embedded_shaders()) {
    for (std::sregex_iterator found(text.begin(), text.end(), block), end; found != end; ++found)
      most = std::max(most, static_cast<std::uint32_t>(std::stoul((*found)[1])));
  }
  EXPECT_EQ(most + 1, storage_bindings_needed);
}

TEST(ShaderSource, NamesFileInDriverMessage) {
  test::TempFolder folder;
  test::write_text(folder / "a.comp", "#include \"b.glsl\"\nint a;\n");
  test::write_text(folder / "b.glsl", "int b;\n");
  const ShaderSource source("a.comp", {}, folder.path());
  EXPECT_EQ(source.with_file_names("1:14(3): error: x\n0(7) : error C1\n"),
            "b.glsl:14(3): error: x\na.comp:7 : error C1\n");
}

TEST(ShaderSource, ReportsMissingInclude) {
  test::TempFolder folder;
  test::write_text(folder / "a.comp", "\n#include \"gone.glsl\"\n");
  EXPECT_ERROR(const ShaderSource source("a.comp", {}, folder.path()), "gone.glsl", "a.comp:2");
  EXPECT_ERROR(const ShaderSource source("gone.comp", {}, {}), "gone.comp");
}

TEST(ShaderSource, EmbeddedFilesMatchSourceTree) {
  const std::filesystem::path root = std::filesystem::path(BINOSPLAT_SOURCE_DIR) / "shaders";
  if (!std::filesystem::exists(root)) GTEST_SKIP() << "the source tree is not on this machine";
  ASSERT_GT(embedded_shaders().size(), 10u);
  for (const auto& [name, text] : embedded_shaders()) EXPECT_EQ(text, test::read_text(root / name)) << name;
}

TEST(Program, ReportsLineOfCompileError) {
  test::TempFolder folder;
  test::write_text(folder / "wrong.comp",
                   "layout(local_size_x = 1) in;\nvoid main() {\n  int x = missing_name;\n}\n");
  try {
    Program program(test::gl_context().gl(), "wrong.comp", {}, folder.path(), ProgramCache({}, ""));
    program.complete(ProgramCache({}, ""));
    FAIL() << "it compiled";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("wrong.comp:3"), std::string::npos) << error.what();
    EXPECT_EQ(error.code(), ExitCode::no_gl);
  }
}

}  // namespace
}  // namespace binosplat::gl
