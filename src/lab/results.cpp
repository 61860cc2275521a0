#include "lab/results.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/statistics.h"
#include "lab/csv.h"
#include "lab/fields.h"

namespace binosplat::lab {

namespace {

struct Column {
  const char *name, *title;
};

/// All columns, in the order of the files. The columns before `family` identify a point.
constexpr Column columns[] = {
    {"scene", "scene"},
    {"eyes", "eyes"},
    {"size", "size"},
    {"along", "along"},
    {"tiles", "tiles"},
    {"precision", "precision"},
    {"th", "th"},
    {"transmittance", "transmittance"},
    {"tolerance", "tolerance"},
    {"quality", "requested dB"},
    {"far", "end of depth table"},
    {"max_drop", "max drop dB"},
    {"min_psnr", "min PSNR dB"},
    {"found_on", "tolerance from"},
    {"inset", "inset degrees"},
    {"context", "context"},
    {"order", "order"},
    {"projection", "projection"},
    {"detail", "detail"},
    {"name", "setting"},
    {"family", "family"},
    {"of", "of"},
    {"view", "view"},
    {"stretch", "stretch"},
    {"frame", "frame"},
    {"part", "part"},
    {"about", "about"},
    {"degrees", "degrees"},
    {"by", "by"},
    {"from", "from"},
    {"to", "to"},
    {"share", "share %"},
    {"device", "device"},
    {"problem", "problem"},
    {"no_exact", "why not compared"},
    {"pareto", "front"},
    {"frame_ms", "frame ms"},
    {"speed", "speed vs exact"},
    {"p99_ms", "p99 ms"},
    {"most_ms", "most ms"},
    {"noise_ms", "noise ms"},
    {"wall_ms", "wall ms"},
    {"wall_p99_ms", "wall p99 ms"},
    {"wall_most_ms", "wall most ms"},
    {"cpu_ms", "CPU ms"},
    {"waited", "waited for the CPU %"},
    {"submit_ms", "submit ms"},
    {"missed", "missed"},
    {"fps", "frames a second"},
    {"bound", "bound"},
    {"clock", "clock"},
    {"try", "to try"},
    {"reason", "reason"},
    {"frames", "frames"},
    {"settled", "clock settled"},
    {"pairs", "pairs"},
    {"pairs_removed", "pairs removed %"},
    {"gaussians", "Gaussians"},
    {"visible", "in view"},
    {"gpu_bytes", "GPU bytes"},
    {"alphas", "alphas a pixel"},
    {"alphas_visible", "blended a pixel"},
    {"exact", "exact"},
    {"exact_frames", "exact frames %"},
    {"unmeasured", "unmeasured %"},
    {"no_gain", "no gain %"},
    {"psnr_db", "PSNR dB"},
    {"tenth_psnr_db", "tenth dB"},
    {"worst_psnr_db", "worst dB"},
    {"worst_view", "worst view"},
    {"stop_psnr_db", "stop dB"},
    {"equal_frames", "equal frames"},
    {"ssim", "SSIM"},
    {"flip", "FLIP"},
    {"signed_error", "signed error"},
    {"disagreement_db", "disagreement dB"},
    {"reported_db", "reported dB"},
    {"reported_minus_true_db", "reported minus true dB"},
    {"reported_farthest_db", "farthest dB"},
    {"popping_1_db", "1 frame apart dB"},
    {"popping_1_flip", "1 apart FLIP"},
    {"popping_7_db", "7 frames apart dB"},
    {"popping_7_flip", "7 apart FLIP"},
    {"rays", "rays"},
    {"rays_off", "rays off by 5/255 %"},
    {"seen", "seen %"},
    {"photo_views", "views with photos"},
    {"photo_psnr_db", "against photos dB"},
    {"drop_db", "drop dB"},
    {"photo_ssim", "photo SSIM"},
    {"photo_flip", "photo FLIP"},
    {"found_tolerance", "tolerance found"},
    {"found_db", "dB in the search"},
    {"fragments", "fragments"},
    {"mean", "mean"},
    {"median", "median"},
    {"p90", "90 of 100 below"},
    {"largest", "largest"},
    {"nearer", "of all, nearer %"},
    {"upper", "T_upper"},
};

constexpr std::string_view stage_prefix = "stage_", ms_suffix = "_ms";

Cell cell_of(const Row& row, const std::string& name) {
  const auto found = row.find(name);
  if (found == row.end()) return {};
  if (found->is_boolean()) return found->get<bool>();
  if (found->is_number_integer()) return found->get<std::int64_t>();
  if (found->is_number()) return found->get<double>();
  return found->is_string() ? Cell(found->get<std::string>()) : Cell();
}

bool is_on_front(const std::vector<Point>& points, const Point& point) {
  const double ms = number(point.row, "frame_ms"), db = number(point.row, "psnr_db");
  if (!(ms > 0.0) || std::isnan(db)) return false;
  return std::ranges::none_of(points, [&](const Point& other) {
    const double quicker = ms - number(other.row, "frame_ms"), nearer = number(other.row, "psnr_db") - db;
    return other.chart() == point.chart() && quicker >= 0.0 && nearer >= 0.0 && quicker + nearer > 0.0;
  });
}

Row without_lists(const Row& row) {
  Row plain = Row::object();
  for (const auto& [name, value] : row.items()) {
    if (!value.is_array()) plain[name] = value;
  }
  return plain;
}

}  // namespace

double number(const Row& row, const std::string& name) {
  const auto found = row.find(name);
  return found != row.end() && found->is_number() ? found->get<double>() : NAN;
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
  const auto found = std::ranges::find(columns, column, &Column::name);
  if (found != std::end(columns)) return found->title;
  const std::optional<std::string> stage = stage_of(column);
  return stage ? *stage + " ms" : column;
}

std::vector<std::string> all_columns() {
  std::vector<std::string> names;
  for (const Column& column : columns) names.emplace_back(column.name);
  return names;
}

std::vector<std::string> columns_of(std::span<const Row> rows) {
  std::set<std::string> there;
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
      Cell cell = cell_of(row, name);
      if (const bool* const yes = std::get_if<bool>(&cell.value)) cell = *yes ? "yes" : "";
      cells.push_back(std::move(cell));
    }
  }
  return table;
}

std::string csv(std::span<const Row> rows) {
  Table table{columns_of(rows), {}};
  for (const Row& row : rows) {
    std::vector<Cell>& cells = table.rows.emplace_back();
    for (const std::string& name : table.columns) cells.push_back(cell_of(row, name));
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
    if (std::string_view(column.name) == "family") break;
    if (row.contains(column.name)) identity[column.name] = row[column.name];
  }
  return identity;
}

const Point* exact_of(const std::vector<Point>& points, const Point& point) {
  for (const Point& other : points) {
    const Row& row = other.row;
    const bool exact = text(row, "th") == "tau" && text(row, "tiles") == "ellipse" &&
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
    put(row, "name", text(rows.front(), "name"), "family", text(rows.front(), "family"), "device",
        text(rows.front(), "device"), "speed", std::exp(logarithms));
    for (const char* name : {"psnr_db", "drop_db", "pairs_removed", "flip"})
      put(row, name, mean_number(rows, name));
  }
  points.insert(points.end(), means.begin(), means.end());
}

nlohmann::ordered_json to_json(const Results& results, nlohmann::ordered_json plan) {
  nlohmann::ordered_json json = {{"format", "binosplat results"}, {"version", 2}, {"plan", std::move(plan)}};
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
  if (json.value("version", 0) != 2) wrong("its version is another: measure again");
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
  for (const Point& point : points) rows.push_back(without_lists(point.row));
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
      row.update(without_lists(detail));
    }
  }
  return csv(rows);
}

}  // namespace binosplat::lab
