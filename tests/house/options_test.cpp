// Only src/app names options of the command line. The texts of other modules name settings in backticks,
// because users of the library and of Python read them, too, and src/app turns these names into options.
// Every option is explained on a page of docs/.

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/sources.h"

namespace {

const std::string table_path = "src/app/options/table.cpp";

/// Returns the names in a table of options, without dashes.
std::set<std::string> names_of_options(const std::string& table) {
  static const std::regex name(R"re("(?:-\w,)?--([a-z0-9-]+)")re");
  std::set<std::string> names;
  for (std::sregex_iterator at(table.begin(), table.end(), name), end; at != end; ++at)
    names.insert((*at)[1].str());
  return names;
}

/// Returns the options that string literals outside of src/app name, with their places. Options of other
/// programs, such as colmap's, are not in the table.
std::vector<std::string> named_options(const binosplat::test::Sources& sources) {
  static const std::regex comment_or_literal(R"re(//.*|'(?:[^'\\]|\\.)'|"(?:[^"\\]|\\.)*")re"),
      option("--([a-z][a-z0-9_-]*)");
  const std::set<std::string> ours = names_of_options(sources.at(table_path));
  std::vector<std::string> found;
  for (const auto& [path, text] : sources) {
    if (path.starts_with("src/app/")) continue;
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      for (std::sregex_iterator at(line.begin(), line.end(), comment_or_literal), end; at != end; ++at) {
        const std::string literal = at->str();
        if (literal[0] != '"') continue;
        for (std::sregex_iterator in(literal.begin(), literal.end(), option); in != end; ++in) {
          const std::string name = (*in)[1];
          if (ours.contains(name))
            found.push_back(path + ":" + std::to_string(number) + ": --" + name + ": write `" + name + "`");
        }
      }
    }
  }
  return found;
}

/// Returns the options of a table that no page names: neither in full nor, like -o, by their letter.
std::vector<std::string> options_without_page(const std::string& table, const std::string& pages) {
  static const std::regex name(R"re(\{"(?:(-\w),)?(--[a-z0-9-]+)")re");
  const auto is_named = [&pages](const std::string& option) {
    return std::regex_search(pages, std::regex("(^|[^a-z-])" + option + "($|[^a-z0-9-])"));
  };
  std::vector<std::string> missing;
  for (std::sregex_iterator at(table.begin(), table.end(), name), end; at != end; ++at)
    if (!is_named((*at)[2]) && !((*at)[1].matched && is_named((*at)[1]))) missing.push_back((*at)[2]);
  return missing;
}

TEST(PagesOfOptions, NameEachOption) {
  std::string pages;
  const auto sources =
      binosplat::test::sources_of_tree({"docs", "include", "src", "stereo"}, {".cpp", ".h", ".md"});
  for (const auto& [path, text] : sources)
    if (path.starts_with("docs/")) pages += text;
  for (const std::string& option : options_without_page(sources.at(table_path), pages))
    ADD_FAILURE() << option << ": say what it is for on the page of its command";
}

TEST(PagesOfOptions, InjectedGapsAreDetected) {
  const std::string table = R"({"--size", 1}, {"-o,--output", 2}, {"--max", 3})";
  using Options = std::vector<std::string>;
  EXPECT_EQ(options_without_page(table, "`--size 2x2`, `-o out`, --max-memory"), Options{"--max"});
  EXPECT_EQ(options_without_page(table, "`--sizes`, `render-o`, `--max`"), (Options{"--size", "--output"}));
  EXPECT_EQ(options_without_page(table, "--size\n(--output) --max"), Options{});
}

TEST(NamedOptions, AreInAppOnly) {
  const auto sources = binosplat::test::sources_of_tree({"include", "src", "stereo"}, {".cpp", ".h"});
  EXPECT_GT(names_of_options(sources.at(table_path)).size(), 80u);
  for (const std::string& place : named_options(sources)) ADD_FAILURE() << place;
}

TEST(NamedOptions, InjectedBreachesAreDetected) {
  const auto count = [](const std::string& path, const std::string& line) {
    const std::string table = R"({"--size", 1, "--size of"}, {"-o,--output", 2}, {"--max-memory", 3})";
    return named_options({{table_path, table}, {path, "int a;\n" + line + "\n"}}).size();
  };
  EXPECT_EQ(count("src/gl/a.cpp", R"(fail("a smaller --size or fewer");)"), 1u);
  EXPECT_EQ(count("src/lab/a.h", R"(const char* text = "--max-memory MB";)"), 1u);
  EXPECT_EQ(count("stereo/a.cpp", R"(fail("\"{}\": --size, or --output", '"');)"), 2u);
  EXPECT_EQ(count("include/binosplat/a.h", R"(// "
      f('"', "--size 1");)"),
            1u);
  EXPECT_EQ(count("src/app/a.cpp", R"(fail("a smaller --size");)"), 0u);
  EXPECT_EQ(count("src/gl/a.cpp", R"(fail("a smaller `size`");  // not "--size")"), 0u);
  EXPECT_EQ(count("src/gl/a.cpp", R"(run("colmap --output_path --sizes");)"), 0u) << "of other programs";
  EXPECT_EQ(count("src/gl/a.cpp", "--size;"), 0u) << "an expression";
}

}  // namespace
