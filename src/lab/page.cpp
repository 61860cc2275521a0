#include "lab/page.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "base/output_file.h"
#include "base/text.h"
#include "formats/pictures/image_file.h"
#include "gl/context.h"
#include "lab/embedded.h"
#include "lab/fields.h"

namespace binosplat::lab {

using nlohmann::ordered_json;

static void fields(const auto& io, const Table& t) { io("columns", t.columns, "rows", t.rows); }

static void fields(const auto& io, const Figure& f) {
  io("caption", f.caption, "width", f.image.width, "height", f.image.height, "png",
     base64(png_bytes(f.image)));
}

static void fields(const auto& io, const Chart& c) {
  io("x", c.x, "y", c.y, "by", c.by, "label", c.label, "filled", c.filled, "title", c.title, "order", c.order,
     "bars", c.bars, "zero", c.zero, "areas", c.areas, "line", c.line, "steps", c.steps, "dots", c.dots,
     "front", c.front, "spread", c.spread, "log_x", c.log_x, "log_y", c.log_y);
}

static void fields(const auto& io, const Section& s) {
  io("id", s.id, "title", s.title, "sentence", s.sentence, "problem", s.problem, "chart", s.chart, "table",
     s.table, "numbers", s.numbers, "figures", s.figures, "compared", s.compared);
}

namespace {

void check(const Table& t) {
  for (const std::vector<Cell>& row : t.rows) {
    if (row.size() != t.columns.size()) {
      throw std::logic_error(fmt::format("a table of {} columns has a row of {}: {}", t.columns.size(),
                                         row.size(), ordered_json(row).dump()));
    }
  }
}

// html() checks before it makes JSON, because an exception during the conversion would leak memory.
void check(const Section& s) {
  for (const auto* table : {&s.table, &s.numbers}) {
    if (*table) check(**table);
  }
  if (!s.chart) return;
  const std::vector<std::string>& columns = (s.numbers ? s.numbers : s.table).value().columns;
  std::vector<std::string> named = {s.chart->x, s.chart->by, s.chart->label, s.chart->filled};
  named.insert(named.end(), s.chart->y.begin(), s.chart->y.end());
  for (const std::string& name : named) {
    if (!name.empty() && std::ranges::find(columns, name) == columns.end())
      throw std::logic_error(fmt::format("{}: a chart of a column '{}', which is not there", s.id, name));
  }
}

std::string replaced(const std::string& text, char what, const std::string& by) {
  std::string out;
  for (const char c : text) c == what ? out += by : out += c;
  return out;
}

// JSON for a script element. Escapes "<", because "</script" ends the element even within quotes.
std::string for_script(const ordered_json& json) {
  return replaced(json.dump(-1, ' ', false, ordered_json::error_handler_t::replace), '<', "\\u003c");
}

}  // namespace

Image for_page(const Image& image, int widest) {
  const int by = (image.width + widest - 1) / widest;
  Image small(image.width / by, std::max(1, image.height / by), image.channels);
  for (int y = 0; y < std::min(small.height * by, image.height); ++y) {
    for (int x = 0; x < small.width * by; ++x) {
      for (int c = 0; c < image.channels; ++c)
        small.at(x / by, y / by, c) += image.at(x, y, c) / static_cast<float>(by * by);
    }
  }
  return small;
}

std::string device_text(const gl::Context& context) {
  return fmt::format("{}, OpenGL {}", context.renderer(), context.version());
}

std::string html(const Page& page, const ordered_json& data) {
  for (const Section& section : page.sections) check(section);
  const auto& ours = page_files();
  const auto& others = third_party_files();
  std::string out = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n";
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += "<meta name=\"generator\" content=\"binosplat\">\n";
  out += "<title>" + replaced(replaced(page.title, '&', "&amp;"), '<', "&lt;") + "</title>\n";
  out += "<style id=\"style\">\n" + ours.at("page.css") + "</style>\n";
  out += "<main></main>\n";
  out +=
      "<noscript><p>The plots on this page are drawn by JavaScript, which is switched off "
      "here.</p></noscript>\n";
  out += "<script type=\"application/json\" id=\"page\">" +
         for_script(object("title", page.title, "sentence", page.sentence, "facts", page.facts, "sections",
                           page.sections, "data", data)) +
         "</script>\n";
  for (const auto& [folder, bundle] :
       {std::pair{"d3/", "d3.min.js"}, std::pair{"plot/", "plot.umd.min.js"}}) {
    const std::string at = folder;
    out += "<script>\n/*\n" + others.at(at + "LICENSE") + "*/\n" + others.at(at + bundle) + "</script>\n";
  }
  return out + "<script>\n" + ours.at("page.js") + "</script>\n</html>\n";
}

void save_page(const std::filesystem::path& path, const Page& page, const ordered_json& data) {
  write_file(path, html(page, data));
}

}  // namespace binosplat::lab
