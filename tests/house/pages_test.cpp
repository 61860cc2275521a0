// Pages are read in a terminal, too: no line of them is over 120 characters. Tests and sources that they name
// exist.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t columns_max = 120;

/// Characters of UTF-8 text.
std::ptrdiff_t columns_of(const std::string& line) {
  return std::count_if(line.begin(), line.end(), [](char byte) { return (byte & 0xc0) != 0x80; });
}

std::vector<std::string> long_lines(const std::string& name, const std::string& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (columns_of(line) > columns_max)
      found.push_back(name + ":" + std::to_string(number) + ": " + std::to_string(columns_of(line)) +
                      " characters");
  }
  return found;
}

const fs::path root = BINOSPLAT_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> all_pages() {
  std::vector<fs::path> pages = {root / "README.md", root / "CHANGELOG.md"};
  for (const auto& entry : fs::directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  return pages;
}

/// The tests that a page names as `room.Suite.Name`, or `room.Suite.*`, and no file of that room has.
std::vector<std::string> missing_tests(const std::string& page) {
  static const std::regex named("`([a-z]+)\\.([A-Z]\\w+)\\.(\\w+|\\*)`");
  std::vector<std::string> missing;
  for (std::sregex_iterator at(page.begin(), page.end(), named), end; at != end; ++at) {
    const fs::path room = root / "tests" / (*at)[1].str();
    if (!fs::is_directory(room)) continue;
    const std::string name = (*at)[3] == "*" ? "\\w+" : (*at)[3].str();
    const std::regex test("TEST(_F|_P)?\\(" + (*at)[2].str() + ",\\s*" + name + "\\)");
    const bool found =
        std::ranges::any_of(fs::directory_iterator(room), [&](const fs::directory_entry& entry) {
          return entry.path().extension() == ".cpp" && std::regex_search(text_of(entry.path()), test);
        });
    if (!found) missing.push_back(at->str());
  }
  return missing;
}

/// The sources that a page names as `room/file.cpp` or `room/file.{h,cpp}`, from the top or from where
/// sources are included from, and that are not there.
std::vector<std::string> missing_sources(const std::string& page) {
  static const std::regex named("`((?:[a-z_]+/)+[a-z0-9_]+\\.)(?:(cpp|h|comp|glsl)|\\{([a-z,]+)\\})`");
  std::vector<std::string> missing;
  for (std::sregex_iterator at(page.begin(), page.end(), named), end; at != end; ++at) {
    std::istringstream endings((*at)[2].matched ? (*at)[2].str() : (*at)[3].str());
    for (std::string ending; std::getline(endings, ending, ',');) {
      const std::string name = (*at)[1].str() + ending;
      const bool found =
          std::ranges::any_of(std::array{"", "src", "shaders", "include", "tests"},
                              [&](const char* from) { return fs::exists(root / from / name); });
      if (!found) missing.push_back(name);
    }
  }
  return missing;
}

TEST(Pages, HaveLinesThatFitATerminal) {
  const std::vector<fs::path> pages = all_pages();
  EXPECT_GT(pages.size(), 15u) << "the pages were not found";
  for (const fs::path& page : pages) {
    const std::string text = text_of(page);
    EXPECT_FALSE(text.empty()) << page;
    for (const std::string& line : long_lines(fs::relative(page, root).string(), text)) ADD_FAILURE() << line;
  }
}

TEST(Pages, NameTestsThatExist) {
  for (const fs::path& page : all_pages())
    EXPECT_EQ(missing_tests(text_of(page)), std::vector<std::string>()) << page;
  EXPECT_EQ(missing_tests("`lab.Judge.TellsNothing`, `lab.Traps.*`, `house.Pages.NameTestsThatExist`"),
            std::vector<std::string>{"`lab.Judge.TellsNothing`"})
      << "planted";
}

TEST(Pages, NameSourcesThatExist) {
  for (const fs::path& page : all_pages())
    EXPECT_EQ(missing_sources(text_of(page)), std::vector<std::string>()) << page;
  EXPECT_EQ(missing_sources("`src/gl/none.cpp`, `gl/context.{h,txt,cpp}`, `shaders/blend.comp`, `NAME.cpp`"),
            (std::vector<std::string>{"src/gl/none.cpp", "gl/context.txt"}))
      << "planted";
}

TEST(Pages, PlantedLongLinesAreCaught) {
  const std::string fits(columns_max, 'a');
  EXPECT_EQ(long_lines("a.md", fits + "\n\n" + fits + "\n"), std::vector<std::string>());
  EXPECT_EQ(long_lines("a.md", "\n" + fits + "b\n"), std::vector<std::string>{"a.md:2: 121 characters"});
  std::string umlauts;
  for (int k = 0; k < columns_max; ++k) umlauts += "\xc3\xa4";
  EXPECT_EQ(long_lines("a.md", umlauts).size(), 0u);
  EXPECT_EQ(long_lines("a.md", umlauts + "b").size(), 1u);
}

}  // namespace
