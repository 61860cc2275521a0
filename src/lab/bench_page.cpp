// The page of a bench run: a chart of accuracy against time, the stages' times and the numbers, by scene,
// eyes and size.

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "lab/bench_results.h"

namespace binosplat::lab {

namespace {

constexpr double good_db = 40.0;        // an error that is hard to see
constexpr double hardly_visible = 1.0;  // % of the pixels

/// The points of one chart, quickest first, and which of them are on the front.
struct BenchChart {
  std::string title;
  std::string id;
  std::vector<std::string> families;  // in the plan's order: colours mean the same in every chart
  std::vector<const BenchPoint*> measured;
  std::vector<const BenchPoint*> others;  // problems, and what is yet to be measured
  std::set<const BenchPoint*> front;
  bool photos = false;
  bool pair = false;  // of eyes

  bool is_front(const BenchPoint* point) const { return front.contains(point); }
};

std::vector<BenchChart> charts_of(const std::vector<BenchPoint>& points) {
  const std::vector<bool> front = pareto_front(points);
  std::vector<BenchChart> charts;
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const BenchPoint& point = points[i];
    const std::string title = point.chart();
    const auto [found, is_new] = numbers.insert({title, charts.size()});
    if (is_new)
      charts.push_back({title, fmt::format("chart-{}", charts.size() + 1), {}, {}, {}, {}, false, false});
    BenchChart& chart = charts[found->second];
    (point.measured() ? chart.measured : chart.others).push_back(&point);
    if (front[i]) chart.front.insert(&point);
    if (std::find(chart.families.begin(), chart.families.end(), point.family) == chart.families.end())
      chart.families.push_back(point.family);
    chart.pair = point.eyes == 2;
    chart.photos = chart.photos || point.photos;
  }
  for (BenchChart& chart : charts) {
    std::stable_sort(chart.measured.begin(), chart.measured.end(),
                     [](const BenchPoint* a, const BenchPoint* b) { return a->frame_ms < b->frame_ms; });
  }
  return charts;
}

const BenchPoint* exact_of(const BenchChart& chart) {
  for (const BenchPoint* point : chart.measured) {
    const NamedSettings& settings = point->settings;
    if (!settings.precision && settings.th == "tau" && settings.tiles == "ellipse" && !settings.inset)
      return point;
  }
  return nullptr;
}

std::string sentence_of(const BenchChart& chart) {
  if (chart.measured.empty()) return "Nothing was measured here yet.";
  const auto good = std::find_if(chart.measured.begin(), chart.measured.end(),
                                 [](const BenchPoint* p) { return p->psnr_db() >= good_db; });
  if (good == chart.measured.end())
    return fmt::format("Of {} settings none comes to {} dB against exact.", chart.measured.size(), good_db);
  std::string sentence =
      fmt::format("Of {} settings, “{}” is the quickest with {} dB or more against exact: {:.4g} ms a frame",
                  chart.measured.size(), (*good)->name, good_db, (*good)->frame_ms);
  const BenchPoint* exact = exact_of(chart);
  if (exact != nullptr && exact != *good)
    sentence += fmt::format(", {:.2f} times as fast as the exact picture ({:.4g} ms)",
                            exact->frame_ms / (*good)->frame_ms, exact->frame_ms);
  return sentence +
         ". Filled points are on the Pareto front: nothing is both nearer to exact and, beyond noise, "
         "quicker. Bars are half the spread of the repeats.";
}

constexpr const char* psnr_column = "PSNR against exact dB, equal pictures at 100";

const char* yes_if(bool so) { return so ? "yes" : ""; }

Section accuracy(const BenchChart& chart) {
  Table table{{"setting", "family", "front", "frame ms", "noise ms", psnr_column}, {}};
  for (const BenchPoint* p : chart.measured)
    table.rows.push_back(
        row(p->name, p->family, yes_if(chart.is_front(p)), p->frame_ms, p->noise_ms, p->psnr_db()));
  Chart plot{"frame ms", {psnr_column}, "family", "setting", "front", "", chart.families};
  plot.line = false;
  plot.front = true;
  plot.spread = "noise ms";
  return {chart.id, chart.title, sentence_of(chart), {}, plot, table};
}

/// What eyes that look along their axes see, where it was asked for: by setting, and by the angle from there.
std::optional<Section> seen(const BenchChart& chart) {
  Table table{{"setting", "family", "fewest so far", "frame ms", "visible %"}, {}};
  const BenchPoint* quickest = nullptr;
  double least = INFINITY;
  for (const BenchPoint* p : chart.measured) {
    if (!p->seen) continue;
    const double visible = 100.0 * p->seen->visible;
    auto& cells =
        table.rows.emplace_back(row(p->name, p->family, yes_if(visible < least), p->frame_ms, visible));
    least = std::min(least, visible);
    if (quickest == nullptr && visible <= hardly_visible) quickest = p;
    for (const RingNumbers& ring : p->seen->rings) {
      if (table.rows.size() == 1)
        table.columns.push_back(fmt::format("dB at {:g} to {:g}°", ring.from_degrees, ring.to_degrees));
      cells.emplace_back(ring.psnr_db);
    }
  }
  if (table.rows.empty()) return {};
  std::string sentence =
      "Against the exact picture, for eyes that look along their axes, by the contrast that Geisler and "
      "Perry found to be needed at each distance from there; the numbers are PSNR by that distance. Filled "
      "points show less than all that are quicker.";
  if (quickest != nullptr)
    sentence += fmt::format(" The quickest with at most {:g} % of the pixels is “{}”: {:.4g} ms.",
                            hardly_visible, quickest->name, quickest->frame_ms);
  Chart plot{"frame ms", {"visible %"}, "family", "setting", "fewest so far", "", chart.families};
  plot.line = false;
  return Section{chart.id + "-seen", chart.title + ": what is seen", sentence, table, plot};
}

Section stages(const BenchChart& chart) {
  Table table{{"setting"}, {}};
  std::vector<std::string>& columns = table.columns;
  std::string slowest;
  double most = 0.0, sum = 0.0;
  for (const BenchPoint* point : chart.measured) {
    if (!chart.is_front(point) && point != exact_of(chart)) continue;
    auto& cells = table.rows.emplace_back(row(point->name));
    for (const gl::StageTime& stage : point->stages) {
      const std::string column = stage.name + " ms";
      const auto at = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
      if (at == columns.size()) columns.push_back(column);
      cells.resize(std::max(cells.size(), at + 1));
      cells[at] = stage.ms;
      if (point != exact_of(chart)) continue;
      sum += stage.ms;
      if (stage.ms <= most) continue;
      most = stage.ms;
      slowest = stage.name;
    }
  }
  for (auto& cells : table.rows) cells.resize(columns.size());
  std::string sentence = "Where the time goes, for the points on the front and for the exact picture";
  if (!slowest.empty())
    sentence += fmt::format(": of the exact picture's, {:.0f} % goes to {}", 100 * most / sum, slowest);
  Chart plot{.x = "setting", .y = {columns.begin() + 1, columns.end()}, .title = "GPU time, ms"};
  plot.bars = true;
  return {chart.id + "-stages", chart.title + ": stages", sentence + ".", {}, plot, table};
}

Section numbers_section(const BenchChart& chart) {
  Table table{{"setting", "front", "frame ms", "p99 ms", "noise ms", "submit ms", "pairs", "alphas a pixel",
               "visible", "GPU MB", "PSNR dB", "worst view dB", "SSIM", "FLIP", "signed"},
              {}};
  if (chart.pair) table.columns.emplace_back("disagreement dB");
  if (chart.photos)
    table.columns.insert(table.columns.end(), {"photo PSNR dB", "drop dB", "photo SSIM", "photo FLIP"});
  for (const BenchPoint* p : chart.measured) {
    const ExactNumbers& exact = p->exact;
    auto& cells = table.rows.emplace_back(
        row(p->name, yes_if(chart.is_front(p)), p->frame_ms, p->p99_ms, p->noise_ms, p->submit_ms, p->pairs,
            p->alphas, p->alphas_visible, static_cast<double>(p->gpu_bytes) / 1e6, exact.psnr_db,
            exact.worst_psnr_db, exact.ssim, exact.flip, exact.signed_mean));
    if (chart.pair) cells.emplace_back(exact.disagreement_db);
    const PhotoNumbers photos = p->photos.value_or(PhotoNumbers{});
    if (chart.photos) cells.insert(cells.end(), {photos.psnr_db, photos.drop_db, photos.ssim, photos.flip});
  }
  const auto unsettled = std::count_if(chart.measured.begin(), chart.measured.end(),
                                       [](const BenchPoint* p) { return !p->settled; });
  std::string sentence =
      "Means over the views of the medians of their frames; an equal picture has no PSNR. Noise is half the "
      "spread of the repeats.";
  if (unsettled > 0)
    sentence += fmt::format(" At {} of {} settings the GPU's clock had not settled when timing began.",
                            unsettled, chart.measured.size());
  return {chart.id + "-numbers", chart.title + ": the numbers", sentence, table};
}

/// The exact picture and those of the points on the front; nothing where there are not two.
std::optional<Section> chart_pictures(const BenchChart& chart) {
  Section section{chart.id + "-pictures", chart.title + ": pictures", ""};
  section.compared = true;
  std::string view;
  const BenchPoint* exact = exact_of(chart);
  const auto add = [&](const BenchPoint& point) {
    if (!point.picture) return;
    section.figures.push_back(
        {fmt::format("{}, {}, {:.4g} ms", point.name,
                     std::isfinite(point.exact.psnr_db) ? fmt::format("{:.1f} dB", point.exact.psnr_db)
                                                        : "equal to exact",
                     point.frame_ms),
         *point.picture});
    view = point.views.front().name;
  };
  if (exact != nullptr) add(*exact);
  for (auto point = chart.measured.rbegin(); point != chart.measured.rend(); ++point) {
    if (*point != exact && chart.is_front(*point)) add(**point);
  }
  if (section.figures.size() < 2) return {};
  section.sentence = fmt::format(
      "View {}{}, of the exact picture and the points on the front; drag across it. The numbers are means "
      "over "
      "all views.",
      view, chart.pair ? ", left eye" : "");
  return section;
}

/// The stages of the points on the front and of the exact picture beside what the GPU could do at best.
std::optional<Section> floors(const BenchChart& chart) {
  Table table{{"setting", "stage", "ms", "MB", "million operations", "floor ms", "share %"}, {}};
  std::string widest;
  double gap = 0.0;
  for (const BenchPoint* p : chart.measured) {
    if (!p->profile || (!chart.is_front(p) && p != exact_of(chart))) continue;
    for (const StageFloor& stage : *p->profile) {
      table.rows.push_back({p->name, stage.stage, stage.ms, 1e-6 * stage.bytes, 1e-6 * stage.operations,
                            stage.floor_ms, 100.0 * stage.share});
      if (p != exact_of(chart) || !(stage.ms - stage.floor_ms > gap)) continue;
      gap = stage.ms - stage.floor_ms;
      widest = stage.stage;
    }
  }
  if (table.rows.empty()) return {};
  std::string sentence =
      "What each stage must move and compute at least, over the rates that small programs reach on this GPU";
  if (!widest.empty())
    sentence += fmt::format(": the exact picture's {} has most to gain, {:.3g} ms", widest, gap);
  return Section{chart.id + "-floors", chart.title + ": floors", sentence + ".", table};
}

Section missing(const BenchChart& chart) {
  std::string list;
  for (const BenchPoint* point : chart.others) {
    list += fmt::format("{}{}: {}", list.empty() ? "" : "; ", point->name,
                        point->problem.empty() ? "not measured yet" : point->problem);
  }
  Section section{chart.id + "-missing", chart.title + ": not measured", ""};
  section.sentence = fmt::format("{} of {} settings have no result.", chart.others.size(),
                                 chart.others.size() + chart.measured.size());
  section.problem = list;
  return section;
}

}  // namespace

Page bench_page(const BenchResults& results) {
  Page page;
  page.title = "Speed against accuracy";
  const std::vector<BenchChart> charts = charts_of(results.points);
  std::set<std::string> devices;
  for (const BenchPoint& point : results.points) {
    if (!point.device.empty()) devices.insert(point.device);
  }
  page.sentence = charts.empty() ? "No point was measured." : sentence_of(charts.front());
  page.facts = {{"device", devices.empty() ? "none" : fmt::format("{}", fmt::join(devices, "; "))},
                {"settings", results.axes},
                {"program", results.program}};
  for (const BenchChart& chart : charts) {
    page.sections.push_back(accuracy(chart));
    if (auto section = seen(chart)) page.sections.push_back(std::move(*section));
    if (auto section = chart_pictures(chart)) page.sections.push_back(std::move(*section));
    if (!chart.measured.empty()) {
      page.sections.push_back(stages(chart));
      page.sections.push_back(numbers_section(chart));
      if (auto section = floors(chart)) page.sections.push_back(std::move(*section));
    }
    if (!chart.others.empty()) page.sections.push_back(missing(chart));
  }
  return page;
}

}  // namespace binosplat::lab
