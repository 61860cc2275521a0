#include "study/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/output_file.h"
#include "study/embedded.h"

namespace binosplat::study {

using nlohmann::ordered_json;

ordered_json to_json(const Cell& cell) {
  return std::visit([](const auto& value) { return ordered_json(value); }, cell.value);
}

std::string json_text(double number) { return ordered_json(number).dump(); }

namespace {

ordered_json to_json(const Axis& axis) {
  return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}, {"categories", axis.categories}};
}

ordered_json to_json(const Series& series) {
  ordered_json json = {
      {"name", series.name}, {"line", series.line}, {"step", series.step}, {"dots", series.dots}};
  json["points"] = ordered_json::array();
  for (const Point& p : series.points) {
    ordered_json point = {{"y", p.y}, {"label", p.label}, {"marked", p.marked}};
    std::visit([&](const auto& x) { point["x"] = x; }, p.x);
    json["points"].push_back(std::move(point));
  }
  return json;
}

ordered_json to_json(const Plot& plot) {
  ordered_json json = {
      {"kind", plot.bars ? "bars" : "curves"}, {"x", to_json(plot.x)}, {"y", to_json(plot.y)}};
  json["series"] = ordered_json::array();
  for (const Series& series : plot.series) json["series"].push_back(to_json(series));
  return json;
}

ordered_json to_json(const Table& table) {
  ordered_json json = {{"columns", table.columns}, {"rows", ordered_json::array()}};
  for (const std::vector<Cell>& row : table.rows) {
    ordered_json& cells = json["rows"].emplace_back(ordered_json::array());
    for (const Cell& cell : row) cells.push_back(to_json(cell));
    if (row.size() != table.columns.size()) {
      throw std::logic_error(fmt::format("a table of {} columns has a row of {}: {}", table.columns.size(),
                                         row.size(), cells.dump()));
    }
  }
  return json;
}

ordered_json to_json(const Page& page, const ordered_json& data) {
  ordered_json json = {{"title", page.title}, {"sentence", page.sentence}};
  json["facts"] = ordered_json::array();
  for (const auto& [name, value] : page.facts)
    json["facts"].push_back(ordered_json::array({ordered_json(name), to_json(value)}));
  json["sections"] = ordered_json::array();
  for (const Section& section : page.sections) {
    ordered_json one = {{"id", section.id},
                        {"title", section.title},
                        {"sentence", section.sentence},
                        {"problem", section.problem}};
    if (section.plot) one["plot"] = to_json(*section.plot);
    if (section.table) one["table"] = to_json(*section.table);
    json["sections"].push_back(std::move(one));
  }
  json["data"] = data;
  return json;
}

// As text of a script element, which ends at the first "</script" whatever it is quoted in.
std::string for_script(const ordered_json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, ordered_json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

void Series::add(std::variant<double, std::string> x, double y, std::string point, bool marked) {
  points.push_back({std::move(x), y, std::move(point), marked});
}

void add_part(Plot& bars, const std::string& bar, const std::string& part, double value) {
  auto found = std::find_if(bars.series.begin(), bars.series.end(),
                            [&](const Series& series) { return series.name == part; });
  if (found == bars.series.end()) found = bars.series.insert(found, {part, {}});
  found->add(bar, value);
}

std::string html(const Page& page, const ordered_json& data) {
  const auto& ours = page_files();
  const auto& others = third_party_files();
  std::string out = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n";
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += "<meta name=\"generator\" content=\"binosplat\">\n";
  out += "<title>" + escaped(page.title) + "</title>\n";
  out += "<style id=\"style\">\n" + ours.at("page.css") + "</style>\n";
  out += "<main></main>\n";
  out +=
      "<noscript><p>The plots on this page are drawn by JavaScript, which is switched off "
      "here.</p></noscript>\n";
  out += "<script type=\"application/json\" id=\"page\">" + for_script(to_json(page, data)) + "</script>\n";
  for (const auto& [folder, bundle] :
       {std::pair{"d3/", "d3.min.js"}, std::pair{"plot/", "plot.umd.min.js"}}) {
    const std::string at = folder;
    out += "<script>\n/*\n" + others.at(at + "LICENSE") + "*/\n" + others.at(at + bundle) + "</script>\n";
  }
  return out + "<script>\n" + ours.at("page.js") + "</script>\n</html>\n";
}

void save_page(const std::filesystem::path& path, const Page& page, const ordered_json& data) {
  OutputFile file(path);
  file.write(html(page, data));
  file.commit();
}

}  // namespace binosplat::study
