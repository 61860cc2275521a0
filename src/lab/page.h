#pragma once
// The page that measurements leave: one HTML file that needs nothing but a browser. It carries the results
// as JSON and draws its plots from them (src/lab/page, with the libraries of third_party), so that a number
// on the page is the number in the JSON.

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/image.h"

namespace binosplat::gl {
class Context;
}

namespace binosplat::lab {

/// A number, a text or nothing; a number that is not finite is shown as nothing.
struct Cell {
  Cell(std::nullptr_t = nullptr) {}
  Cell(bool yes) : value(yes) {}
  template <std::integral T>
  Cell(T whole) : value(static_cast<std::int64_t>(whole)) {}
  Cell(double number) : value(number) {}
  Cell(const char* text) : value(text) {}
  Cell(std::string text) : value(std::move(text)) {}
  template <typename T>
  Cell(const std::optional<T>& some) : Cell(some ? Cell(*some) : Cell()) {}
  bool operator==(const Cell&) const = default;

  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string> value;
};

void to_json(nlohmann::ordered_json& json, const Cell& cell);

std::vector<Cell> row(const auto&... cells) { return {Cell(cells)...}; }

/// Rows of as many cells as there are columns.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;

  bool operator==(const Table&) const = default;
};

/// What a chart draws of a table, by the names of its columns. A series is the rows that have the same text
/// in `by` (without it: all rows), for each of the columns of `y`. Cells that are no numbers are left out;
/// where they are the only `y`, the page says so.
struct Chart {
  std::string x;
  std::vector<std::string> y;
  std::string by = {};
  std::string label = {};               // of a point, for whoever points at it
  std::string filled = {};              // points are filled where this column is "yes", else hollow
  std::string title = {};               // of the axis up; otherwise the first of `y`
  std::vector<std::string> order = {};  // texts in `by` whose series come first
  bool bars = false;                    // horizontal, stacked by series, over names in `x`
  bool zero = false;                    // the axis up begins at 0
  bool areas = false;                   // stacked by series, over numbers in `x`
  bool line = true;                     // the points of a series are joined in their order,
  bool steps = false;                   // by steps: a value holds until the next
  bool dots = true;
  bool front = false;                 // one more line by steps through the points that are filled
  std::string spread = {};            // how far a point may lie to the left and right: a bar
  bool log_x = false, log_y = false;  // only values above 0 can be drawn
};

/// A small picture, drawn as large as there is room.
struct Figure {
  std::string caption;
  Image image;  // RGB, grey or with alpha
};

/// A picture by whole factors smaller, so that a page can hold many: at most `widest` px wide.
Image for_page(const Image& image, int widest = 640);

/// The GPU and its driver, for the page's facts.
std::string device_text(const gl::Context& context);

/// One heading of the page: what it shows on this scene, in a sentence, then the chart and the table.
struct Section {
  std::string id;  // of the link to it and of the chart's SVG
  std::string title;
  std::string sentence;
  std::optional<Table> table = {};
  std::optional<Chart> chart = {};
  std::optional<Table> numbers = {};  // what the chart draws, folded away; without it the chart is of `table`
  std::string problem = {};           // why there is nothing to show
  std::vector<Figure> figures = {};
  bool compared = false;  // the figures are of one size: two lie on each other, with a slider between them
};

struct Page {
  std::string title;
  std::string sentence;
  std::vector<std::pair<std::string, Cell>> facts;  // scene, device, date
  std::vector<Section> sections;
};

/// The whole file, with everything that was measured, which it offers to save. Light and dark, readable at
/// 400 px and printed; colours are told apart by everyone, and never alone. Throws std::logic_error for a
/// table whose rows do not fit its columns, and for a chart of columns that are not there.
std::string html(const Page& page, const nlohmann::ordered_json& data);

/// Writes it whole or not at all. Throws Error where that fails.
void save_page(const std::filesystem::path& path, const Page& page, const nlohmann::ordered_json& data);

}  // namespace binosplat::lab
