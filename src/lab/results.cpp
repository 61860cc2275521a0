#include "lab/results.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/statistics.h"
#include "lab/columns.h"

namespace binosplat::lab {

namespace {

constexpr std::string_view stage_prefix = "stage_", ms_suffix = "_ms";

/// A stage's column has a name and a title of its own, and so has a column of a command's own words.
Column column_of(const std::string& name) {
  for (const std::span<const Column> of :
       {std::span<const Column>(columns), std::span<const Column>(other_columns)}) {
    const auto found = std::ranges::find(of, name, &Column::name);
    if (found != of.end()) return *found;
  }
  return {.name = name, .title = name, .digits = 3};
}

/// Null if the row has no such value, or no number there.
Row value_of(const Row& row, const std::string& name) {
  const Row::json_pointer place("/" + name);
  Row value = row.contains(place) ? row.at(place) : Row();
  return value.is_number_float() && std::isnan(value.get<double>()) ? Row() : value;
}

std::string csv_field(const Cell& cell) {
  const std::string bare = cell.is_string() ? cell.get<std::string>() : cell.dump();
  if (!cell.is_string()) return bare == "null" ? "" : bare;
  if (bare.empty()) return "";
  std::string quoted = "\"";
  for (const char c : bare) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

bool is_on_front(const std::vector<Point>& points, const Point& point) {
  const double ms = number(point.row, "frame_ms"), db = number(point.row, "psnr_db");
  if (!(ms > 0.0) || std::isnan(db)) return false;
  return std::ranges::none_of(points, [&](const Point& other) {
    const double quicker = ms - number(other.row, "frame_ms"), nearer = number(other.row, "psnr_db") - db;
    return other.chart() == point.chart() && quicker >= 0.0 && nearer >= 0.0 && quicker + nearer > 0.0;
  });
}

}  // namespace

double number(const Row& row, const std::string& name) {
  const Row value = value_of(row, name);
  return value.is_number() ? value.get<double>() : NAN;
}

std::string text(const Row& row, const std::string& name) {
  const auto found = row.find(name);
  return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

std::vector<double> numbers(const std::vector<Row>& rows, const std::string& name) {
  std::vector<double> all;
  for (const Row& row : rows) {
    if (const double one = number(row, name); !std::isnan(one)) all.push_back(one);
  }
  return all;
}

double mean_number(const std::vector<Row>& rows, const std::string& name) {
  const std::vector<double> all = numbers(rows, name);
  return all.empty() ? NAN : mean(all);
}

double capped(double db) { return std::min(db, equal_db); }

double pooled_db(const std::vector<double>& db) {
  double squared_errors = 0.0;
  for (const double one : db) squared_errors += std::pow(10.0, -0.1 * one);
  return capped(-10.0 * std::log10(squared_errors / static_cast<double>(db.size())));
}

std::string stage_column(const std::string& stage) {
  return std::string(stage_prefix) + stage + std::string(ms_suffix);
}

std::optional<std::string> stage_of(const std::string& column) {
  if (!column.starts_with(stage_prefix) || !column.ends_with(ms_suffix)) return std::nullopt;
  return column.substr(stage_prefix.size(), column.size() - stage_prefix.size() - ms_suffix.size());
}

std::string title_of(const std::string& column) {
  if (const std::optional<std::string> stage = stage_of(column)) return *stage + " ms";
  const Column found = column_of(column);
  return fmt::format("{}{}{}", found.title, found.unit.empty() ? "" : " ", found.unit);
}

std::string shown(const Row& row, const std::string& name) {
  const Row value = value_of(row, name);
  const Column column = column_of(name);
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array()) return fmt::format("{}", fmt::join(value.get<std::vector<std::string>>(), ", "));
  const double number = value.get<double>();
  if (column.unit == "dB" && number >= equal_db) return "equal";
  if (name == "tolerance" && number == 0.0) return "exact";
  return value.is_number_integer() ? value.dump() : fmt::format("{:.{}f}", number, column.digits);
}

std::vector<std::string> table_lines(const std::vector<Row>& rows, const std::vector<std::string>& wanted) {
  std::vector<std::string> lines(rows.size() + 1);
  for (const std::string& name : wanted) {
    const auto has = [&](const Row& row) { return !value_of(row, name).is_null(); };
    if (std::ranges::none_of(rows, has)) continue;
    const bool right =
        std::ranges::any_of(rows, [&](const Row& row) { return value_of(row, name).is_number(); });
    std::vector<std::string> cells = {title_of(name)};
    for (const Row& row : rows) cells.push_back(shown(row, name));
    const std::size_t width = std::ranges::max(cells, {}, &std::string::size).size();
    for (std::size_t k = 0; k < cells.size(); ++k)
      lines[k] += fmt::format(fmt::runtime(right ? "{}{:>{}}" : "{}{:<{}}"), lines[k].empty() ? "" : "  ",
                              cells[k], width);
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  return lines;
}

std::vector<Row> summary_of(const std::vector<Row>& rows, const std::vector<std::string>& wanted) {
  std::vector<Row> summary;
  for (const char* const name : {"median", "mean", "worst"}) summary.push_back(object(wanted.front(), name));
  for (const std::string& name : wanted) {
    const std::vector<double> found = numbers(rows, name);
    if (found.empty()) continue;
    const Row::json_pointer place("/" + name);
    summary[0][place] = quantile(found, 0.5);
    summary[1][place] = mean(found);
    summary[2][place] = quantile(found, column_of(name).is_low_worst ? 0.0 : 1.0);
  }
  return summary;
}

std::vector<std::string> terminal_columns() {
  std::vector<std::string> names;
  for (const Column& column : columns) {
    if (column.is_in_terminal) names.emplace_back(column.name);
  }
  return names;
}

std::vector<std::string> columns_of(std::span<const Row> rows) {
  std::set<std::string, std::less<>> there;
  std::vector<std::string> stages, names;
  for (const Row& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (!value.is_array() && there.insert(name).second && stage_of(name)) stages.push_back(name);
    }
  }
  for (const Column& column : columns) {
    if (there.contains(column.name)) names.emplace_back(column.name);
  }
  names.insert(names.end(), stages.begin(), stages.end());
  return names;
}

Table table_of(std::span<const Row> rows, const std::vector<std::string>& wanted) {
  Table table;
  std::vector<std::string> names;
  for (const std::string& name : wanted) {
    if (std::ranges::none_of(rows, [&](const Row& row) { return row.contains(name); })) continue;
    names.push_back(name);
    table.columns.push_back(title_of(name));
  }
  for (const Row& row : rows) {
    std::vector<Cell>& cells = table.rows.emplace_back();
    for (const std::string& name : names) {
      const Cell cell = value_of(row, name);
      cells.push_back(cell.is_boolean() ? Cell(shown(row, name)) : cell);
    }
  }
  return table;
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

std::string csv(std::span<const Row> rows) {
  Table table{columns_of(rows), {}};
  for (const Row& row : rows) {
    std::vector<Cell>& cells = table.rows.emplace_back();
    for (const std::string& name : table.columns) cells.push_back(value_of(row, name));
  }
  return csv(table);
}

std::string Point::chart() const {
  const double eyes = number(row, "eyes");
  std::string all = text(row, "scene") + (eyes == 2.0 ? ", both eyes" : ", one eye");
  for (const char* name : {"size", "along"}) {
    if (row.contains(name)) all += fmt::format(", {} {}", name, text(row, name));
  }
  return all;
}

Row identity_of(const Row& row) {
  Row identity = Row::object();
  for (const Column& column : columns) {
    if (std::string_view(column.name) == "series") break;
    if (row.contains(column.name)) identity[column.name] = row[column.name];
  }
  return identity;
}

const Point* exact_of(const std::vector<Point>& points, const Point& point) {
  for (const Point& other : points) {
    const Row& row = other.row;
    const bool exact = text(row, "threshold") == "exact" && text(row, "tiles") == "ellipse" &&
                       !row.contains("precision") && !row.contains("inset") && !row.contains("detail");
    if (exact && other.measured() && other.chart() == point.chart() &&
        text(row, "order") == text(point.row, "order") &&
        text(row, "projection") == text(point.row, "projection"))
      return &other;
  }
  return nullptr;
}

void add_relative_columns(std::vector<Point>& points) {
  for (Point& point : points) {
    if (!point.measured() || !point.row.contains("frame_ms")) continue;
    point.row["pareto"] = is_on_front(points, point);
    const Point* exact = exact_of(points, point);
    if (exact != nullptr)
      put(point.row, "speed", number(exact->row, "frame_ms") / number(point.row, "frame_ms"));
  }
}

void add_means(std::vector<Point>& points) {
  std::map<std::string, std::vector<const Point*>> settings;
  std::vector<std::string> order;
  std::set<std::string> scenes;
  for (const Point& point : points) {
    scenes.insert(text(point.row, "scene"));
    if (!point.measured() || !point.row.contains("speed")) continue;
    Row key = identity_of(point.row);
    key.erase("scene");
    if (settings[key.dump()].empty()) order.push_back(key.dump());
    settings[key.dump()].push_back(&point);
  }
  if (scenes.size() < 2) return;
  std::vector<Point> means;
  for (const std::string& key : order) {
    const std::vector<const Point*>& of_scenes = settings[key];
    if (of_scenes.size() != scenes.size()) continue;
    std::vector<Row> rows;
    double logarithms = 0.0;
    for (const Point* point : of_scenes) {
      rows.push_back(point->row);
      logarithms += std::log(number(point->row, "speed")) / static_cast<double>(scenes.size());
    }
    Row& row = means.emplace_back(Point{identity_of(rows.front())}).row;
    row["scene"] = fmt::format("mean of {} scenes", scenes.size());
    put(row, "name", text(rows.front(), "name"), "series", text(rows.front(), "series"), "device",
        text(rows.front(), "device"), "speed", std::exp(logarithms));
    for (const char* name : {"psnr_db", "drop_db", "pairs_removed", "flip"})
      put(row, name, mean_number(rows, name));
  }
  points.insert(points.end(), means.begin(), means.end());
}

nlohmann::ordered_json to_json(const Results& results, nlohmann::ordered_json plan) {
  nlohmann::ordered_json json = {{"format", "binosplat results"}, {"version", 4}, {"plan", std::move(plan)}};
  json["points"] = nlohmann::ordered_json::array();
  for (const Point& point : results.points) {
    json["points"].push_back(point.row);
    if (!point.details.empty()) json["points"].back()["details"] = point.details;
  }
  return json;
}

std::vector<Row> rows_of(const nlohmann::ordered_json& json, const std::string& place) {
  const auto wrong = [&](const std::string& what) {
    fail("{}: not the results.json of a measurement of this version: {}", place, what);
  };
  if (!json.is_object() || json.value("format", "") != "binosplat results") wrong("its format is another");
  if (json.value("version", 0) != 4) wrong("its version is another: measure again");
  if (!json.contains("points") || !json["points"].is_array()) wrong("it has no list of points");
  std::vector<Row> rows;
  for (const nlohmann::ordered_json& point : json["points"]) {
    if (!point.is_object() || !point.contains("scene")) wrong("a point has no scene");
    rows.push_back(point);
  }
  return rows;
}

std::string csv(const std::vector<Point>& points) {
  std::vector<Row> rows;
  for (const Point& point : points) rows.push_back(point.row);
  return csv(rows);
}

std::string details_csv(const std::vector<Point>& points) {
  std::vector<Row> rows;
  for (const Point& point : points) {
    for (const Row& detail : point.details) {
      Row& row = rows.emplace_back(Row::object());
      for (const char* name : {"scene", "eyes", "size", "along", "name"}) {
        if (point.row.contains(name)) row[name] = point.row[name];
      }
      row.update(detail);
    }
  }
  return csv(rows);
}

}  // namespace binosplat::lab
