#include "app/report.h"

#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <ctime>
#include <fstream>

#include "app/command.h"

namespace binosplat::app {

namespace {

// As it was typed, for a shell to read again.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) {
    const auto is_plain = [](unsigned char c) {
      return std::isalnum(c) != 0 || std::strchr("_./:,=+@%-", c) != nullptr;
    };
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), is_plain);
    words.push_back(plain ? word : "'" + CLI::detail::find_and_replace(word, "'", "'\\''") + "'");
  }
  if (!words.empty()) words.front() = "binosplat";
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace

lab::Page with_command(lab::Page page) {
  page.facts.emplace_back("command", command_line());
  page.facts.emplace_back("date", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr))));
  return page;
}

void save_report(const std::filesystem::path& folder, const std::string& name,
                 const nlohmann::ordered_json& results, const lab::Page& page) {
  save_json(folder / name, results);
  lab::save_page(folder / "report.html", with_command(page), results);
}

}  // namespace binosplat::app
