// Builds the page of results: for each chart (scene, eyes, size, along) the plots that its columns allow.

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "lab/results.h"

namespace binosplat::lab {

namespace {

constexpr double good_db = 40.0;  // PSNR at which errors are hardly visible
// %: the page names the fastest point with fewer visibly different pixels.
constexpr double max_seen_percent = 1.0;
constexpr const char* means_begin = "mean of ";

// AdaGScale, table IV: % of pairs removed relative to FlashGS at drops of 0.1 to 0.5 dB, with K tuned on the
// test views; mean over the paper's scenes.
constexpr struct {
  double drop_db, removed;
} paper_removed[] = {{0.1, 31.0}, {0.2, 35.8}, {0.3, 38.9}, {0.4, 41.2}, {0.5, 43.1}};

/// The points of one chart, fastest first.
struct ChartPoints {
  std::string title, id;
  std::vector<std::string> all_series = {};  // in the plan's order, for equal colours in all charts
  std::vector<const Point*> measured = {};
  std::vector<const Point*> others = {};  // with problems
  const Point* exact = nullptr;

  /// The rows that have this column.
  std::vector<Row> rows(const std::string& column) const {
    std::vector<Row> all;
    for (const Point* point : measured) {
      if (point->row.contains(column)) all.push_back(point->row);
    }
    return all;
  }
  bool has(const std::string& column) const {
    return std::ranges::any_of(measured, [&](const Point* p) { return p->row.contains(column); });
  }
  /// The details of a kind, each with the name of its setting.
  std::vector<Row> details(const std::string& of, const std::vector<const Point*>& points) const {
    std::vector<Row> all;
    for (const Point* point : points) {
      for (const Row& detail : point->details) {
        if (text(detail, "kind") != of) continue;
        Row& row = all.emplace_back(object("name", text(point->row, "name")));
        row.update(detail);
      }
    }
    return all;
  }
};

std::vector<ChartPoints> charts_of(const std::vector<Point>& points) {
  std::vector<ChartPoints> charts;
  for (const Point& point : points) {
    const std::string title = point.chart();
    auto found = std::ranges::find(charts, title, &ChartPoints::title);
    if (found == charts.end())
      found = charts.insert(found, {title, fmt::format("chart-{}", charts.size() + 1)});
    (point.measured() ? found->measured : found->others).push_back(&point);
    const std::string series = text(point.row, "series");
    if (point.row.contains("threshold") &&
        std::ranges::find(found->all_series, series) == found->all_series.end())
      found->all_series.push_back(series);
    if (found->exact == nullptr && &point == exact_of(points, point)) found->exact = &point;
  }
  for (ChartPoints& chart : charts)
    std::ranges::stable_sort(chart.measured, {}, [](const Point* p) { return number(p->row, "frame_ms"); });
  return charts;
}

std::string fastest_setting_sentence(const ChartPoints& chart) {
  if (chart.measured.empty()) return "Nothing was measured here yet.";
  const std::size_t timed = chart.rows("frame_ms").size();
  const auto good = std::ranges::find_if(chart.measured,
                                         [](const Point* p) { return number(p->row, "psnr_db") >= good_db; });
  if (good == chart.measured.end())
    return fmt::format("None of {} settings reaches {} dB against the exact picture.", timed, good_db);
  std::string sentence =
      fmt::format("Of {} settings, “{}” is the quickest with {} dB or more against exact: {:.4g} ms a frame",
                  timed, text((*good)->row, "name"), good_db, number((*good)->row, "frame_ms"));
  if (chart.exact != nullptr && chart.exact != *good)
    sentence += fmt::format(", {:.2f} times as fast as the exact picture ({:.4g} ms)",
                            number((*good)->row, "speed"), number(chart.exact->row, "frame_ms"));
  return sentence + ".";
}

/// A section with a chart of `rows`, and the numbers collapsed.
Section plot(const ChartPoints& chart, const std::string& id, const std::string& title,
             const std::string& sentence, std::span<const Row> rows, const std::vector<std::string>& columns,
             Chart drawn) {
  Section section{chart.id + "-" + id, chart.title + ": " + title, sentence};
  section.numbers = table_of(rows, columns);
  const auto is_gone = [&](const std::string& column) {
    return std::ranges::find(section.numbers->columns, column) == section.numbers->columns.end();
  };
  std::erase_if(drawn.y, is_gone);
  for (std::string* column : {&drawn.by, &drawn.label, &drawn.filled, &drawn.spread}) {
    if (is_gone(*column)) column->clear();
  }
  section.chart = std::move(drawn);
  return section;
}

/// The page itself begins with the sentence of the first chart.
Section accuracy(const ChartPoints& chart, bool is_first) {
  const bool of_views = text(chart.measured.front()->row, "along") == "views";
  const std::string sentence = fmt::format(
      "{}Times are means over the repeats and the {}. Bars reach half the range of the repeats to each side. "
      "Filled points are on the Pareto front: no other is quicker and nearer to exact, by these means. "
      "Pictures of 60 dB or more stand at the edge.",
      is_first ? "" : fastest_setting_sentence(chart) + " ",
      of_views ? "views, each with the median of its frames" : "moving frames");
  Chart drawn{.x = "frame ms", .y = {"PSNR dB"}, .by = "series", .label = "setting", .filled = "front"};
  drawn.title = "PSNR against exact, dB";
  drawn.order = chart.all_series;
  drawn.line = false;
  drawn.front = true;
  drawn.spread = "noise ms";
  return plot(chart, "accuracy", "speed against accuracy", sentence, chart.rows("frame_ms"),
              {"name", "series", "pareto", "frame_ms", "noise_ms", "psnr_db"}, drawn);
}

/// Returns the exact point and those on the Pareto front. If tolerances were searched, returns instead the
/// exact points of all tile tests, and the points with the middle target, if possible those that were tuned
/// on the test views.
std::vector<const Point*> chosen(const ChartPoints& chart) {
  std::set<double> targets;
  const auto target = [](const Point* p) {
    const double drop = number(p->row, "max_drop");
    return std::isnan(drop) ? number(p->row, "min_psnr") : drop;
  };
  bool tuned = false;
  for (const Point* point : chart.measured) {
    if (!std::isnan(target(point))) targets.insert(target(point));
    tuned = tuned || text(point->row, "found_on") == "test";
  }
  std::vector<const Point*> some;
  for (const Point* point : chart.measured) {
    const bool takes = targets.empty()
                           ? point == chart.exact || point->row.value("pareto", false)
                           : text(point->row, "threshold") == "exact" ||
                                 (target(point) == *std::next(targets.begin(), std::ssize(targets) / 2) &&
                                  (!tuned || text(point->row, "found_on") == "test"));
    if (takes) some.push_back(point);
  }
  return some;
}

Section stages(const ChartPoints& chart) {
  std::vector<Row> rows;
  for (const Point* point : chosen(chart)) rows.push_back(point->row);
  std::vector<std::string> columns = {"name"};
  Chart drawn{.x = "setting", .title = "GPU time, ms"};
  std::string slowest;
  double most = 0.0, sum = 0.0;
  for (const std::string& column : columns_of(rows)) {
    if (!stage_of(column)) continue;
    columns.push_back(column);
    drawn.y.push_back(title_of(column));
    if (chart.exact == nullptr) continue;
    const double ms = number(chart.exact->row, column);
    sum += std::isnan(ms) ? 0.0 : ms;
    if (!(ms > most)) continue;
    most = ms;
    slowest = *stage_of(column);
  }
  drawn.bars = true;
  std::string sentence = fmt::format("Time by stage, for the exact picture and the points {}",
                                     chart.has("found_on") ? "with the middle target" : "on the front");
  if (!slowest.empty())
    sentence += fmt::format(". The exact picture spends {:.0f} % in {}", 100 * most / sum, slowest);
  return plot(chart, "stages", "stages", sentence + ".", rows, columns, drawn);
}

Section pictures(const ChartPoints& chart) {
  Section section{
      chart.id + "-pictures", chart.title + ": pictures",
      "The first view, left eye: drag to compare two pictures. The numbers are means over all views."};
  section.compared = true;
  for (const Point* point : chosen(chart)) {
    if (!point->picture) continue;
    const Row& row = point->row;
    const double db = number(row, "psnr_db");
    section.figures.push_back(
        {fmt::format("{}, {}, {:.4g} ms", text(row, "name"),
                     db >= equal_db ? "equal" : fmt::format("{:.1f} dB", db), number(row, "frame_ms")),
         *point->picture});
  }
  std::ranges::reverse(section.figures);
  return section;
}

/// All columns except those in the heading. The sentence has values that all rows share.
Section all_numbers(const ChartPoints& chart) {
  const std::vector<Row> rows = chart.rows("name");
  std::vector<std::string> columns, shared;
  for (const std::string& column : columns_of(rows)) {
    const bool told = !identity_of(object(column, true)).empty() || column == "series" || column == "device";
    if (told && column != "name") continue;
    const bool is_shared = rows.size() > 1 && std::ranges::all_of(rows, [&](const Row& row) {
                             return row.contains(column) && row[column] == rows.front()[column];
                           });
    const Row value = rows.front().value(column, Row());
    const std::string shown = value.is_number()    ? fmt::format("{:.10g}", value.get<double>())
                              : value.is_boolean() ? value.dump()
                                                   : text(rows.front(), column);
    if (is_shared) shared.push_back(title_of(column) + " " + shown);
    if (!is_shared) columns.push_back(column);
  }
  std::string sentence =
      "Means over the views or the moving frames; docs/measuring.md says how each is found.";
  if (!shared.empty()) sentence += fmt::format(" Equal in all rows: {}.", fmt::join(shared, ", "));
  return {chart.id + "-numbers", chart.title + ": the numbers", sentence, table_of(rows, columns)};
}

void add_seen(const ChartPoints& chart, std::vector<Section>& sections) {
  if (!chart.has("seen")) return;
  std::vector<Row> rows = chart.rows("seen");
  double least = INFINITY;
  std::string sentence =
      "Visible differences from the exact picture for a gaze along the axis, with the contrast thresholds of "
      "Geisler and Perry. Filled points differ visibly in fewer pixels than all quicker ones.";
  bool told = false;
  for (Row& row : rows) {
    const double seen = number(row, "seen");
    row["pareto"] = seen < least;
    least = std::min(least, seen);
    if (told || !(seen <= max_seen_percent)) continue;
    told = true;
    sentence +=
        fmt::format(" The quickest that differs visibly in at most {:g} % of the pixels is “{}”: {:.4g} ms.",
                    max_seen_percent, text(row, "name"), number(row, "frame_ms"));
  }
  Chart drawn{.x = "frame ms", .y = {"seen %"}, .by = "series", .label = "setting", .filled = "front"};
  drawn.order = chart.all_series;
  drawn.line = false;
  sections.push_back(plot(chart, "seen", "what is seen", sentence, rows,
                          {"name", "series", "pareto", "frame_ms", "seen"}, drawn));
  sections.back().table =
      table_of(chart.details("ring", chart.measured), {"name", "from", "to", "area", "psnr_db", "seen"});
}

/// Plots every frame of the exact point and of settings with the middle one of the requested qualities. Plots
/// all settings if none requests a quality.
void add_frames(const ChartPoints& chart, std::vector<Section>& sections) {
  std::set<double> asked;
  for (const Point* point : chart.measured) {
    if (point->row.contains("quality")) asked.insert(number(point->row, "quality"));
  }
  std::vector<const Point*> some;
  for (const Point* point : chart.measured) {
    const double quality = number(point->row, "quality");
    if (asked.empty() || point == chart.exact || quality == *std::next(asked.begin(), std::ssize(asked) / 2))
      some.push_back(point);
  }
  const std::vector<Row> rows = chart.details("frame", some);
  if (rows.empty()) return;
  const std::vector<std::string> columns = {"name",        "stretch", "frame",    "phase",     "psnr_db",
                                            "reported_db", "pairs",   "frame_ms", "tolerance", "exact"};
  Chart drawn{.x = "frame", .by = "setting", .label = "phase", .dots = false};
  for (const auto& [id, title, sentence, y, axis] :
       {std::tuple{"quality", "true and reported",
                   "PSNR of each frame against the exact frame (8 bits, the worse eye), and the PSNR that "
                   "the frame reported.",
                   std::vector<std::string>{"PSNR dB", "reported dB"}, "PSNR, dB"},
        {"pairs", "pairs", "Gaussian-tile pairs of a frame, including its error sample.", {"pairs"}, "pairs"},
        {"times", "time", "GPU time of a frame, the median of the repeats.", {"frame ms"}, "GPU time, ms"}}) {
    drawn.y = y;
    drawn.title = axis;
    sections.push_back(plot(chart, id, title, sentence, rows, columns, drawn));
  }
}

void add_levels(const ChartPoints& chart, std::vector<Section>& sections) {
  if (!chart.has("detail")) return;
  sections.push_back(plot(chart, "levels", "what levels of detail lose",
                          "PSNR against the finest levels: measured, and as predicted for the worse eye from "
                          "the errors of the levels.",
                          chart.rows("gaussians"),
                          {"name", "gaussians", "psnr_db", "reported_db", "flip", "frame_ms"},
                          Chart{.x = "Gaussians", .y = {"PSNR dB", "reported dB"}, .label = "setting"}));
}

/// Plots frame times over the Gaussians drawn, to compare scenes at equal settings.
void add_growth(const std::vector<ChartPoints>& charts, std::vector<Section>& sections) {
  std::vector<Row> rows;
  for (const ChartPoints& chart : charts) {
    if (!chart.has("detail")) continue;
    for (const Row& row : chart.rows("frame_ms")) rows.push_back(row);
  }
  std::set<std::string> scenes;
  for (const Row& row : rows) scenes.insert(text(row, "scene"));
  if (scenes.size() < 2) return;
  Chart drawn{.x = "Gaussians", .y = {"frame ms"}, .by = "setting", .label = "scene"};
  drawn.log_x = drawn.log_y = true;
  sections.push_back(plot({.title = "All scenes", .id = "all"}, "growth", "growth with the model",
                          "GPU time of a frame over the Gaussians that are drawn.", rows,
                          {"scene", "name", "gaussians", "frame_ms"}, drawn));
}

/// Plots the gains of searched tolerances, as in AdaGScale's tables III and IV and figure 8.
void add_targets(const ChartPoints& chart, std::vector<Section>& sections) {
  for (const char* target : {"max_drop", "min_psnr"}) {
    std::vector<Row> tuned, trained;
    for (const Point* point : chart.measured) {
      if (!point->row.contains(target)) continue;
      Row row = point->row;
      (text(row, "found_on") == "test" ? tuned : trained).push_back(row);
    }
    // Lines join points in this order, not by their times.
    for (std::vector<Row>* rows : {&tuned, &trained})
      std::ranges::stable_sort(*rows, {}, [&](const Row& row) { return number(row, target); });
    const bool drop = std::string(target) == "max_drop";
    const char* const lost = drop ? "drop_db" : "psnr_db";
    const std::vector<std::string> columns = {"series",        target,          lost,
                                              "pairs_removed", "speed",         "found_tolerance",
                                              "found_db",      "worst_psnr_db", "worst_view"};
    if (!tuned.empty()) {
      const Row& most =
          *std::ranges::max_element(tuned, {}, [](const Row& row) { return number(row, "pairs_removed"); });
      const std::string sentence = fmt::format(
          "“{}” removes the most pairs of the exact ellipse test: {:.1f} % at {:g} dB. Tolerances are tuned "
          "on the test views themselves, as the paper's are.",
          text(most, "series"), number(most, "pairs_removed"), number(most, target));
      std::vector<Row> with_paper = tuned;
      for (const auto& [drop_db, removed] : paper_removed) {
        if (drop)
          with_paper.push_back(
              object("series", "the paper, its scenes", "max_drop", drop_db, "pairs_removed", removed));
      }
      sections.push_back(plot(chart, "removed", "pairs removed (table IV)", sentence, with_paper, columns,
                              Chart{title_of(target), {"pairs removed %"}, "series"}));
      sections.push_back(plot(chart, "speed", "speed at equal error (figure 8)",
                              "Speed relative to the exact frame, over the loss in the test views.", tuned,
                              columns, Chart{title_of(lost), {"speed vs exact"}, "series"}));
    }
    if (!trained.empty())
      sections.push_back(plot(chart, "real", "loss in views outside the calibration (table III)",
                              "Tolerances found on training views, and what they cost in the test views.",
                              trained, columns, Chart{title_of(target), {title_of(lost)}, "series"}));
  }
}

void add_contributions(const ChartPoints& chart, std::vector<Section>& sections) {
  const auto of = [&](const char* kind) { return chart.details(kind, chart.measured); };
  if (const auto rows = of("skipping"); !rows.empty())
    sections.push_back(plot(chart, "skipping", "what the lowest contributions are worth (figures 4a, 5a, 5b)",
                            "PSNR without this share of all fragments: those with the least contribution by "
                            "the named formula. Against the photos of the paper's four scenes, 80 % by alpha "
                            "T cost 0.60 dB, 60 % by alpha max(T) 0.41, 50 % by alpha T_upper(depth) 0.51.",
                            rows, {"formula", "skipped", "psnr_db", "drop_db"},
                            Chart{"skipped %", {"PSNR dB"}, "formula"}));
  if (const auto rows = of("distance"); !rows.empty())
    sections.push_back(plot(chart, "distance", "contribution by distance (figure 4b)",
                            "alpha T of fragments, by their distance in px from the Gaussian's middle.", rows,
                            {"from", "to", "fragments", "mean", "largest", "nearer"},
                            Chart{.x = "from", .y = {"mean", "largest"}, .title = "alpha T", .steps = true}));
  if (const auto rows = of("depth"); !rows.empty())
    sections.push_back(
        plot(chart, "depth", "transmittance by depth (figure 6)",
             "max(T) of the Gaussians at each depth, world units, and T_upper of a table that fits "
             "the scene.",
             rows, {"from", "to", "gaussians", "median", "p90", "largest", "upper"},
             Chart{.x = "from",
                   .y = {"median", "90 of 100 below", "largest", "T_upper"},
                   .title = "max(T) of a Gaussian",
                   .steps = true}));
}

Section missing(const ChartPoints& chart) {
  std::string list;
  for (const Point* point : chart.others) {
    list += fmt::format("{}{}: {}", list.empty() ? "" : "; ", text(point->row, "name"),
                        text(point->row, "problem"));
  }
  Section section{chart.id + "-missing", chart.title + ": not measured",
                  fmt::format("{} of {} settings have no result.", chart.others.size(),
                              chart.others.size() + chart.measured.size())};
  section.problem = list;
  return section;
}

}  // namespace

Page results_page(const Results& results) {
  Page page{.title = "Speed against accuracy"};
  const std::vector<ChartPoints> charts = charts_of(results.points);
  std::set<std::string> devices, lacks;
  for (const Point& point : results.points) {
    if (point.tried()) devices.insert(text(point.row, "device"));
    if (point.row.contains("no_exact")) lacks.insert(text(point.row, "no_exact"));
  }
  page.sentence = charts.empty() ? "No point was measured." : fastest_setting_sentence(charts.front());
  for (const std::string& lack : lacks) page.sentence += " There is nothing to compare with: " + lack;
  page.facts = {{"device", devices.empty() ? "none" : fmt::format("{}", fmt::join(devices, "; "))},
                {"settings", results.suite},
                {"program", results.program}};
  std::vector<Section>& sections = page.sections;
  for (const ChartPoints& chart : charts) {
    if (chart.title.starts_with(means_begin)) {
      sections.push_back(
          {chart.id, chart.title, "Speeds are geometric means; all else arithmetic ones.",
           table_of(chart.rows("name"), {"name", "speed", "psnr_db", "drop_db", "pairs_removed", "flip"})});
      continue;
    }
    if (chart.has("frame_ms")) sections.push_back(accuracy(chart, &chart == &charts.front()));
    add_targets(chart, sections);
    add_seen(chart, sections);
    add_levels(chart, sections);
    add_frames(chart, sections);
    if (chart.has("frame_ms")) {
      if (Section some = pictures(chart); some.figures.size() > 1) sections.push_back(std::move(some));
      sections.push_back(stages(chart));
    }
    if (!chart.measured.empty()) sections.push_back(all_numbers(chart));
    add_contributions(chart, sections);
    if (!chart.others.empty()) sections.push_back(missing(chart));
  }
  add_growth(charts, sections);
  return page;
}

}  // namespace binosplat::lab
