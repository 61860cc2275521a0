#include "lab/results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "lab/chromium.h"
#include "lab/columns.h"
#include "lab/suite.h"
#include "support/errors.h"

namespace binosplat::lab {
namespace {

using nlohmann::ordered_json;

Point point(const std::string& name, double ms, double db, int eyes = 1) {
  const std::string series = name.substr(0, name.find(','));
  const bool exact = series == "ellipse";
  Row row =
      object("scene", "fox", "eyes", eyes, "size", "own", "along", "views", "tiles", exact ? series : "aabb",
             "threshold", exact ? "exact" : series, "name", name, "series", series);
  if (std::isnan(ms)) return {row};
  put(row, "device", "llvmpipe", "frame_ms", ms, "p99_ms", 1.5 * ms, "noise_ms", 0.01 * ms, "full_clock",
      true, "pairs", 1000 * ms, "psnr_db", db, "ssim", 0.987654321, "stage_project_ms", 0.25 * ms,
      "stage_blend_ms", 0.75 * ms);
  row["repeats_ms"] = {0.99 * ms, 1.01 * ms};
  if (eyes == 2) put(row, "disagreement_db", 55.5);
  return {row, {object("kind", "view", "view", "0001", "psnr_db", db, "pairs", 1000 * ms)}};
}

/// Returns points that are: equal and slow; faster and worse; slower and worse than that; with another number
/// of eyes; and failed.
Results sample_results() {
  Results made{"quick", "0", {}};
  made.points = {
      point("ellipse", 8.0, 100.0),     point("squared, 0.1", 4.0, 45.5), point("squared, 0.5", 3.0, 38.25),
      point("adagscale, 1", 5.0, 41.0), point("aabb", 30.0, 77.0, 2),     point("obb", NAN, NAN),
      point("snug", NAN, NAN)};
  put(made.points[5].row, "device", "llvmpipe", "problem", "0001: two frames differ");
  put(made.points[6].row, "problem", "out of memory");
  add_relative_columns(made.points);
  return made;
}

std::vector<bool> front_of(std::vector<Point> points) {
  add_relative_columns(points);
  std::vector<bool> front;
  for (const Point& one : points) front.push_back(one.row.value("pareto", false));
  return front;
}

TEST(Results, RowsOmitUnknownValues) {
  const Row row =
      object("a", 1.5, "b", NAN, "c", std::optional<double>(), "d", std::optional(2), "e", "text");
  EXPECT_EQ(row.dump(), R"({"a":1.5,"d":2,"e":"text"})");
  EXPECT_EQ(number(row, "a"), 1.5);
  EXPECT_TRUE(std::isnan(number(row, "b")));
  EXPECT_TRUE(std::isnan(number(row, "e")));
  EXPECT_EQ(text(row, "e"), "text");
  EXPECT_EQ(text(row, "a"), "");
  EXPECT_EQ(mean_number({row, object("a", 2.5), object("x", 9.0)}, "a"), 2.0);
  EXPECT_EQ(stage_of(stage_column("blend")), "blend");
  EXPECT_EQ(title_of(stage_column("blend")), "blend ms");
}

TEST(Results, FrontIsParetoOptimal) {
  const std::vector<Point> points = sample_results().points;
  EXPECT_EQ(front_of(points), (std::vector<bool>{true, true, true, false, true, false, false}));
  std::vector<Point> other = points;
  other[3].row["frame_ms"] = 3.5;  // faster than the more accurate point, more accurate than the faster one
  EXPECT_TRUE(front_of(other)[3]);
  other = points;
  other[3] = other[1];  // two equal points: neither dominates the other
  EXPECT_TRUE(front_of(other)[1] && front_of(other)[3]);
  EXPECT_NEAR(number(points[1].row, "speed"), 2.0, 1e-12) << "speed vs exact";
  EXPECT_FALSE(points[4].row.contains("speed")) << "its chart has no exact one";
}

TEST(Results, FrontIgnoresNoise) {
  std::vector<Point> points = {point("ellipse", 4.0, 100.0), point("obb", 4.04, 76.5),
                               point("squared, 0.1", 3.98, 50.0), point("squared, 0.2", 2.0, 45.0)};
  for (Point& one : points) one.row["noise_ms"] = 1.5;
  EXPECT_EQ(front_of(points), (std::vector<bool>{true, false, true, true}))
      << "slower and worse than ellipse";
  points[1] = point("obb", 4.0, 76.5);
  EXPECT_FALSE(front_of(points)[1]) << "as quick, but worse";
  points[1] = point("snug", 4.04, 100.0);
  EXPECT_FALSE(front_of(points)[1]) << "as near to exact, but slower";
  points[1] = point("obb", 3.99, 76.5);
  EXPECT_TRUE(front_of(points)[1]);
}

TEST(Results, CsvMatchesJson) {
  const Results results = sample_results();
  const std::string csv_text = csv(results.points), details = details_csv(results.points);
  std::istringstream lines(csv_text);
  std::string header, line;
  std::getline(lines, header);
  EXPECT_EQ(header.substr(0, 22), "scene,eyes,size,along,") << header;
  std::size_t count = 0;
  while (std::getline(lines, line)) {
    std::string bare;  // without quoted text
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (!quoted) bare += c;
    }
    EXPECT_EQ(std::ranges::count(bare, ','), std::ranges::count(header, ',')) << line;
    ++count;
  }
  EXPECT_EQ(count, 7u);
  for (const auto& [name, value] : results.points[1].row.items()) {
    if (value.is_array()) continue;
    EXPECT_NE(("," + header + ",").find("," + name + ","), std::string::npos) << name;
  }
  EXPECT_NE(csv_text.find("\"fox\",1,\"own\",\"views\",\"aabb\",\"squared\",\"squared, 0.1\""),
            std::string::npos)
      << csv_text;
  EXPECT_NE(csv_text.find("two frames differ"), std::string::npos);
  EXPECT_NE(details.find("\"fox\",1,\"own\",\"views\",\"squared, 0.1\",\"view\",\"0001\",4000.0,45.5"),
            std::string::npos)
      << details;
}

TEST(Results, FilesRoundTripOrAreRejected) {
  const ordered_json json = to_json(sample_results(), {{"suite_name", "quick"}});
  const std::vector<Row> rows = rows_of(ordered_json::parse(json.dump()), "old.json");
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[1]["details"].size(), 1u);
  EXPECT_EQ(identity_of(rows[1]), identity_of(sample_results().points[1].row));
  EXPECT_NE(identity_of(rows[1]), identity_of(rows[2]));
  for (const ordered_json& wrong :
       {ordered_json({1, 2}), ordered_json({{"format", "binosplat bench"}, {"version", 1}}),
        ordered_json({{"format", "binosplat results"}, {"version", 4}}),
        ordered_json({{"format", "binosplat results"}, {"version", 4}, {"points", {1}}})})
    EXPECT_ERROR(rows_of(wrong, "old.json"), "old.json: not the results.json") << wrong;
}

TEST(Results, ScenesAveragedGeometrically) {
  std::vector<Point> points;
  for (const double factor : {2.0, 8.0}) {
    for (Point one : {point("ellipse", 8.0, 100.0), point("squared, 0.1", 8.0 / factor, 40.0 + factor)}) {
      one.row["scene"] = factor == 2.0 ? "fox" : "garden";
      points.push_back(one);
    }
  }
  add_relative_columns(points);
  add_means(points);
  ASSERT_EQ(points.size(), 6u);
  EXPECT_EQ(text(points[5].row, "scene"), "mean of 2 scenes");
  EXPECT_NEAR(number(points[5].row, "speed"), 4.0, 1e-12);
  EXPECT_EQ(number(points[5].row, "psnr_db"), 45.0);
  std::vector<Point> alone = sample_results().points;
  add_means(alone);
  EXPECT_EQ(alone.size(), 7u);
}

// docs/measuring.md explains each column.
TEST(Results, DocumentationHasEveryColumn) {
  std::ifstream in(std::string(BINOSPLAT_SOURCE_DIR) + "/docs/measuring.md");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  for (const Column& column : columns)
    EXPECT_NE(page.find(fmt::format("`{}`", column.name)), std::string::npos) << column.name;
  EXPECT_EQ(page.find("`no_such_column`"), std::string::npos);
}

const Section& section_of(const Page& page, std::string_view id) {
  const auto found = std::ranges::find(page.sections, id, &Section::id);
  if (found == page.sections.end()) fail("there is no section {}", id);
  return *found;
}

TEST(ResultsPage, DescribesContents) {
  const Page page = results_page(sample_results());
  EXPECT_NE(page.sentence.find(
                "Of 4 settings, “squared, 0.1” is the quickest with 40 dB or more against exact: 4 ms a "
                "frame, 2.00 times as fast as the exact picture (8 ms)"),
            std::string::npos)
      << page.sentence;
  std::vector<std::string> ids;
  for (const Section& section : page.sections) ids.push_back(section.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"chart-1-accuracy", "chart-1-stages", "chart-1-numbers",
                                           "chart-1-missing", "chart-2-accuracy", "chart-2-stages",
                                           "chart-2-numbers"}));
  const Table& front = *page.sections[0].numbers;
  ASSERT_EQ(front.rows.size(), 4u);
  EXPECT_EQ(std::ranges::count(front.rows, Cell("yes"), [](const auto& cells) { return cells[2]; }), 3);
  for (const Section& section : page.sections)
    EXPECT_EQ(section.sentence.find("is the quickest with") != std::string::npos,
              section.id == "chart-2-accuracy")
        << section.sentence << ": the page begins with the first chart's sentence";
  EXPECT_NE(page.sections[0].sentence.find("means over the repeats and the views"), std::string::npos);
  EXPECT_NE(page.sections[1].sentence.find("75 % in blend"), std::string::npos);
  EXPECT_NE(page.sections[2].sentence.find("Equal in all rows: full clock true, SSIM vs exact 0.987654321."),
            std::string::npos)
      << page.sections[2].sentence;
  EXPECT_EQ(std::ranges::count(page.sections[2].table->columns, "SSIM vs exact"), 0);
  EXPECT_EQ(page.sections[2].table->columns.front(), "setting") << "stays in view";
  EXPECT_EQ(page.sections[3].problem, "obb: 0001: two frames differ; snug: out of memory");
  const std::vector<std::string>& pair = page.sections[6].table->columns;
  EXPECT_NE(std::ranges::find(pair, "disagreement dB"), pair.end());
  EXPECT_FALSE(html(results_page({}), {}).empty());
}

TEST(ResultsPage, PlotsFollowColumns) {
  Results made = sample_results();
  const auto has = [&](const std::string& id) {
    const Page page = results_page(made);
    EXPECT_FALSE(html(page, {}).empty()) << "each chart is of columns that are there";
    return std::ranges::any_of(page.sections, [&](const Section& section) { return section.id == id; });
  };
  for (const char* id : {"seen", "frames", "levels", "removed", "real", "skipping", "distance", "depth",
                         "quality", "pictures"})
    EXPECT_FALSE(has(std::string("chart-1-") + id)) << id;
  const double seen[] = {0.0, 0.9, 50.0, 2.0};
  for (std::size_t k = 0; k < 4; ++k) put(made.points[k].row, "seen", seen[k]);
  ASSERT_TRUE(has("chart-1-seen"));
  EXPECT_NE(section_of(results_page(made), "chart-1-seen")
                .sentence.find("at most 1 % of the pixels is “squared, 0.1”: 4 ms"),
            std::string::npos);
  for (Point& one : made.points) {
    one.details.push_back(object("kind", "frame", "stretch", 1, "frame", 0, "phase", "moving", "psnr_db",
                                 40.0, "reported_db", 41.0, "pairs", 5, "frame_ms", 1.0));
    for (const char* of : {"skipping", "distance", "depth"})
      one.details.push_back(object("kind", of, "formula", "alpha", "skipped", 50.0, "psnr_db", 30.0, "from",
                                   1.0, "mean", 0.5, "median", 0.5));
    one.picture = Image(8, 4, 3);
  }
  for (const char* id : {"quality", "pairs", "times", "skipping", "distance", "depth", "pictures"})
    EXPECT_TRUE(has(std::string("chart-1-") + id)) << id;
  put(made.points[1].row, "detail", "40dB", "gaussians", 5);
  EXPECT_TRUE(has("chart-1-levels"));
}

TEST(ResultsPage, PaperNumbersAppearWithDropsOnly) {
  for (const bool drop : {true, false}) {
    Results made{"paper", "0", {point("ellipse", 8.0, 100.0)}};
    for (const char* found_on : {"test", "training"}) {
      for (const double target : {0.1, 0.2}) {
        Point& one = made.points.emplace_back(point("squared, 0.1", 4.0, 45.5));
        put(one.row, drop ? "max_drop" : "min_psnr", target, "found_on", found_on, "pairs_removed",
            200 * target, "drop_db", target + 0.03);
      }
    }
    add_relative_columns(made.points);
    const Page page = results_page(made);
    const Section& removed = section_of(page, "chart-1-removed");
    EXPECT_NE(removed.sentence.find("removes the most pairs of the exact ellipse test: 40.0 % at 0.2 dB"),
              std::string::npos)
        << removed.sentence;
    EXPECT_EQ(removed.numbers->rows.size(), drop ? 2u + 5 : 2u);
    EXPECT_EQ(section_of(page, "chart-1-real").numbers->rows.size(), 2u);
    EXPECT_EQ(section_of(page, "chart-1-stages").numbers->rows.size(), 2u) << "exact, and the middle target";
    std::erase_if(made.points, [](const Point& one) { return text(one.row, "found_on") == "test"; });
    EXPECT_EQ(section_of(results_page(made), "chart-1-stages").numbers->rows.size(), 2u) << "of the others";
  }
}

/// Returns a page with the pictures of the exact setting and the front. Two points coincide.
Page results_with_pictures() {
  Results measured = sample_results();
  for (Point& one : measured.points) one.picture = Image(8, 4, 3);
  return results_page(measured);
}

TEST(ResultsPage, ComparesPictures) {
  const Page page = results_with_pictures();
  const Section& section = section_of(page, "chart-1-pictures");
  EXPECT_TRUE(section.compared);
  ASSERT_EQ(section.figures.size(), 3u);
}

using ResultsInBrowser = test::InChromium;

TEST_F(ResultsInBrowser, ComparesPictures) {
  const Page page = results_with_pictures();
  save_page(file, page, {});
  const auto ask_at = [&](const std::string& script) {
    return ask("const at = document.querySelector('#chart-1-pictures');" + script, 1300);
  };
  EXPECT_EQ(ask_at("return at.querySelectorAll('.thumbnail').length;"), "3");
  EXPECT_EQ(ask_at("const over = at.querySelector('.compared'), slider = over.querySelector('input');"
                   "slider.value = 20; slider.dispatchEvent(new window.Event('input'));"
                   "at.querySelectorAll('.thumbnail')[1].click();"
                   "return over.style.getPropertyValue('--border') + ' ' + "
                   "at.querySelectorAll('select')[1].value + ' ' +"
                   "over.querySelector('.over').alt;"),
            "20% 1 " + section_of(page, "chart-1-pictures").figures[1].caption);
}

}  // namespace
}  // namespace binosplat::lab
