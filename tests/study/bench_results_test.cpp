#include "study/bench_results.h"

#include <gtest/gtest.h>

#include "study/chromium.h"
#include "support/scenes.h"

namespace binosplat::study {
namespace {

using nlohmann::ordered_json;

ordered_json point(const std::string& name, double ms, ordered_json db, int eyes = 1) {
  return {{"scene", "fox"},
          {"eyes", eyes},
          {"size", "own"},
          {"name", name},
          {"family", name.substr(0, name.find(','))},
          {"settings",
           {{"tiles", name == "ellipse" ? "ellipse" : "aabb"}, {"th", name == "ellipse" ? "tau" : name}}},
          {"device", "llvmpipe"},
          {"frame_ms", ms},
          {"p99_ms", 1.5 * ms},
          {"noise_ms", 0.01 * ms},
          {"settled", true},
          {"frames", 60},
          {"submit_ms", 0.25},
          {"stages_ms", {{"project", 0.25 * ms}, {"blend", 0.75 * ms}}},
          {"gpu_bytes", 123456789},
          {"alphas", 50.5},
          {"alphas_visible", 30.25},
          {"pairs", 1000 * ms},
          {"visible", 500.5},
          {"exact",
           {{"psnr_db", db},
            {"worst_psnr_db", db},
            {"worst_view", "0001"},
            {"ssim", 0.987654321},
            {"flip", 0.0123},
            {"signed", -0.001},
            {"disagreement_db", eyes == 2 ? ordered_json(55.5) : ordered_json()}}}};
}

/// Equal and slow; quicker and worse; both slower and worse than that; with another number of eyes; failed;
/// and not measured yet.
ordered_json results() {
  ordered_json json = {
      {"format", "binosplat bench"}, {"version", 1}, {"plan", {{"axes_name", "quick"}, {"program", "0"}}}};
  json["points"] = {point("ellipse", 8.0, nullptr),
                    point("squared, 0.1", 4.0, 45.5),
                    point("squared, 0.5", 3.0, 38.25),
                    point("peripheral, 1", 5.0, 41.0),
                    point("aabb", 30.0, 77.0, 2),
                    point("obb", 0.0, 0.0),
                    point("snug", 0.0, 0.0)};
  for (const std::size_t i : {5, 6}) {
    json["points"][i].erase("frame_ms");
    json["points"][i].erase("exact");
  }
  json["points"][5]["problem"] = "0001: two frames differ";
  return json;
}

TEST(BenchResults, FrontHoldsWhatNothingBeats) {
  const ordered_json points = results()["points"];
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, true, false, true, false, false}));
  ordered_json other = points;
  other[3]["frame_ms"] = 3.5;  // quicker than what is nearer to exact, nearer than what is quicker
  EXPECT_TRUE(pareto_front(other)[3]);
  other = points;
  other[3] = other[1];  // twice the same: neither beats the other
  EXPECT_TRUE(pareto_front(other)[1] && pareto_front(other)[3]);
}

TEST(BenchResults, CsvHasALineAPoint) {
  const std::string text = csv(results());
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

TEST(BenchResults, ComparisonsGoByNoise) {
  const ordered_json before = results();
  ordered_json now = before;
  EXPECT_EQ(
      compare_results(before, now),
      std::vector<std::string>{"0 of 5 points in both runs changed beyond noise; 0 are new, 0 are gone"});
  now["points"][1]["frame_ms"] = 4.07;  // both runs' noise is 0.04 each, as are 2 %
  EXPECT_EQ(compare_results(before, now).size(), 1);
  now["points"][1]["frame_ms"] = 4.09;
  EXPECT_EQ(compare_results(before, now)[0],
            "fox, one eye, own, squared, 0.1: 4.000 ms -> 4.090 ms (+2.2 %)");
  now["points"][0]["exact"]["psnr_db"] = 90.0;  // equal before
  now["points"][3]["pairs"] = 4994.0;
  now["points"][4]["settings"]["tile"] = 8;
  const auto lines = compare_results(before, now);
  ASSERT_EQ(lines.size(), 4);
  EXPECT_EQ(lines[0], "fox, one eye, own, ellipse: 100.00 dB -> 90.00 dB");
  EXPECT_EQ(lines[2], "fox, one eye, own, peripheral, 1: 5000 pairs -> 4994");
  EXPECT_EQ(lines[3], "3 of 4 points in both runs changed beyond noise; 1 are new, 1 are gone");
}

TEST(BenchResults, PageSaysWhatItShows) {
  const Page page = bench_page(results());
  EXPECT_NE(page.sentence.find(
                "Of 4 settings, “squared, 0.1” is the quickest with 40 dB or more against exact: 4 ms a "
                "frame, 2.00 times as fast as the exact picture (8 ms)"),
            std::string::npos)
      << page.sentence;
  std::vector<std::string> ids;
  for (const Section& section : page.sections) ids.push_back(section.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"chart-1", "chart-1-stages", "chart-1-numbers", "chart-1-missing",
                                           "chart-2", "chart-2-stages", "chart-2-numbers"}));
  const Series& front = page.sections[0].plot->series.back();
  EXPECT_EQ(front.name, "Pareto front");
  ASSERT_EQ(front.points.size(), 3);
  EXPECT_EQ(std::get<double>(front.points[0].x), 3.0);
  EXPECT_EQ(front.points[2].y, equal_db) << "an equal picture is drawn at the top";
  EXPECT_NE(page.sections[1].sentence.find("75 % goes to blend"), std::string::npos);
  EXPECT_EQ(page.sections[3].problem, "obb: 0001: two frames differ; snug: not measured yet");
  const Table& pair = *page.sections[6].table;
  EXPECT_EQ(pair.columns.back(), "disagreement dB");
  EXPECT_EQ(pair.rows[0].back(), 55.5);
  EXPECT_EQ(page.data, results());
  EXPECT_EQ(
      html(bench_page({{"plan", {{"axes_name", ""}, {"program", ""}}}, {"points", ordered_json::array()}}))
          .find("There are no results yet"),
      std::string::npos);
}

TEST(BenchResults, PageSetsStagesBesideTheirFloors) {
  ordered_json json = results();
  json["points"][0]["profile"] = {{{"stage", "project"},
                                   {"ms", 2.0},
                                   {"bytes", 3e6},
                                   {"operations", nullptr},
                                   {"floor_ms", 0.5},
                                   {"share", 0.25}},
                                  {{"stage", "blend"},
                                   {"ms", 6.0},
                                   {"bytes", 4e6},
                                   {"operations", 5e6},
                                   {"floor_ms", 1.5},
                                   {"share", 0.25}},
                                  {{"stage", "probe"},
                                   {"ms", 9.0},
                                   {"bytes", nullptr},
                                   {"operations", nullptr},
                                   {"floor_ms", nullptr},
                                   {"share", nullptr}}};
  const Page page = bench_page(json);
  ASSERT_EQ(page.sections[3].id, "chart-1-floors");
  EXPECT_NE(page.sections[3].sentence.find("the exact picture's blend has most to gain, 4.5 ms"),
            std::string::npos)
      << page.sections[3].sentence;
  ASSERT_EQ(page.sections[3].table->rows.size(), 3u);
  EXPECT_EQ(page.sections[3].table->rows[1], ordered_json({"ellipse", "blend", 6.0, 4.0, 5.0, 1.5, 25.0}));
}

// Long: the whole page in a browser, its table against the JSON.
TEST(BenchResults, PageInChromiumHasTheJsonsNumbers) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "BINOSPLAT_LONG=1 opens the page in Chromium";
  ASSERT_TRUE(test::has_chromium()) << "install the package chromium (packages/long.txt)";
  const test::TempFolder folder;
  save_page(folder / "report.html", bench_page(results()));
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

}  // namespace
}  // namespace binosplat::study
