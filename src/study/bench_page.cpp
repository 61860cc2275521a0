// The page of a bench run: a chart of accuracy against time, the stages' times and the numbers, by scene,
// eyes and size.

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "study/bench_results.h"

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

constexpr double good_db = 40.0;  // an error that is hard to see

/// The points of one chart, quickest first, and which of them are on the front.
struct Chart {
  std::string title;
  std::string id;
  std::vector<std::string> families;  // in the plan's order: colours mean the same in every chart
  std::vector<const ordered_json*> measured;
  std::vector<const ordered_json*> others;  // problems, and what is yet to be measured
  std::set<const ordered_json*> front;
  bool photos = false;
  bool pair = false;  // of eyes
};

std::string text(const ordered_json& value) { return value.get<std::string>(); }
double ms(const ordered_json& point) { return point["frame_ms"].get<double>(); }

double db(const ordered_json& point) {
  const ordered_json& value = point["exact"]["psnr_db"];
  return value.is_number() ? std::min(value.get<double>(), equal_db) : equal_db;
}

std::vector<Chart> charts_of(const ordered_json& points) {
  const std::vector<bool> front = pareto_front(points);
  std::vector<Chart> charts;
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ordered_json& point = points[i];
    const std::string title = fmt::format("{}, {}, size {}", text(point["scene"]),
                                          point["eyes"] == 2 ? "both eyes" : "one eye", text(point["size"]));
    const auto [found, is_new] = numbers.insert({title, charts.size()});
    if (is_new)
      charts.push_back({title, fmt::format("chart-{}", charts.size() + 1), {}, {}, {}, {}, false, false});
    Chart& chart = charts[found->second];
    (is_measured(point) ? chart.measured : chart.others).push_back(&point);
    if (front[i]) chart.front.insert(&point);
    const std::string family = text(point["family"]);
    if (std::find(chart.families.begin(), chart.families.end(), family) == chart.families.end())
      chart.families.push_back(family);
    chart.pair = point["eyes"] == 2;
    chart.photos = chart.photos || point.contains("photos");
  }
  for (Chart& chart : charts) {
    std::stable_sort(chart.measured.begin(), chart.measured.end(),
                     [](const ordered_json* a, const ordered_json* b) { return ms(*a) < ms(*b); });
  }
  return charts;
}

const ordered_json* exact_of(const Chart& chart) {
  for (const ordered_json* point : chart.measured) {
    const ordered_json& settings = (*point)["settings"];
    const bool full = !settings.contains("precision");
    if (full && settings["th"] == "tau" && settings["tiles"] == "ellipse") return point;
  }
  return nullptr;
}

std::string sentence_of(const Chart& chart) {
  if (chart.measured.empty()) return "Nothing was measured here yet.";
  const auto good = std::find_if(chart.measured.begin(), chart.measured.end(),
                                 [](const ordered_json* p) { return db(*p) >= good_db; });
  if (good == chart.measured.end())
    return fmt::format("Of {} settings none comes to {} dB against exact.", chart.measured.size(), good_db);
  std::string sentence =
      fmt::format("Of {} settings, “{}” is the quickest with {} dB or more against exact: {:.4g} ms a frame",
                  chart.measured.size(), text((**good)["name"]), good_db, ms(**good));
  const ordered_json* exact = exact_of(chart);
  if (exact != nullptr && exact != *good)
    sentence += fmt::format(", {:.2f} times as fast as the exact picture ({:.4g} ms)",
                            ms(*exact) / ms(**good), ms(*exact));
  return sentence + ". Filled points are on the Pareto front: nothing is both quicker and nearer to exact.";
}

Section accuracy(const Chart& chart) {
  Plot plot;
  plot.x = {"frame time", "ms"};
  plot.y = {"PSNR against exact, equal pictures at 100", "dB"};
  for (const std::string& family : chart.families) plot.series.push_back({family, {}, false, false, true});
  for (const ordered_json* point : chart.measured) {
    const auto family = std::find(chart.families.begin(), chart.families.end(), text((*point)["family"]));
    plot.series[static_cast<std::size_t>(family - chart.families.begin())].points.push_back(
        {ms(*point), db(*point), text((*point)["name"]), chart.front.count(point) != 0});
  }
  Series front{"Pareto front", {}, true, true, false};
  for (const ordered_json* point : chart.measured) {
    if (chart.front.count(point) != 0)
      front.points.push_back({ms(*point), db(*point), text((*point)["name"]), true});
  }
  if (!front.points.empty()) plot.series.push_back(front);
  return {chart.id, chart.title, sentence_of(chart), plot, {}, ""};
}

Section stages(const Chart& chart) {
  Plot plot{{"setting", "", false, true}, {"GPU time", "ms"}, {}, true};
  std::string slowest;
  double most = 0.0, sum = 0.0;
  for (const ordered_json* point : chart.measured) {
    if (chart.front.count(point) == 0 && point != exact_of(chart)) continue;
    for (const auto& [stage, value] : (*point)["stages_ms"].items()) {
      auto found = std::find_if(plot.series.begin(), plot.series.end(),
                                [&stage = stage](const Series& s) { return s.name == stage; });
      if (found == plot.series.end()) found = plot.series.insert(found, {stage, {}});
      found->points.push_back({text((*point)["name"]), value.get<double>(), ""});
      if (point != exact_of(chart)) continue;
      sum += value.get<double>();
      if (value.get<double>() <= most) continue;
      most = value.get<double>();
      slowest = stage;
    }
  }
  std::string sentence = "Where the time goes, for the points on the front and for the exact picture";
  if (!slowest.empty())
    sentence += fmt::format(": of the exact picture's, {:.0f} % goes to {}", 100 * most / sum, slowest);
  return {chart.id + "-stages", chart.title + ": stages", sentence + ".", plot, {}, ""};
}

Section numbers(const Chart& chart) {
  Table table{{"setting", "front", "frame ms", "p99 ms", "noise ms", "submit ms", "pairs", "alphas a pixel",
               "visible", "GPU MB", "PSNR dB", "worst view dB", "SSIM", "FLIP", "signed"},
              {}};
  if (chart.pair) table.columns.emplace_back("disagreement dB");
  if (chart.photos)
    table.columns.insert(table.columns.end(), {"photo PSNR dB", "drop dB", "photo SSIM", "photo FLIP"});
  for (const ordered_json* p : chart.measured) {
    const ordered_json& exact = (*p)["exact"];
    ordered_json row = {(*p)["name"],           chart.front.count(p) != 0 ? "yes" : "",
                        (*p)["frame_ms"],       (*p)["p99_ms"],
                        (*p)["noise_ms"],       (*p)["submit_ms"],
                        (*p)["pairs"],          (*p)["alphas"],
                        (*p)["alphas_visible"], (*p)["gpu_bytes"].get<double>() / 1e6,
                        exact["psnr_db"],       exact["worst_psnr_db"],
                        exact["ssim"],          exact["flip"],
                        exact["signed"]};
    if (chart.pair) row.push_back(exact["disagreement_db"]);
    for (const char* key : {"psnr_db", "drop_db", "ssim", "flip"}) {
      if (chart.photos) row.push_back(p->contains("photos") ? (*p)["photos"][key] : ordered_json());
    }
    table.rows.push_back(std::move(row));
  }
  const auto unsettled = std::count_if(chart.measured.begin(), chart.measured.end(),
                                       [](const ordered_json* p) { return !(*p)["settled"].get<bool>(); });
  std::string sentence =
      "Means over the views of the medians of their frames; an equal picture has no PSNR. Noise is half the "
      "spread of the repeats.";
  if (unsettled > 0)
    sentence += fmt::format(" At {} of {} settings the GPU's clock had not settled when timing began.",
                            unsettled, chart.measured.size());
  return {chart.id + "-numbers", chart.title + ": the numbers", sentence, {}, table, ""};
}

/// The stages of the points on the front and of the exact picture beside what the GPU could do at best.
std::optional<Section> floors(const Chart& chart) {
  Table table{{"setting", "stage", "ms", "MB", "million operations", "floor ms", "share %"}, {}};
  std::string widest;
  double gap = 0.0;
  const auto scaled = [](const ordered_json& value, double by) {
    return value.is_number() ? ordered_json(by * value.get<double>()) : ordered_json();
  };
  for (const ordered_json* p : chart.measured) {
    if (!p->contains("profile") || (chart.front.count(p) == 0 && p != exact_of(chart))) continue;
    for (const ordered_json& stage : (*p)["profile"]) {
      table.rows.push_back({(*p)["name"], stage["stage"], stage["ms"], scaled(stage["bytes"], 1e-6),
                            scaled(stage["operations"], 1e-6), stage["floor_ms"],
                            scaled(stage["share"], 100.0)});
      if (p != exact_of(chart) || !stage["floor_ms"].is_number()) continue;
      const double over = stage["ms"].get<double>() - stage["floor_ms"].get<double>();
      if (over <= gap) continue;
      gap = over;
      widest = text(stage["stage"]);
    }
  }
  if (table.rows.empty()) return {};
  std::string sentence =
      "What each stage must move and compute at least, over the rates that small programs reach on this GPU";
  if (!widest.empty())
    sentence += fmt::format(": the exact picture's {} has most to gain, {:.3g} ms", widest, gap);
  return Section{chart.id + "-floors", chart.title + ": floors", sentence + ".", {}, table, ""};
}

Section missing(const Chart& chart) {
  std::string list;
  for (const ordered_json* point : chart.others) {
    list += fmt::format("{}{}: {}", list.empty() ? "" : "; ", text((*point)["name"]),
                        point->contains("problem") ? text((*point)["problem"]) : "not measured yet");
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

Page bench_page(const ordered_json& results) {
  Page page;
  page.title = "Speed against accuracy";
  page.data = results;
  const std::vector<Chart> charts = charts_of(results["points"]);
  std::set<std::string> devices;
  for (const ordered_json& point : results["points"]) {
    if (point.contains("device")) devices.insert(text(point["device"]));
  }
  std::string names;
  for (const std::string& device : devices) names += (names.empty() ? "" : "; ") + device;
  page.sentence = charts.empty() ? "No point was measured." : sentence_of(charts.front());
  page.facts = {{"device", names.empty() ? "none" : names},
                {"settings", results["plan"]["axes_name"]},
                {"program", results["plan"]["program"]}};
  for (const Chart& chart : charts) {
    page.sections.push_back(accuracy(chart));
    if (!chart.measured.empty()) {
      page.sections.push_back(stages(chart));
      page.sections.push_back(numbers(chart));
      if (auto section = floors(chart)) page.sections.push_back(std::move(*section));
    }
    if (!chart.others.empty()) page.sections.push_back(missing(chart));
  }
  return page;
}

}  // namespace binosplat::study
