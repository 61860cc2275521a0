// Every format of the registry appears in every list of formats.

#include "formats/models/registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "support/load.h"
#include "support/models.h"

namespace binosplat {
namespace {

const std::string root = BINOSPLAT_SOURCE_DIR;

/// Returns a name as fuzzers spell it: "Scaffold-GS" becomes scaffold_gs.
std::string identifier(const char* name) {
  std::string word;
  for (const char c : std::string_view(name)) {
    if (std::isalnum(static_cast<unsigned char>(c))) word += static_cast<char>(std::tolower(c));
    if (!std::isalnum(static_cast<unsigned char>(c)) && !word.empty()) word += '_';
  }
  return word;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Returns the first list that lacks a format, or an empty string.
std::string lacks(const char* name) {
  std::vector<std::string> texts = {"README.md", "include/binosplat/model.h"};
  for (const std::string& text : texts) {
    if (!has(test::read_text(root + "/" + text), name)) return text;
  }
  static const std::string help = [] {
    const std::string text = test::run_program({"render", "--help"}).out;
    return std::regex_replace(text, std::regex("\\s+"), " ");
  }();
  if (!has(help, name)) return "the help of SCENE";
  const std::string fuzzer = identifier(name), fuzzers = test::read_text(root + "/tests/fuzz/CMakeLists.txt");
  if (!has(fuzzers, " " + fuzzer + " ")) return "tests/fuzz/CMakeLists.txt";
  return std::filesystem::is_directory(root + "/tests/fuzz/corpus/" + fuzzer) ? "" : "tests/fuzz/corpus";
}

TEST(FormatRegistry, EveryFormatIsListed) {
  for (const FormatRow& row : format_rows()) EXPECT_EQ(lacks(row.name), "") << row.name;
  EXPECT_EQ(lacks("nerf"), "README.md");
}

// Readers get files of any content by --format.
TEST(FormatRegistry, NamedReadersRejectOtherFiles) {
  const test::TempFolder folder;
  const std::string file = folder / "file";
  std::string noise;
  test::Uniform uniform(1);
  for (int i = 0; i < 3200; ++i) noise += static_cast<char>(uniform(0, 256));
  for (const std::string& bytes :
       {noise, std::string(3200, '\0'), std::string("{}"), std::string("[1]"), std::string("#usda 1.0\n"),
        std::string("PXR-USDC"), std::string("ply\nend_header\n"), std::string("\x1f\x8b\x08"),
        std::string("PK\x03\x04"), std::string("glTF"), std::string("text"), std::string()}) {
    test::write_text(file, bytes);
    for (const FormatRow& row : format_rows())
      EXPECT_THROW(load_model(file, {.format = row.name}), Error) << row.name << ": " << bytes.substr(0, 9);
  }
  EXPECT_TRUE(test::fails_saying([&] { load_model(file, {.format = "nerf"}); },
                                 {"format nerf: expected Scaffold-GS", "or .splat"}));
}

TEST(FormatRegistry, RowsAreComplete) {
  for (const FormatRow& row : format_rows()) {
    EXPECT_NE(row.recognises, nullptr) << row.name;
    EXPECT_NE(row.read, nullptr) << row.name;
    EXPECT_EQ(row.write == nullptr, row.bytes == nullptr) << row.name;
    EXPECT_TRUE(row.write == nullptr || *row.endings == '.') << row.name;
  }
  EXPECT_EQ(names_of_formats().substr(0, 11), "Scaffold-GS");
}

}  // namespace
}  // namespace binosplat
