// Pages are read in a terminal, too: no line of them is over 120 characters.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
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

TEST(Pages, HaveLinesThatFitATerminal) {
  const fs::path root = BINOSPLAT_SOURCE_DIR;
  std::vector<fs::path> pages = {root / "README.md", root / "CHANGELOG.md"};
  for (const auto& entry : fs::directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  EXPECT_GT(pages.size(), 15u) << "the pages were not found";
  for (const fs::path& page : pages) {
    std::ifstream in(page);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    EXPECT_FALSE(text.empty()) << page;
    for (const std::string& line : long_lines(fs::relative(page, root).string(), text)) ADD_FAILURE() << line;
  }
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
