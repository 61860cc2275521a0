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

namespace {

std::string shown(const lab::Cell& cell, const std::string& column) {
  if (const auto* const text = std::get_if<std::string>(&cell.value)) return *text;
  if (const auto* const whole = std::get_if<std::int64_t>(&cell.value)) return fmt::format("{}", *whole);
  const auto* const number = std::get_if<double>(&cell.value);
  if (number == nullptr) return "-";
  if (column == "pairs" || column == "Gaussians") return fmt::format("{:.0f}", *number);
  const int digits = column.ends_with("dB") ? 2 : column.ends_with("%") ? 1 : column.ends_with("ms") ? 3 : 4;
  return fmt::format("{:.{}f}", *number, digits);
}

}  // namespace

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::vector<std::string> lines;
  for (const std::vector<std::string>& row : rows) {
    std::string& line = lines.emplace_back();
    for (std::size_t k = 0; k < row.size(); ++k)
      line += k == 0 ? fmt::format("{:<{}}", row[k], widths[k]) : fmt::format("  {:>{}}", row[k], widths[k]);
  }
  return lines;
}

void print_table(const lab::Table& table) {
  std::vector<std::vector<std::string>> rows = {table.columns};
  for (const std::vector<lab::Cell>& cells : table.rows) {
    std::vector<std::string>& row = rows.emplace_back();
    for (std::size_t k = 0; k < cells.size(); ++k) row.push_back(shown(cells[k], table.columns[k]));
  }
  for (const std::string& line : aligned(rows)) fmt::print("  {}\n", line);
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
