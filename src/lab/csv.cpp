#include "lab/csv.h"

#include <nlohmann/json.hpp>

namespace binosplat::lab {

namespace {

std::string csv_field(const Cell& cell) {
  const auto* const text = std::get_if<std::string>(&cell.value);
  const std::string bare = text == nullptr ? nlohmann::ordered_json(cell).dump() : *text;
  if (text == nullptr) return bare == "null" ? "" : bare;
  if (bare.empty()) return "";
  std::string quoted = "\"";
  for (const char c : bare) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

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

}  // namespace binosplat::lab
