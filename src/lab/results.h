#pragma once
// The results of measurements as rows of named values. results.csv, results.json, report.html, terminals and
// comparisons share them; docs/measuring.md defines each column.

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "lab/fields.h"
#include "lab/page.h"
#include "measure/metrics.h"

namespace binosplat::lab {

using measure::equal_db;

double capped(double db);
/// Returns the PSNR of several pictures together, at most equal_db. `db` has each picture's PSNR.
double pooled_db(const std::vector<double>& db);

/// NaN if the row has no number of that name; "a/b" is b of the object a.
double number(const Row& row, const std::string& name);
/// "" if the row has no text of that name.
std::string text(const Row& row, const std::string& name);
std::vector<double> numbers(const std::vector<Row>& rows, const std::string& name);
/// Mean of a column's numbers; NaN without any.
double mean_number(const std::vector<Row>& rows, const std::string& name);

/// Convert between the name of a stage and the column of its GPU time.
std::string stage_column(const std::string& stage);
std::optional<std::string> stage_of(const std::string& column);

/// The heading of a column, with its unit. Other names are their own headings.
std::string title_of(const std::string& column);
/// A value as people read it, with its column's digits; "-" if it is not known.
std::string shown(const Row& row, const std::string& name);

/// The lines of a table, with headings: numbers aligned right, texts left. Omits columns that no row has.
std::vector<std::string> table_lines(const std::vector<Row>& rows, const std::vector<std::string>& wanted);
/// The rows "median", "mean" and "worst" of the columns of numbers; the first column has these names.
std::vector<Row> summary_of(const std::vector<Row>& rows, const std::vector<std::string>& wanted);

/// The columns that occur in any row, in the order of lab/columns.h. Omits columns of lists.
std::vector<std::string> columns_of(std::span<const Row> rows);
/// Those that the terminal shows of each point.
std::vector<std::string> terminal_columns();

/// The wanted columns under their titles. Omits columns that no row has.
Table table_of(std::span<const Row> rows, const std::vector<std::string>& wanted);

/// CSV, for spreadsheets: a line of column names, if there are any, then a line per row. Texts are quoted.
/// Numbers that are not finite become empty cells.
std::string csv(const Table& table);
std::string csv(std::span<const Row> rows);

/// A point. `row` has its identity (scene, case, settings), then its results or a
/// "problem". Each of `details` describes a view, a frame or the like; its column "kind" names this kind.
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
  std::string suite, program;  // name of the suite, version of the program
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
