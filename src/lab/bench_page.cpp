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
struct Chart {
  std::string title;
  std::string id;
  std::vector<std::string> families;  // in the plan's order: colours mean the same in every chart
  std::vector<const BenchPoint*> measured;
  std::vector<const BenchPoint*> others;  // problems, and what is yet to be measured
  std::set<const BenchPoint*> front;
  bool photos = false;
  bool pair = false;  // of eyes
};

std::vector<Chart> charts_of(const std::vector<BenchPoint>& points) {
  const std::vector<bool> front = pareto_front(points);
  std::vector<Chart> charts;
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const BenchPoint& point = points[i];
    const std::string title = point.chart();
    const auto [found, is_new] = numbers.insert({title, charts.size()});
    if (is_new)
      charts.push_back({title, fmt::format("chart-{}", charts.size() + 1), {}, {}, {}, {}, false, false});
    Chart& chart = charts[found->second];
    (point.measured() ? chart.measured : chart.others).push_back(&point);
    if (front[i]) chart.front.insert(&point);
    if (std::find(chart.families.begin(), chart.families.end(), point.family) == chart.families.end())
      chart.families.push_back(point.family);
    chart.pair = point.eyes == 2;
    chart.photos = chart.photos || point.photos;
  }
  for (Chart& chart : charts) {
    std::stable_sort(chart.measured.begin(), chart.measured.end(),
                     [](const BenchPoint* a, const BenchPoint* b) { return a->frame_ms < b->frame_ms; });
  }
  return charts;
}

const BenchPoint* exact_of(const Chart& chart) {
  for (const BenchPoint* point : chart.measured) {
    const NamedSettings& settings = point->settings;
    if (!settings.precision && settings.th == "tau" && settings.tiles == "ellipse" && !settings.inset)
      return point;
  }
  return nullptr;
}

std::string sentence_of(const Chart& chart) {
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
  return sentence + ". Filled points are on the Pareto front: nothing is both quicker and nearer to exact.";
}

Section accuracy(const Chart& chart) {
  Plot plot;
  plot.x = {"frame time", "ms"};
  plot.y = {"PSNR against exact, equal pictures at 100", "dB"};
  for (const std::string& family : chart.families) series_of(plot, family);
  for (const BenchPoint* p : chart.measured)
    series_of(plot, p->family).add(p->frame_ms, p->psnr_db(), p->name, chart.front.count(p) != 0);
  Series front{"Pareto front", {}, true, true, false};
  for (const BenchPoint* point : chart.measured) {
    if (chart.front.count(point) != 0) front.add(point->frame_ms, point->psnr_db(), point->name, true);
  }
  if (!front.points.empty()) plot.series.push_back(front);
  return {chart.id, chart.title, sentence_of(chart), plot};
}

/// What eyes that look along their axes see, where it was asked for: by setting, and by the angle from there.
std::optional<Section> seen(const Chart& chart) {
  Plot plot{{"frame time", "ms"}, {"pixels whose difference can be seen", "%"}, {}};
  Table table{{"setting", "frame ms", "visible %"}, {}};
  const BenchPoint* quickest = nullptr;
  double least = INFINITY;
  for (const std::string& family : chart.families) series_of(plot, family);
  for (const BenchPoint* p : chart.measured) {
    if (!p->seen) continue;
    const double visible = 100.0 * p->seen->visible;
    series_of(plot, p->family).add(p->frame_ms, visible, p->name, visible < least);
    least = std::min(least, visible);
    if (quickest == nullptr && visible <= hardly_visible) quickest = p;
    auto& cells = table.rows.emplace_back(row(p->name, p->frame_ms, visible));
    for (const RingNumbers& ring : p->seen->rings) {
      if (table.rows.size() == 1)
        table.columns.push_back(fmt::format("dB at {:g} to {:g}°", ring.from_degrees, ring.to_degrees));
      cells.emplace_back(ring.psnr_db);
    }
  }
  if (table.rows.empty()) return {};
  std::string sentence =
      "Against the exact picture, for eyes that look along their axes, by the contrast that Geisler and "
      "Perry "
      "found to be needed at each distance from there; the numbers are PSNR by that distance. Filled points "
      "show less than all that are quicker.";
  if (quickest != nullptr)
    sentence += fmt::format(" The quickest with at most {:g} % of the pixels is “{}”: {:.4g} ms.",
                            hardly_visible, quickest->name, quickest->frame_ms);
  return Section{chart.id + "-seen", chart.title + ": what is seen", sentence, plot, table};
}

Section stages(const Chart& chart) {
  Plot plot{{"setting", "", false, true}, {"GPU time", "ms"}, {}, true};
  std::string slowest;
  double most = 0.0, sum = 0.0;
  for (const BenchPoint* point : chart.measured) {
    if (chart.front.count(point) == 0 && point != exact_of(chart)) continue;
    for (const gl::StageTime& stage : point->stages) {
      series_of(plot, stage.name).add(point->name, stage.ms);
      if (point != exact_of(chart)) continue;
      sum += stage.ms;
      if (stage.ms <= most) continue;
      most = stage.ms;
      slowest = stage.name;
    }
  }
  std::string sentence = "Where the time goes, for the points on the front and for the exact picture";
  if (!slowest.empty())
    sentence += fmt::format(": of the exact picture's, {:.0f} % goes to {}", 100 * most / sum, slowest);
  return {chart.id + "-stages", chart.title + ": stages", sentence + ".", plot};
}

Section numbers_section(const Chart& chart) {
  Table table{{"setting", "front", "frame ms", "p99 ms", "noise ms", "submit ms", "pairs", "alphas a pixel",
               "visible", "GPU MB", "PSNR dB", "worst view dB", "SSIM", "FLIP", "signed"},
              {}};
  if (chart.pair) table.columns.emplace_back("disagreement dB");
  if (chart.photos)
    table.columns.insert(table.columns.end(), {"photo PSNR dB", "drop dB", "photo SSIM", "photo FLIP"});
  for (const BenchPoint* p : chart.measured) {
    const ExactNumbers& exact = p->exact;
    auto& cells = table.rows.emplace_back(
        row(p->name, chart.front.count(p) != 0 ? "yes" : "", p->frame_ms, p->p99_ms, p->noise_ms,
            p->submit_ms, p->pairs, p->alphas, p->alphas_visible, static_cast<double>(p->gpu_bytes) / 1e6,
            exact.psnr_db, exact.worst_psnr_db, exact.ssim, exact.flip, exact.signed_mean));
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
  return {chart.id + "-numbers", chart.title + ": the numbers", sentence, {}, table};
}

/// The exact picture and those of the points on the front; nothing where there are not two.
std::optional<Section> chart_pictures(const Chart& chart) {
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
    if (*point != exact && chart.front.count(*point) != 0) add(**point);
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
std::optional<Section> floors(const Chart& chart) {
  Table table{{"setting", "stage", "ms", "MB", "million operations", "floor ms", "share %"}, {}};
  std::string widest;
  double gap = 0.0;
  for (const BenchPoint* p : chart.measured) {
    if (!p->profile || (chart.front.count(p) == 0 && p != exact_of(chart))) continue;
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
  return Section{chart.id + "-floors", chart.title + ": floors", sentence + ".", {}, table};
}

Section missing(const Chart& chart) {
  std::string list;
  for (const BenchPoint* point : chart.others) {
    list += fmt::format("{}{}: {}", list.empty() ? "" : "; ", point->name,
                        point->problem.empty() ? "not measured yet" : point->problem);
  }
  return {chart.id + "-missing",
          chart.title + ": not measured",
          fmt::format("{} of {} settings have no result.", chart.others.size(),
                      chart.others.size() + chart.measured.size()),
          {},
          {},
          list};
}

}  // namespace

Page bench_page(const BenchResults& results) {
  Page page;
  page.title = "Speed against accuracy";
  const std::vector<Chart> charts = charts_of(results.points);
  std::set<std::string> devices;
  for (const BenchPoint& point : results.points) {
    if (!point.device.empty()) devices.insert(point.device);
  }
  page.sentence = charts.empty() ? "No point was measured." : sentence_of(charts.front());
  page.facts = {{"device", devices.empty() ? "none" : fmt::format("{}", fmt::join(devices, "; "))},
                {"settings", results.axes},
                {"program", results.program}};
  for (const Chart& chart : charts) {
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
