// Rules for pages of documentation. Lines have at most 120 characters, because pages are also read in a
// terminal. The tests, sources, files and headings that pages name or link to exist.

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t columns_max = 120;

/// Returns the number of characters of UTF-8 text.
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

/// Returns all_pages() and the pages in src and tests.
std::vector<fs::path> pages_of_all_folders() {
  std::vector<fs::path> pages = all_pages();
  for (const char* folder : {"src", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() == ".md") pages.push_back(entry.path());
    }
  }
  return pages;
}

/// Returns the lines outside of code blocks.
std::vector<std::string> lines_of(const std::string& page) {
  std::vector<std::string> lines;
  bool is_code = false;
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);) {
    const bool is_fence = line.starts_with("```");
    if (is_fence) is_code = !is_code;
    lines.push_back(is_fence || is_code ? "" : line);
  }
  return lines;
}

/// Returns the anchors of a page's headings, as GitHub makes them.
std::set<std::string> anchors_of(const std::string& page) {
  std::set<std::string> anchors;
  std::map<std::string, int> times;
  static const std::regex link("\\[([^\\]]*)\\]\\([^)]*\\)");
  for (const std::string& line : lines_of(page)) {
    const std::size_t level = line.find_first_not_of('#');
    if (level == 0 || level == std::string::npos || line[level] != ' ') continue;
    std::string anchor;
    for (const char c : std::regex_replace(line.substr(level + 1), link, "$1")) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte >= 0x80 || std::isalnum(byte) || c == '_' || c == '-')
        anchor += static_cast<char>(std::tolower(byte));
      if (c == ' ') anchor += '-';
    }
    const int before = times[anchor]++;
    anchors.insert(before == 0 ? anchor : anchor + '-' + std::to_string(before));
  }
  return anchors;
}

/// Returns the links of a page in `folder` to files or headings that do not exist.
std::vector<std::string> dangling_links(const std::string& page, const fs::path& folder) {
  static const std::regex link("\\]\\(([^)#\\s]*)(?:#([^)\\s]*))?\\)");
  std::vector<std::string> dangling;
  std::string text;
  for (const std::string& line : lines_of(page)) text += line + '\n';
  for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
    const std::string file = (*at)[1], anchor = (*at)[2];
    if (file.find("://") != std::string::npos) continue;
    const bool is_there = file.empty() || fs::exists(folder / file);
    const bool has_anchor =
        anchor.empty() ||
        (is_there && anchors_of(file.empty() ? page : text_of(folder / file)).contains(anchor));
    if (!is_there || !has_anchor) dangling.push_back(anchor.empty() ? file : file + '#' + anchor);
  }
  return dangling;
}

/// Returns the tests that a page names as `module.Suite.Name` or `module.Suite.*`, but that no file of the
/// module contains.
std::vector<std::string> missing_tests(const std::string& page) {
  static const std::regex named("`([a-z]+)\\.([A-Z]\\w+)\\.(\\w+|\\*)`");
  std::vector<std::string> missing;
  for (std::sregex_iterator at(page.begin(), page.end(), named), end; at != end; ++at) {
    const fs::path module = root / "tests" / (*at)[1].str();
    if (!fs::is_directory(module)) continue;
    const std::string name = (*at)[3] == "*" ? "\\w+" : (*at)[3].str();
    const std::regex test("TEST(_F|_P)?\\(" + (*at)[2].str() + ",\\s*" + name + "\\)");
    const bool found =
        std::ranges::any_of(fs::directory_iterator(module), [&](const fs::directory_entry& entry) {
          return entry.path().extension() == ".cpp" && std::regex_search(text_of(entry.path()), test);
        });
    if (!found) missing.push_back(at->str());
  }
  return missing;
}

/// Returns the sources that a page names as `module/file.cpp` or `module/file.{h,cpp}`, but that exist
/// neither below the root nor below an include path.
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

TEST(Pages, LinesFitTerminal) {
  const std::vector<fs::path> pages = all_pages();
  EXPECT_GT(pages.size(), 10u) << "the pages were not found";
  for (const fs::path& page : pages) {
    const std::string text = text_of(page);
    EXPECT_TRUE(text.starts_with("# ")) << page << " begins without a heading";
    for (const std::string& line : long_lines(fs::relative(page, root).string(), text)) ADD_FAILURE() << line;
  }
}

TEST(Pages, NamedTestsExist) {
  for (const fs::path& page : all_pages())
    EXPECT_EQ(missing_tests(text_of(page)), std::vector<std::string>()) << page;
  EXPECT_EQ(missing_tests("`lab.Judge.TellsNothing`, `lab.ThresholdTraps.*`, `house.Pages.NamedTestsExist`"),
            std::vector<std::string>{"`lab.Judge.TellsNothing`"})
      << "injected";
}

TEST(Pages, NamedSourcesExist) {
  for (const fs::path& page : all_pages())
    EXPECT_EQ(missing_sources(text_of(page)), std::vector<std::string>()) << page;
  EXPECT_EQ(missing_sources("`src/gl/none.cpp`, `gl/context.{h,txt,cpp}`, `shaders/blend.comp`, `NAME.cpp`"),
            (std::vector<std::string>{"src/gl/none.cpp", "gl/context.txt"}))
      << "injected";
}

TEST(Pages, LinkTargetsExist) {
  for (const fs::path& page : pages_of_all_folders())
    EXPECT_EQ(dangling_links(text_of(page), page.parent_path()), std::vector<std::string>()) << page;
  const std::string injected =
      "# A `heading`, and [a link](none.md)\n[1](CMakeLists.txt) [2](docs/none.md) "
      "[3](#a-heading-and-a-link)\n"
      "[4](#none) [5](docs/method.md#6-stereo)\n[6](docs/method.md#none) [7](https://none.org/#none)\n"
      "```\n# Code\n[8](none.txt)\n```\n[9](#code)\n";
  EXPECT_EQ(dangling_links(injected, root),
            (std::vector<std::string>{"none.md", "docs/none.md", "#none", "docs/method.md#none", "#code"}))
      << "injected";
}

TEST(Pages, InjectedLongLinesAreDetected) {
  const std::string fits(columns_max, 'a');
  EXPECT_EQ(long_lines("a.md", fits + "\n\n" + fits + "\n"), std::vector<std::string>());
  EXPECT_EQ(long_lines("a.md", "\n" + fits + "b\n"), std::vector<std::string>{"a.md:2: 121 characters"});
  std::string umlauts;
  for (int k = 0; k < columns_max; ++k) umlauts += "\xc3\xa4";
  EXPECT_EQ(long_lines("a.md", umlauts).size(), 0u);
  EXPECT_EQ(long_lines("a.md", umlauts + "b").size(), 1u);
}

/// Returns the exit code of `tests/bench/tables --check` of a checkout, which compares the measured numbers
/// of its pages with their sources.
int check_numbers(const fs::path& checkout) {
  return std::system(("python3 '" + (checkout / "tests/bench/tables").string() + "' --check").c_str());
}

TEST(Pages, NumbersMatchResults) {
  if (std::system("python3 --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no python3";
  EXPECT_EQ(check_numbers(root), 0);
  const fs::path copy = fs::temp_directory_path() / ("binosplat_pages_" + std::to_string(getpid()));
  for (const char* folder : {"docs", "tests/bench"}) {
    fs::create_directories(copy / folder);
    fs::copy(root / folder, copy / folder,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }
  const std::string page = text_of(root / "README.md");
  const std::regex marked("[0-9]+(<!--heads)");
  for (const std::string& wrong :
       {std::regex_replace(page, marked, "99$1", std::regex_constants::format_first_only),
        page + "\nIt draws 3.5 dB better.\n"}) {
    std::ofstream(copy / "README.md") << wrong;
    EXPECT_NE(check_numbers(copy), 0) << wrong;
  }
  std::ofstream(copy / "README.md") << page;
  EXPECT_EQ(check_numbers(copy), 0);
  fs::remove_all(copy);
}

}  // namespace
