#include "lab/csv.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::lab {

namespace {

/// Takes a cell from the front of a line, with the comma after it; nothing where it is neither number nor
/// text.
std::optional<Cell> take_cell(std::string_view& line) {
  Cell cell;
  if (line.starts_with('"')) {
    std::string text;
    for (line.remove_prefix(1);; line.remove_prefix(1)) {
      if (line.empty()) return std::nullopt;
      const bool is_quote = line.front() == '"';
      if (is_quote && !line.substr(1).starts_with('"')) break;
      text += line.front();
      if (is_quote) line.remove_prefix(1);
    }
    line.remove_prefix(1);
    cell = text;
  } else if (line.starts_with("true") || line.starts_with("false")) {
    cell = line.front() == 't';
    line.remove_prefix(line.front() == 't' ? 4 : 5);
  } else if (!line.empty() && line.front() != ',') {
    const std::optional<double> number = take_real(line);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    cell = *number;
  }
  if (!line.empty() && line.front() != ',') return std::nullopt;
  return cell;
}

std::vector<Cell> cells_of(std::string_view line, const std::string& place) {
  std::vector<Cell> cells;
  for (;;) {
    std::optional<Cell> cell = take_cell(line);
    if (!cell)
      fail("{}: expected a number or a text in quotes in column {}; is it the frames.csv of a profile?",
           place, cells.size() + 1);
    cells.push_back(*std::move(cell));
    if (line.empty()) return cells;
    line.remove_prefix(1);
  }
}

}  // namespace

std::string csv_field(const Cell& cell) {
  const auto* const text = std::get_if<std::string>(&cell.value);
  const std::string bare = text == nullptr ? nlohmann::ordered_json(cell).dump() : *text;
  if (text == nullptr) return bare == "null" ? "" : bare;
  if (bare.empty()) return "";
  std::string quoted = "\"";
  for (const char c : bare) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv(const Table& table) {
  std::string text;
  const auto end_line = [&] { text.back() = '\n'; };
  for (const std::string& name : table.columns) text += name + ",";
  if (!table.columns.empty()) end_line();
  for (const std::vector<Cell>& row : table.rows) {
    for (const Cell& cell : row) text += csv_field(cell) + ",";
    end_line();
  }
  return text;
}

Table read_csv(std::string_view text, const std::string& place) {
  Table table;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // as some editors begin UTF-8
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::string at = fmt::format("{}:{}", place, number);
    if (number == 1) {
      for (std::size_t comma = 0; comma != std::string_view::npos;
           line.remove_prefix(std::min(comma + 1, line.size()))) {
        comma = line.find(',');
        table.columns.emplace_back(line.substr(0, comma));
        if (comma == std::string_view::npos) break;
      }
      continue;
    }
    table.rows.push_back(cells_of(line, at));
    if (table.rows.back().size() != table.columns.size())
      fail("{}: {} cells under {} names", at, table.rows.back().size(), table.columns.size());
  }
  return table;
}

}  // namespace binosplat::lab
