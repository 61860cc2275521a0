// A name in an anonymous namespace must be unique in its folder. With unity builds, a duplicate is a compile
// error, or silently calls the other file's function.

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/sources.h"

namespace {

/// Returns the name that a line at the top of an anonymous namespace declares, or "". Aliases do not count:
/// two aliases of one type are allowed, and two of different types do not compile.
std::string declared(const std::string& line) {
  static const std::regex type(R"(^(?:template <.*> )?(?:struct|class|enum class|enum) (\w+)(?: |:|;|$).*)");
  static const std::regex other(
      R"(^(?!using |namespace |template |TEST|INSTANTIATE|struct |class |enum )[\w:][\w:<>, *&]*[ *&](\w+)(?:\(|\[| =|\{|;).*)");
  std::smatch match;
  if (std::regex_match(line, match, type) || std::regex_match(line, match, other)) return match[1];
  return "";
}

using binosplat::test::Sources;

std::vector<std::string> clashes(const Sources& sources) {
  std::map<std::string, std::string> first;  // folder and name -> file
  std::vector<std::string> found;
  for (const auto& [path, text] : sources) {
    const std::string folder = path.substr(0, path.rfind('/'));
    std::istringstream lines(text);
    bool is_inside = false;
    for (std::string line; std::getline(lines, line);) {
      if (line == "namespace {") is_inside = true;
      if (line == "}  // namespace") is_inside = false;
      const std::string name = is_inside ? declared(line) : "";
      if (name.empty()) continue;
      const std::string& file = first.try_emplace(folder + ' ' + name, path).first->second;
      if (file != path)
        found.push_back(path + ": '" + name + "' is a name of " + file + ", too: say what each is");
    }
  }
  return found;
}

TEST(Names, AreUniqueInFolder) {
  Sources sources = binosplat::test::sources_of_tree({"src", "stereo", "tests"}, {".cpp"});
  // Each file in these folders is a program of its own.
  std::erase_if(sources, [](const auto& source) {
    return source.first.starts_with("tests/bench/") || source.first.starts_with("tests/fuzz/");
  });
  for (const std::string& clash : clashes(sources)) ADD_FAILURE() << clash;
}

TEST(Names, InjectedClashesAreDetected) {
  const std::string begin = "namespace binosplat {\n\nnamespace {\n\n", end = "\n\n}  // namespace\n";
  const auto of_two = [&](const std::string& a, const std::string& b) {
    return clashes({{"src/a/a.cpp", begin + a + end}, {"src/a/b.cpp", begin + b + end}}).size();
  };
  EXPECT_EQ(of_two("constexpr int width = 3;", "constexpr double width = 4.0;"), 1u);
  EXPECT_EQ(of_two("std::vector<int> row(int n) {", "Row row(const Model& model, int n) {"), 1u);
  EXPECT_EQ(of_two("struct Seen {", "class Seen : Base {"), 1u);
  EXPECT_EQ(of_two("const char* names[] = {", "std::map<int, std::string> names;"), 1u);
  EXPECT_EQ(of_two("using Names = std::set<int>;", "using Names = std::set<int>;"), 0u);
  EXPECT_EQ(of_two("  int width = 3;", "  int width = 4;"), 0u) << "within functions";
  EXPECT_EQ(of_two("int width() {", "int height() {"), 0u);
  EXPECT_EQ(clashes({{"src/a/a.cpp", begin + "int f() {" + end}, {"src/b/b.cpp", begin + "int f() {" + end}})
                .size(),
            0u);
  EXPECT_EQ(clashes({{"src/a/a.cpp", "int f() {\n"}, {"src/a/b.cpp", begin + "int f() {" + end}}).size(), 0u);
}

}  // namespace
