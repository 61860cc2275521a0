#pragma once
// The results of measurements as rows of named values. results.csv, results.json, report.html, terminals and
// comparisons share them; docs/measuring.md defines each column.

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

/// The PSNR in dB that means, charts and files use for equal pictures, whose true PSNR is infinite.
constexpr double equal_db = 100.0;

double capped(double db);
/// Returns the PSNR of several pictures together, at most equal_db. `db` has each picture's PSNR.
double pooled_db(const std::vector<double>& db);

/// A JSON object of values by column name. Unknown values are absent.
using Row = nlohmann::ordered_json;

/// Sets values by name. Omits empty optionals and non-finite numbers.
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

Row row_of(const auto&... names_and_values) {
  Row row = Row::object();
  put(row, names_and_values...);
  return row;
}

/// NaN if the row has no number of that name.
double number(const Row& row, const std::string& name);
/// "" if the row has no text of that name.
std::string text(const Row& row, const std::string& name);
std::vector<double> numbers(const std::vector<Row>& rows, const std::string& name);
/// Mean of a column's numbers; NaN without any.
double mean_number(const std::vector<Row>& rows, const std::string& name);

/// Convert between the name of a stage and the column of its GPU time.
std::string stage_column(const std::string& stage);
std::optional<std::string> stage_of(const std::string& column);

std::string title_of(const std::string& column);

/// The columns that occur in any row, in the order of `columns` in results.cpp. Omits columns of lists.
std::vector<std::string> columns_of(std::span<const Row> rows);
/// All known columns except those of stages.
std::vector<std::string> all_columns();

/// The wanted columns under their titles. Omits columns that no row has.
Table table_of(std::span<const Row> rows, const std::vector<std::string>& wanted);

/// CSV with a line per row and a column per name.
std::string csv(std::span<const Row> rows);

/// A point. `row` has its identity (scene, case, settings), then its results or a
/// "problem". Each of `details` describes a view, a frame or the like; its column "of" names this kind.
struct Point {
  Row row = Row::object();
  std::vector<Row> details = {};
  std::optional<Image> picture = {};  // from for_page(); not in JSON

  bool tried() const { return row.contains("device"); }
  bool measured() const { return tried() && !row.contains("problem"); }
  /// The name of the chart in which the point is compared, as in "fox, one eye, size own, along views".
  std::string chart() const;
};

struct Results {
  std::string axes, program;  // name of the axes, version of the program
  std::vector<Point> points;
};

/// The part of a row that identifies its point, known before it is measured.
Row identity_of(const Row& row);

/// Adds values relative to other points of a chart. "pareto": no other point is at least as fast by its mean
/// time and as accurate, and better in one of both. "speed": the exact point's time divided by this point's.
void add_relative_columns(std::vector<Point>& points);
/// The exact point, at the finest levels, of the same chart, order and projection; null if not measured.
const Point* exact_of(const std::vector<Point>& points, const Point& point);

/// If there are several scenes, adds a point for each setting that all scenes have, with the geometric mean
/// of "speed", and arithmetic means of losses and removed pairs.
void add_means(std::vector<Point>& points);

/// Convert all rows with their details to JSON and back. rows_of() throws Error, which begins with `place`,
/// for a file of another kind.
nlohmann::ordered_json to_json(const Results& results, nlohmann::ordered_json plan);
std::vector<Row> rows_of(const nlohmann::ordered_json& json, const std::string& place);

/// The text of results.csv, and that of details.csv, whose rows begin with their point's case and name.
std::string csv(const std::vector<Point>& points);
std::string details_csv(const std::vector<Point>& points);

/// The page with all charts that the rows' columns allow.
Page results_page(const Results& results);

struct RunComparison {
  std::vector<std::string> lines;  // changes beyond noise, failed comparisons, and last a count of changes
  std::size_t matched = 0;         // points in both runs
  std::size_t timed = 0;           // matched points with comparable times
  double slower_percent = 0.0;     // largest slowdown beyond noise; 0: none
  std::string slowest;             // the point of that slowdown
};

/// Matches points by identity, and repeats by index. A time has changed if it differs by more than 2 % and by
/// more than the scatter of repeats explains: Student's t, with one false alarm in a hundred pairs of equal
/// runs. The scatter is that of all points, or the point's own if larger. On a CPU, compares CPU time, which
/// must also differ by more than the share of time that threads waited for other programs. A PSNR has changed
/// if it differs by more than 0.01 dB, a number of pairs by more than 0.1 %.
RunComparison compare_runs(const std::vector<Row>& before, const std::vector<Row>& now);

}  // namespace binosplat::lab
