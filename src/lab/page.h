#pragma once
// The page of a measurement: one HTML file that works in any browser. It contains the results as JSON and
// plots them (src/lab/page, with libraries of third_party), so the page and the JSON have equal numbers.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"

namespace binosplat::gl {
class Context;
}

namespace binosplat::lab {

/// A number, a text or nothing. Non-finite numbers are shown as nothing.
using Cell = nlohmann::ordered_json;

/// Empty optionals become cells with nothing.
std::vector<Cell> row(const auto&... cells) {
  const auto cell_of = [](const auto& value) -> Cell {
    if constexpr (requires { value.has_value(); }) {
      return value ? Cell(*value) : Cell();
    } else {
      return value;
    }
  };
  return {cell_of(cells)...};
}

/// Each row has as many cells as there are columns.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;

  bool operator==(const Table&) const = default;
};

/// Describes how a chart draws a table, whose columns it names. Each column of `y` makes one series for each
/// text in the column `by`, or a single series if `by` is empty. Cells without a number are skipped; if no
/// column of `y` has numbers, the page says so.
struct Chart {
  std::string x;
  std::vector<std::string> y;
  std::string by = {};
  std::string label = {};               // column with the text of a point's tooltip
  std::string filled = {};              // column; points are filled if it is "yes", else hollow
  std::string title = {};               // title of the value axis; empty: the first of `y`
  std::vector<std::string> order = {};  // texts in `by` whose series come first
  bool bars = false;                    // draws a horizontal bar per name in `x`, stacked by series
  bool zero = false;                    // the vertical axis starts at 0
  bool areas = false;                   // draws areas over the numbers in `x`, stacked by series
  bool line = true;                     // joins the points of a series in their order
  bool steps = false;                   // lines have steps: a value holds until the next point
  bool dots = true;
  bool front = false;                 // adds a stepped line through the best of the filled points
  std::string spread = {};            // column with half the length of a horizontal error bar
  bool log_x = false, log_y = false;  // logarithmic axes, which skip values of 0 and less
};

/// A small picture, scaled up to the available width.
struct Figure {
  std::string caption;
  Image image;  // RGB, grey or with alpha
};

/// Returns the picture, reduced by an integer factor to at most `widest` px, so that pages can hold many.
Image for_page(const Image& image, int widest = 640);

std::string device_text(const gl::Context& context);

struct Section {
  std::string id;  // for links and the chart's SVG
  std::string title;
  std::string sentence;
  std::optional<Table> table = {};
  std::optional<Chart> chart = {};
  std::optional<Table> numbers = {};  // the chart's data, shown collapsed; none: the chart draws `table`
  std::string problem = {};           // why there are no results
  std::vector<Figure> figures = {};
  bool compared = false;  // overlays two figures at a time, with a slider; all must have one size
};

struct Page {
  std::string title;
  std::string sentence;
  std::vector<std::pair<std::string, Cell>> facts;  // such as scene and device, with their names
  std::vector<Section> sections;
};

/// Returns the complete file. It contains `data`, which a button saves as JSON. It supports light and dark
/// mode, widths from 400 px on, and print. Colours are safe for colour-blind readers, and series also differ
/// by symbol and dash. Throws std::logic_error if a row has more or fewer cells than there are columns, or
/// if a chart names an unknown column.
std::string html(const Page& page, const nlohmann::ordered_json& data);

/// Writes the page completely, or throws Error and writes no page.
void save_page(const std::filesystem::path& path, const Page& page, const nlohmann::ordered_json& data);

}  // namespace binosplat::lab
