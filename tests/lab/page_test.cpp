#include "lab/page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lab/chromium.h"

namespace binosplat::lab {
namespace {

using nlohmann::ordered_json;
using test::TempFolder;

/// Returns a page with all elements of pages, correct and faulty.
Page sample_page() {
  Page page;
  page.title = "Speed against accuracy: fox </script> & <b>";
  page.sentence = "The quickest of 12 settings above 40 dB takes 1.25 ms.";
  page.facts = {{"scene", "fox.ply"}, {"Gaussians", 140131}, {"device", "llvmpipe (LLVM 15.0.6, 256 bits)"}};
  Table speed{{"series", "setting", "filled", "frame time ms", "PSNR dB"}, {}};
  const char* const names[] = {"aabb (3D-GS)", "obb (GSCore)", "snug (Speedy-Splat)", "ellipse (FlashGS)",
                               "adagscale",    "squared",      "squared, last",       "squared, last, final"};
  for (int s = 0; s < 8; ++s) {
    for (int i = 0; i < 6; ++i)
      speed.rows.push_back(row(names[s], "setting " + std::to_string(10 * s + i), i == s % 6 ? "yes" : "",
                               0.5 * std::pow(1.7, i) * (1 + 0.1 * s), 30.0 + 5.123456789 * i - s));
  }
  speed.rows.push_back(row(names[0], "exact", "", 2.5, std::numeric_limits<double>::infinity()));
  Chart curve{"frame time ms", {"PSNR dB"}, "series", "setting", "filled"};
  curve.log_x = true;
  page.sections.push_back(
      {"speed", "Accuracy against frame time", "Up and to the left is better.", {}, curve, speed});
  Table stages{{"setting", "project", "bin", "sort", "blend"}, {}};
  for (const std::string setting : {"aabb", "ellipse", "squared, last"}) {
    auto& cells = stages.rows.emplace_back(row(setting));
    for (std::size_t k = 1; k < stages.columns.size(); ++k)
      cells.emplace_back(0.1 + 0.01 * double(stages.columns[k].size() * setting.size()));
  }
  Chart bars{"setting", {stages.columns.begin() + 1, stages.columns.end()}};
  bars.bars = true;
  page.sections.push_back({"stages", "Time by stage", "Blending takes most.", stages, bars});
  Table table{{"view", "pairs", "dB"},
              {{"0001", 371596, 46.25}, {"0042", 308963, nullptr}, {"0089", 12, 0.000123456}}};
  page.sections.push_back({"views", "By view", "The worst view is 0001.", table});
  page.sections.push_back({"nothing",
                           "Empty chart",
                           "No view was measured.",
                           {},
                           Chart{"view", {"dB"}},
                           Table{{"view", "dB"}, {}}});
  page.sections.push_back({"bare", "Empty table", "No view was measured.", Table{{"view"}, {}}});
  page.sections.push_back(
      {.id = "broken", .title = "Failed", .sentence = "", .problem = "No photos: --photos DIR."});
  return page;
}

double number_at(const Table& table, std::size_t row, std::size_t column) {
  return table.rows[row][column].get<double>();
}

const ordered_json data = {{"version", 1}, {"results", {1, 2, 3}}};

ordered_json embedded(const std::string& text) {
  const std::string start = "<script type=\"application/json\" id=\"page\">";
  const std::size_t begin = text.find(start) + start.size();
  return ordered_json::parse(text.substr(begin, text.find("</script>", begin) - begin));
}

TEST(Page, IsSelfContained) {
  const std::string text = html(sample_page(), data);
  const ordered_json json = embedded(text);
  EXPECT_EQ(json["data"], data);
  EXPECT_EQ(json["title"], sample_page().title) << "what looks like a tag must come through";
  const ordered_json& rows = json["sections"][0]["numbers"]["rows"];
  EXPECT_EQ(rows[1][4].get<double>(), 35.123456789);
  EXPECT_TRUE(rows[48][4].is_null()) << "infinite";
  for (const char* loads : {"<script src", "<link", "@import", "<img", "fetch(\"", "url(http"})
    EXPECT_EQ(text.find(loads), std::string::npos) << loads;
  EXPECT_NE(text.find("Copyright 2010-2023 Mike Bostock"), std::string::npos) << "licences travel along";
  EXPECT_NE(text.find("Copyright 2020-2025 Observable"), std::string::npos);
  EXPECT_NE(text.find("<title>Speed against accuracy: fox &lt;/script> &amp; &lt;b></title>"),
            std::string::npos);
}

TEST(Page, RejectsInconsistentTablesAndCharts) {
  Page page = sample_page();
  page.sections[2].table->rows.push_back({"0100", 5});
  EXPECT_THROW(html(page, data), std::logic_error);
  page = sample_page();
  page.sections[2].chart = Chart{"view", {"frame ms"}};
  EXPECT_THROW(html(page, data), std::logic_error) << "a column that is not there";
}

TEST(Page, IsWrittenAloneWithItsFolder) {
  const TempFolder folder;
  save_page(folder / "a" / "page.html", sample_page(), data);
  EXPECT_EQ(folder.files(), (std::set<std::string>{"a/page.html"}));
  EXPECT_EQ(test::read_text(folder / "a" / "page.html"), html(sample_page(), data));
}

struct PageInBrowser : test::InChromium {
  const Page page = sample_page();

  void SetUp() override {
    InChromium::SetUp();
    save_page(file, page, data);
  }
};

TEST_F(PageInBrowser, NumbersMatchJson) {
  // Every cell of every table, in order: exact in data-value, with five digits as text.
  const std::string cells =
      ask("return JSON.stringify([...document.querySelectorAll('#views tbody tr')].map((row) =>"
          "[...row.cells].map((c) => [c.textContent, c.dataset.value ?? null])));");
  EXPECT_EQ(cells,
            "[[[\"0001\",null],[\"371,596\",\"371596\"],[\"46.25\",\"46.25\"]],"
            "[[\"0042\",null],[\"308,963\",\"308963\"],[\"–\",null]],"
            "[[\"0089\",null],[\"12\",\"12\"],[\"1.23e-4\",\"0.000123456\"]]]");
  const std::string numbers =
      ask("return JSON.stringify([...document.querySelectorAll('#speed tbody tr')].map((row) =>"
          "[row.cells[0].textContent, row.cells[3].dataset.value, row.cells[4].dataset.value ?? null]));");
  const ordered_json rows = ordered_json::parse(numbers, nullptr, false);
  const Table& speed = *page.sections[0].numbers;
  ASSERT_EQ(rows.size(), speed.rows.size()) << numbers;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k][0], speed.rows[k][0].get<std::string>());
    EXPECT_EQ(std::stod(rows[k][1].get<std::string>()), number_at(speed, k, 3));
    EXPECT_EQ(rows[k][2].is_null(), !std::isfinite(number_at(speed, k, 4)));
    if (!rows[k][2].is_null()) {
      EXPECT_EQ(std::stod(rows[k][2].get<std::string>()), number_at(speed, k, 4));
    }
  }
}

/// Returns the largest distance of `y` from a straight line through its first and last points, over `x`, in
/// px.
double largest_bend(const std::vector<double>& x, const std::vector<double>& y) {
  double bend = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double slope = (y.back() - y.front()) / (x.back() - x.front());
    bend = std::max(bend, std::abs(y[i] - y.front() - slope * (x[i] - x.front())));
  }
  return bend;
}

TEST_F(PageInBrowser, PointPositionsMatchNumbers) {
  const std::string places = ask(
      "return JSON.stringify([...document.querySelectorAll('#speed figure svg g[aria-label=dot]')].map((g) =>"
      "[...g.children].map((mark) => { const at = mark.getBoundingClientRect();"
      "return [at.x + at.width / 2, at.y + at.height / 2]; })));");
  const ordered_json found = ordered_json::parse(places, nullptr, false);
  ASSERT_EQ(found.size(), 8) << places;
  // The first series has circles, whose centre is that of their bounding box.
  ASSERT_EQ(found[0].size(), 6) << "what is not finite is left out, the rest drawn";
  std::vector<double> x, y, at_x, at_y;
  for (std::size_t i = 0; i < 6; ++i) {
    x.push_back(std::log(number_at(*page.sections[0].numbers, i, 3)));
    y.push_back(number_at(*page.sections[0].numbers, i, 4));
    at_x.push_back(found[0][i][0]);
    at_y.push_back(found[0][i][1]);
  }
  EXPECT_GT(at_x.back() - at_x.front(), 300);
  EXPECT_LT(at_y.back() - at_y.front(), -100) << "more is up";
  EXPECT_LT(largest_bend(x, at_x), 0.6);
  EXPECT_LT(largest_bend(y, at_y), 0.6);
  y[3] += 1.0;
  EXPECT_GT(largest_bend(y, at_y), 0.6) << "a point in the wrong place goes unnoticed";
}

TEST_F(PageInBrowser, BarLengthsMatchNumbers) {
  const std::string widths =
      ask("return JSON.stringify([...document.querySelectorAll('#stages figure svg g[aria-label=bar] rect')]"
          ".map((bar) => Number(bar.getAttribute('width'))));");
  const ordered_json found = ordered_json::parse(widths, nullptr, false);
  std::vector<double> values;
  const Table& stages = *page.sections[1].table;
  for (std::size_t column = 1; column < stages.columns.size(); ++column) {
    for (std::size_t k = 0; k < stages.rows.size(); ++k) values.push_back(number_at(stages, k, column));
  }
  ASSERT_EQ(found.size(), values.size()) << widths;
  const double px = (found.back().get<double>() + 1) / values.back();
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(found[i].get<double>() + 1, px * values[i], 0.6) << i;
}

TEST_F(PageInBrowser, ReportsEmptyAndBrokenData) {
  const std::string problems =
      ask("return [...document.querySelectorAll('.problem')].map((p) => p.parentElement.id + ': ' +"
          " p.textContent).join('|');");
  EXPECT_EQ(
      problems,
      "speed: Not drawn, because a value is missing or not finite (an equal picture has no PSNR): exact.|"
      "nothing: There is nothing to draw: no result has a value here.|"
      "bare: This table is empty: nothing was measured.|broken: No photos: --photos DIR.");
  // Truncated data.
  std::string text = test::read_text(file);
  text.replace(text.find("\"sections\""), 3, "");
  test::write_text(file, text);
  EXPECT_NE(ask("return document.querySelector('.problem').textContent;").find("are broken"),
            std::string::npos);
  Page empty;
  empty.title = "Nothing";
  save_page(file, empty, {});
  EXPECT_EQ(ask("return document.querySelector('.problem').textContent;"), "There are no results.");
}

TEST_F(PageInBrowser, LegendTogglesSeries) {
  EXPECT_EQ(ask("const button = document.querySelectorAll('#speed .legend button')[2]; button.click();"
                "return button.getAttribute('aria-pressed') + ' ' +"
                "document.querySelectorAll('#speed figure svg g[aria-label=dot]').length;"),
            "false 7");
  // The saved SVG has all its colours and its namespace, and is well formed.
  const std::string saved = ask(
      "let blob; window.URL.createObjectURL = (b) => { blob = b; return 'blob:x'; };"
      "window.HTMLAnchorElement.prototype.click = () => {};"
      "document.querySelector('#speed .tools button').click(); const text = await blob.text();"
      "const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');"
      "return [parsed.documentElement.tagName, parsed.querySelectorAll('parsererror').length,"
      "text.includes('--series-1: #0072b2'), text.includes('xmlns=\"http://www.w3.org/2000/svg\"')].join();");
  EXPECT_EQ(saved, "svg,0,true,true");
}

/// Returns the tick labels of an axis of the chart in the section `id`.
std::string ticks_of(const std::string& id, const std::string& axis) {
  return "[...document.querySelectorAll('#" + id + " [aria-label=\"" + axis +
         "-axis tick label\"] text')].map((t) => t.textContent).join(' ')";
}

TEST_F(PageInBrowser, ExactPicturesStandAtEdge) {
  Page charts;
  const Chart drawn{"frame ms", {"PSNR dB"}};
  Table some{{"frame ms", "PSNR dB"}, {row(1.0, 30.0), row(2.0, 42.0), row(3.0, 100.0)}};
  charts.sections.push_back({"some", "Some equal", "", some, drawn});
  charts.sections.push_back({"all", "All equal", "", Table{some.columns, {some.rows[2]}}, drawn});
  const Table near{{"PSNR dB", "max drop dB"}, {row(30.0, 0.3), row(75.0, 0.3)}};
  charts.sections.push_back({"near", "Nearly equal", "", near, Chart{"PSNR dB", {"max drop dB"}}});
  save_page(file, charts, data);
  EXPECT_EQ(ask("return [" + ticks_of("some", "y") + "," + ticks_of("all", "y") + "," +
                ticks_of("near", "x") + "," + ticks_of("near", "y") + "].join('|');"),
            "30 32 34 36 38 40 42 equal|equal|30 ≥ 60|0.3");
  const std::string heights =
      ask("return JSON.stringify([...document.querySelectorAll('figure svg g[aria-label=dot] circle, "
          "figure svg g[aria-label=dot] path')].map((dot) => dot.getBoundingClientRect().y));");
  const ordered_json y = ordered_json::parse(heights, nullptr, false);
  ASSERT_EQ(y.size(), 6u) << heights;
  const double step = y[0].get<double>() - y[1].get<double>(),
               above = y[1].get<double>() - y[2].get<double>();
  EXPECT_GT(above, 10.0);
  EXPECT_LT(above, 0.3 * step) << "the axis belongs to the other values";
}

TEST_F(PageInBrowser, CountsHaveWholeTicks) {
  Page charts;
  charts.sections.push_back({"curve", "Pairs", "",
                             Table{{"frame", "pairs"}, {row(0, 0), row(1, 1.5), row(2, 2)}},
                             Chart{"frame", {"pairs"}}});
  Chart bars{.x = "ms", .y = {"frames"}, .bars = true};
  charts.sections.push_back({"bars", "Frames", "", Table{{"ms", "frames"}, {row("1 to 2", 1)}}, bars});
  save_page(file, charts, data);
  EXPECT_EQ(ask("return [" + ticks_of("curve", "x") + "," + ticks_of("curve", "y") + "," +
                ticks_of("bars", "x") + "].join('|');"),
            "0 1 2|0 1 2|0 1");
}

TEST_F(PageInBrowser, WideTablesAndLongNamesFit) {
  Page wide;
  const std::string name = "adagscale, transmittance by depth, 0.125, half precision, tiles of 8 px";
  Table numbers{{"setting"}, {row(name)}},
      stages{{"setting", "blend"}, {row(name, 1000.0), row("exact", 1.0)}};
  for (int k = 0; k < 40; ++k) {
    numbers.columns.push_back("column " + std::to_string(k));
    numbers.rows[0].emplace_back(1000.5 + k);
  }
  wide.sections.push_back({"numbers", "Numbers", "", numbers});
  wide.sections.push_back(
      {"bars", "Stages", "", stages, Chart{.x = "setting", .y = {"blend"}, .bars = true}});
  save_page(file, wide, data);
  for (const int width : {1200, 420}) {
    EXPECT_EQ(
        ask("const box = document.querySelector('#numbers .wide'); box.scrollLeft = 500;"
            "const first = box.querySelector('td').getBoundingClientRect(), at = box.getBoundingClientRect();"
            "return [document.documentElement.scrollWidth, box.scrollLeft, first.x - at.x,"
            "window.getComputedStyle(box, '::before').content.includes('sideways')].join(' ');",
            width),
        std::to_string(width) + " 500 0 true");
    EXPECT_EQ(
        ask("const svg = document.querySelector('#bars figure svg').getBoundingClientRect();"
            "return [...document.querySelectorAll('#bars svg text, #bars svg rect')].filter((part) => {"
            "const at = part.getBoundingClientRect(); return at.left < svg.left || at.right > svg.right ||"
            "at.top < svg.top || at.bottom > svg.bottom; }).map((part) => part.outerHTML).join();",
            width),
        "")
        << "cut at an edge";
  }
}

TEST_F(PageInBrowser, FitsPhonesAndColourSchemes) {
  const std::string fits =
      "return [document.documentElement.scrollWidth, window.getComputedStyle(document.body).backgroundColor,"
      "Math.min(...[...document.querySelectorAll('figure svg')].map((s) => s.getBoundingClientRect().width)),"
      "[...document.querySelectorAll('section > p:not(.problem)')].every((p) => p.textContent.length > "
      "10)].join(' ');";
  EXPECT_EQ(ask(fits, 1280, false), "1280 rgb(255, 255, 255) 928 true");
  EXPECT_EQ(ask(fits, 400, true), "400 rgb(21, 23, 26) 368 true");
}

}  // namespace
}  // namespace binosplat::lab
