#include "lab/bench_results.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lab/chromium.h"
#include "support/scenes.h"

namespace binosplat::lab {
namespace {

BenchPoint point(const std::string& name, double ms, double db, int eyes = 1) {
  BenchPoint p;
  p.scene = "fox";
  p.eyes = eyes;
  p.size = "own";
  p.name = name;
  p.family = name.substr(0, name.find(','));
  p.settings.tiles = name == "ellipse" ? "ellipse" : "aabb";
  p.settings.th = name == "ellipse" ? "tau" : name;
  p.device = "llvmpipe";
  p.frame_ms = ms;
  p.p99_ms = 1.5 * ms;
  p.noise_ms = 0.01 * ms;
  p.repeats_ms = {0.99 * ms, 1.01 * ms};
  p.settled = true;
  p.frames = 60;
  p.submit_ms = 0.25;
  p.stages = {{"project", 0.25 * ms}, {"blend", 0.75 * ms}};
  p.gpu_bytes = 123456789;
  p.alphas = 50.5;
  p.alphas_visible = 30.25;
  p.pairs = 1000 * ms;
  p.visible = 500.5;
  p.exact = {db, db, "0001", 0.987654321, 0.0123, -0.001, eyes == 2 ? 55.5 : NAN};
  return p;
}

/// Equal and slow; quicker and worse; both slower and worse than that; with another number of eyes; failed;
/// and not measured yet.
BenchResults bench_results() {
  BenchResults made{"quick", "0", {}};
  made.points = {point("ellipse", 8.0, NAN),
                 point("squared, 0.1", 4.0, 45.5),
                 point("squared, 0.5", 3.0, 38.25),
                 point("peripheral, 1", 5.0, 41.0),
                 point("aabb", 30.0, 77.0, 2),
                 point("obb", NAN, NAN),
                 point("snug", NAN, NAN)};
  for (const std::size_t i : {5, 6}) static_cast<BenchNumbers&>(made.points[i]) = {};
  made.points[5].device = "llvmpipe";
  made.points[5].problem = "0001: two frames differ";
  return made;
}

TEST(BenchResults, FilesKeepEveryNumber) {
  nlohmann::ordered_json json = bench_results().points;
  EXPECT_EQ(json[5].size(), 8u) << "names, device and problem: " << json[5];
  EXPECT_EQ(json[6].size(), 6u) << json[6];
  json = nlohmann::ordered_json::parse(json.dump());
  EXPECT_TRUE(json[0]["exact"]["psnr_db"].is_null());
  EXPECT_FALSE(json[0].contains("profile"));
  json[0]["exact"]["gone"] = 1;  // keys that nobody knows are no fault
  const auto read = json.get<std::vector<BenchPoint>>();
  EXPECT_EQ(csv(read), csv(bench_results().points));
  json[0]["exact"].erase("gone");
  EXPECT_EQ(nlohmann::ordered_json(read).dump(), json.dump());
  json[1]["frame_ms"] = "four";
  EXPECT_THROW(json.get<std::vector<BenchPoint>>(), nlohmann::ordered_json::exception);
}

TEST(BenchResults, FrontHoldsWhatNothingBeats) {
  const std::vector<BenchPoint> points = bench_results().points;
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, true, false, true, false, false}));
  std::vector<BenchPoint> other = points;
  other[3].frame_ms = 3.5;  // quicker than what is nearer to exact, nearer than what is quicker
  EXPECT_TRUE(pareto_front(other)[3]);
  other = points;
  other[3] = other[1];  // twice the same: neither beats the other
  EXPECT_TRUE(pareto_front(other)[1] && pareto_front(other)[3]);
}

TEST(BenchResults, NoiseAloneDecidesNothingOfTheFront) {
  std::vector<BenchPoint> points = {point("ellipse", 4.0, 60.0), point("aabb", 4.04, 60.0),
                                    point("squared, 0.1", 3.98, 50.0), point("squared, 0.2", 2.0, 45.0)};
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, true, true}));
  points[1] = point("aabb", 8.0, 60.0);
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, false, true, true})) << "planted: beyond noise";
  for (BenchPoint& p : points) p.repeats_ms = {p.frame_ms};  // of which nothing tells the noise
  points[1] = point("aabb", 4.04, 60.0);
  points[1].repeats_ms = {4.04};
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, false, true, true}));
}

TEST(BenchResults, CsvHasALineAPoint) {
  const std::string text = csv(bench_results().points);
  std::istringstream lines(text);
  std::string line;
  std::vector<std::string> all;
  while (std::getline(lines, line)) all.push_back(line);
  ASSERT_EQ(all.size(), 8);
  EXPECT_EQ(all[0].substr(0, 21), "scene,eyes,size,name,");
  for (std::size_t i = 0; i < 7; ++i) {
    std::string bare;  // without what is quoted
    bool quoted = false;
    for (const char c : all[i + 1]) {
      if (c == '"') quoted = !quoted;
      if (!quoted) bare += c;
    }
    EXPECT_EQ(std::count(bare.begin(), bare.end(), ','), std::count(all[0].begin(), all[0].end(), ','))
        << all[i + 1];
  }
  EXPECT_NE(all[2].find("\"fox\",1,\"own\",\"squared, 0.1\""), std::string::npos) << all[2];
  EXPECT_NE(all[2].find(",4.0,6.0,0.04,true,0.25,4000.0,500.5,123456789,50.5,30.25,45.5,"), std::string::npos)
      << all[2];
  EXPECT_EQ(all[2].substr(all[2].size() - 5), ",true");
  EXPECT_EQ(all[4].substr(all[4].size() - 6), ",false");
  EXPECT_NE(all[6].find("two frames differ"), std::string::npos);
}

TEST(BenchResults, PageSaysWhatIsSeen) {
  BenchResults made = bench_results();
  EXPECT_EQ(bench_page(made).sections[1].title.find("what is seen"), std::string::npos);
  made.points[0].seen = {0.0, {{0, 5, 0.25, INFINITY, 0.0}, {5, 10, 0.75, INFINITY, 0.0}}};
  made.points[1].seen = {0.009, {{0, 5, 0.25, 50.0, 0.0}, {5, 10, 0.75, 40.0, 0.012}}};
  made.points[2].seen = {0.5, {{0, 5, 0.25, 30.0, 0.5}, {5, 10, 0.75, 20.0, 0.5}}};
  made.points[3].seen = {0.02, {{0, 5, 0.25, 30.0, 0.5}, {5, 10, 0.75, 20.0, 0.5}}};
  const Section section = bench_page(made).sections[1];
  EXPECT_EQ(section.title, "fox, one eye, size own: what is seen");
  EXPECT_NE(section.sentence.find("at most 1 % of the pixels is “squared, 0.1”: 4 ms"), std::string::npos)
      << section.sentence;
  ASSERT_TRUE(section.table);
  EXPECT_EQ(section.table->columns.back(), "dB at 5 to 10°");
  ASSERT_EQ(section.table->rows.size(), 4u);
  // Read back, too.
  const nlohmann::ordered_json json = made.points;
  EXPECT_EQ(nlohmann::ordered_json(json.get<std::vector<BenchPoint>>()).dump(), json.dump());
}

TEST(BenchResults, PageSaysWhatItShows) {
  const Page page = bench_page(bench_results());
  EXPECT_NE(page.sentence.find(
                "Of 4 settings, “squared, 0.1” is the quickest with 40 dB or more against exact: 4 ms a "
                "frame, 2.00 times as fast as the exact picture (8 ms)"),
            std::string::npos)
      << page.sentence;
  std::vector<std::string> ids;
  for (const Section& section : page.sections) ids.push_back(section.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"chart-1", "chart-1-stages", "chart-1-numbers", "chart-1-missing",
                                           "chart-2", "chart-2-stages", "chart-2-numbers"}));
  const Table& front = *page.sections[0].numbers;
  ASSERT_EQ(front.rows.size(), 4u);
  EXPECT_EQ(std::ranges::count(front.rows, Cell("yes"), [](const auto& cells) { return cells[2]; }), 3);
  EXPECT_EQ(front.rows.back()[5], equal_db) << "an equal picture is drawn at the top";
  EXPECT_NE(page.sections[1].sentence.find("75 % goes to blend"), std::string::npos);
  EXPECT_EQ(page.sections[3].problem, "obb: 0001: two frames differ; snug: not measured yet");
  const Table& pair = *page.sections[6].table;
  EXPECT_EQ(pair.columns.back(), "disagreement dB");
  EXPECT_EQ(pair.rows[0].back(), 55.5);
  EXPECT_EQ(html(bench_page({}), {}).find("There are no results yet"), std::string::npos);
}

TEST(BenchResults, PageSetsStagesBesideTheirFloors) {
  BenchResults made = bench_results();
  made.points[0].profile = {
      {"project", 2.0, 3e6, NAN, 0.5, 0.25}, {"blend", 6.0, 4e6, 5e6, 1.5, 0.25}, {"probe", 9.0}};
  const Page page = bench_page(made);
  ASSERT_EQ(page.sections[3].id, "chart-1-floors");
  EXPECT_NE(page.sections[3].sentence.find("the exact picture's blend has most to gain, 4.5 ms"),
            std::string::npos)
      << page.sections[3].sentence;
  ASSERT_EQ(page.sections[3].table->rows.size(), 3u);
  EXPECT_EQ(page.sections[3].table->rows[1], row("ellipse", "blend", 6.0, 4.0, 5.0, 1.5, 25.0));
}

// Long: the whole page in a browser, its table against the JSON.
TEST(BenchResults, PageInChromiumHasTheJsonsNumbers) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "BINOSPLAT_LONG=1 opens the page in Chromium";
  ASSERT_TRUE(test::has_chromium()) << "install the package chromium (packages/long.txt)";
  const test::TempFolder folder;
  save_page(folder / "report.html", bench_page(bench_results()), {});
  const test::Chromium chromium;
  const std::string cells =
      chromium.ask(folder / "report.html", 400, false,
                   "return [...document.querySelectorAll('#chart-1-numbers tbody tr')].map((row) =>"
                   "[1, 2, 10, 12].map((i) => row.cells[i + (i > 1 ? 0 : 1)].dataset.value"
                   " ?? row.cells[i].textContent).join(' ')).join(';');");
  EXPECT_EQ(cells, "3 3 38.25 0.987654321;4 4 45.5 0.987654321;5 5 41 0.987654321;8 8 – 0.987654321");
  EXPECT_EQ(chromium.ask(folder / "report.html", 400, true,
                         "return (document.documentElement.scrollWidth <= window.innerWidth) + ' ' +"
                         "document.querySelectorAll('figure svg').length;"),
            "true 4");
}

// Of the exact picture and the front; two lie on each other, and tables are whole at 1,300 px.
TEST(BenchPage, PicturesAreCompared) {
  BenchResults measured = bench_results();
  for (const Section& section : bench_page(measured).sections) EXPECT_FALSE(section.compared);
  for (BenchPoint& point : measured.points) {
    point.photos.emplace();
    point.picture = Image(8, 4, 3);
    if (point.views.empty()) point.views.emplace_back();
    point.views.front().name = "0001";
  }
  const Page page = bench_page(measured);
  const auto found = std::find_if(page.sections.begin(), page.sections.end(),
                                  [](const Section& section) { return section.compared; });
  ASSERT_NE(found, page.sections.end());
  EXPECT_EQ(found->id, "chart-1-pictures");
  const std::size_t count = found->figures.size();
  ASSERT_GE(count, 2u);
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "BINOSPLAT_LONG=1 opens the page in Chromium";
  ASSERT_TRUE(test::has_chromium()) << "install the package chromium (packages/long.txt)";
  const test::TempFolder folder;
  save_page(folder / "report.html", page, {});
  const test::Chromium chromium;
  const auto ask = [&](const std::string& script) {
    return chromium.ask(folder / "report.html", 1300, false,
                        "const at = document.querySelector('#chart-1-pictures');" + script);
  };
  EXPECT_EQ(ask("return at.querySelectorAll('.thumbnail').length;"), std::to_string(count));
  EXPECT_EQ(ask("const over = at.querySelector('.compared'), slider = over.querySelector('input');"
                "slider.value = 20; slider.dispatchEvent(new window.Event('input'));"
                "at.querySelectorAll('.thumbnail')[1].click();"
                "return over.style.getPropertyValue('--border') + ' ' + "
                "at.querySelectorAll('select')[1].value + ' ' +"
                "over.querySelector('.over').alt;"),
            "20% 1 " + found->figures[1].caption);
  EXPECT_EQ(ask("return [...document.querySelectorAll('.wide')].filter((w) => w.scrollWidth > "
                "w.clientWidth).length;"),
            "0");
  EXPECT_NE(ask("document.querySelector('main').style.maxWidth = '20rem';"
                "return [...document.querySelectorAll('.wide')].filter((w) => w.scrollWidth > "
                "w.clientWidth).length;"),
            "0")
      << "a table that is cut off goes unnoticed";
}

}  // namespace
}  // namespace binosplat::lab
