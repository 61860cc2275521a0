#include "app/bench/report.h"

#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <ctime>
#include <fstream>

#include "app/command.h"
#include "app/options/parse.h"

namespace binosplat::app {

namespace {

// The command line, quoted for a shell.
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

void print_table(const std::vector<lab::Row>& rows, const std::vector<std::string>& columns) {
  fmt::print("{}\n", fmt::join(lab::table_lines(rows, columns), "\n"));
}

std::vector<lab::Row> rows_to_compare(const std::string& file) {
  return file.empty() ? std::vector<lab::Row>() : lab::rows_of(load_json(file), "--compare " + file);
}

void print_comparison(const std::string& file, const lab::RunComparison& found,
                      const std::optional<double>& fail_if_slower) {
  fmt::print("\nSince {}:\n{}\n", file, fmt::join(found.lines, "\n"));
  if (!fail_if_slower) return;
  if (found.matched == 0)
    fail("--fail-if-slower: no point of this run is in {}: compare runs of the same scenes and options",
         file);
  if (found.slower_percent > *fail_if_slower) {
    throw Error(ExitCode::fell_short,
                fmt::format("{} is {:.1f} % slower than in {}, more than --fail-if-slower {:g}",
                            found.slowest, found.slower_percent, file, *fail_if_slower));
  }
  if (found.timed < found.matched) {
    throw Error(ExitCode::fell_short,
                fmt::format("--fail-if-slower: the times of {} of {} points could not be compared with {}",
                            found.matched - found.timed, found.matched, file));
  }
}

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
