#pragma once
// What was measured: rows of values under names. results.csv, results.json, report.html, terminals and
// comparisons share them; docs/measuring.md says how each is found.

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "lab/page.h"

namespace binosplat::lab {

/// The PSNR in dB that stands for equal pictures, which have none: in means, charts and files.
constexpr double equal_db = 100.0;

double capped(double db);
/// The PSNR of pictures together: of the mean of their squared errors; capped.
double pooled_db(const std::vector<double>& db);

/// An object of JSON: values by the names of columns. What is not known is not there.
using Row = nlohmann::ordered_json;

/// Sets values by name; those that are empty or not numbers are left out.
template <typename T, typename... Rest>
void put(Row& row, const std::string& name, const T& value, const Rest&... rest) {
  if constexpr (requires { value.has_value(); }) {
    if (value) put(row, name, *value);
  } else if constexpr (std::is_floating_point_v<T>) {
    if (std::isfinite(value)) row[name] = static_cast<double>(value);
  } else {
    row[name] = value;
  }
  if constexpr (sizeof...(rest) > 0) put(row, rest...);
}

/// A row of names and values.
Row row_of(const auto&... names_and_values) {
  Row row = Row::object();
  put(row, names_and_values...);
  return row;
}

/// NaN where the row has no number of that name.
double number(const Row& row, const std::string& name);
/// "" where it has no text of that name.
std::string text(const Row& row, const std::string& name);
/// The numbers that rows have under a name.
std::vector<double> numbers(const std::vector<Row>& rows, const std::string& name);
/// Their mean; NaN where no row has one.
double mean_number(const std::vector<Row>& rows, const std::string& name);

/// The name of a stage's GPU time, and the stage of such a name.
std::string stage_column(const std::string& stage);
std::optional<std::string> stage_of(const std::string& column);

/// What readers see over a column.
std::string title_of(const std::string& column);

/// The columns that any of the rows has, in the order of docs/measuring.md; lists have none.
std::vector<std::string> columns_of(std::span<const Row> rows);
/// Every column there is, but those of stages.
std::vector<std::string> all_columns();

/// Some columns of rows for readers, under their titles; those that no row has are left out.
Table table_of(std::span<const Row> rows, const std::vector<std::string>& wanted);

/// A line a row, a column a name.
std::string csv(std::span<const Row> rows);

/// Something that was measured, or is to be: `row` has what tells it from others (the scene, what is drawn of
/// it, the settings) and then what was measured on the whole, or a "problem"; `details` are of views, frames
/// and the like, which "of" names.
struct Point {
  Row row = Row::object();
  std::vector<Row> details = {};
  std::optional<Image> picture = {};  // for_page(); not in JSON

  bool tried() const { return row.contains("device"); }
  bool measured() const { return tried() && !row.contains("problem"); }
  /// What points that are compared with one another have in common: "fox, one eye, size own, views".
  std::string chart() const;
};

struct Results {
  std::string axes, program;  // of the plan: their name, its version
  std::vector<Point> points;
};

/// What of a row says which point it is: all that is known before it is measured.
Row identity_of(const Row& row);

/// Adds what a point is beside others of its chart: "pareto", true where none is quicker by more than noise
/// and no farther from exact; and "speed", how many times as fast it is as the exact picture.
void put_beside_others(std::vector<Point>& points);
/// The exact point of the same chart and order, projection and level of detail; none where it was not
/// measured.
const Point* exact_of(const std::vector<Point>& points, const Point& point);

/// Of several scenes: adds what each setting comes to over all of them, the geometric mean of its "speed",
/// the mean of what it loses and removes.
void add_means(std::vector<Point>& points);

/// All rows with their details, and back. Throws Error, naming `place`, for what is no such file.
nlohmann::ordered_json to_json(const Results& results, nlohmann::ordered_json plan);
std::vector<Row> rows_of(const nlohmann::ordered_json& json, const std::string& place);

/// results.csv, and details.csv, whose rows begin with those of their points.
std::string csv(const std::vector<Point>& points);
std::string details_csv(const std::vector<Point>& points);

/// The charts that the rows allow.
Page results_page(const Results& results);

/// What changed between two runs.
struct RunComparison {
  std::vector<std::string> lines;  // of what changed beyond noise, or cannot be compared; the last one counts
  std::size_t matched = 0;         // points of both runs
  std::size_t timed = 0;           // of these: whose times were compared
  double slower_percent = 0.0;     // of what became slower by most, beyond noise; 0: nothing did
  std::string slowest;             // that
};

/// Points are matched by what tells them from others. Each repeat of a time is set beside the same repeat of
/// the older run: a time has changed when it differs by more than 2 %, and by more than these pairs scatter:
/// then one pair of equal runs in a hundred finds a change (Student's t of their scatter, over all points
/// together, or of the point's own where that is larger). Where the CPU draws, its time counts, and
/// must differ by more than the share for which threads waited while other programs had it. PSNR has changed
/// when it differs by 0.01 dB; pairs by 0.1 %.
RunComparison compare_runs(const std::vector<Row>& before, const std::vector<Row>& now);

}  // namespace binosplat::lab
