// The page of AdaGScale's analyses: each figure and table of the paper, on this scene.

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "study/analyses.h"

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

// AdaGScale, table IV: pairs removed against FlashGS at 0.1 to 0.5 dB, K tuned on the test views, mean over
// the paper's own scenes.
constexpr struct {
  double target_db, removed;
} paper_removed[] = {{0.1, 0.310}, {0.2, 0.358}, {0.3, 0.389}, {0.4, 0.412}, {0.5, 0.431}};

std::string text(const ordered_json& value) { return value.get<std::string>(); }

bool is_drop(const ordered_json& results) { return results["target"] == "drop"; }

/// The names of the targets' rules, in their order.
std::vector<std::string> rules_of(const ordered_json& results) {
  std::vector<std::string> names;
  for (const ordered_json& entry : results["targets"]) {
    if (std::find(names.begin(), names.end(), text(entry["name"])) == names.end())
      names.push_back(text(entry["name"]));
  }
  return names;
}

double exact_ms(const ordered_json& results) {
  for (const ordered_json& system : results["systems"]) {
    if (system["settings"]["tiles"] == "ellipse" && system["settings"]["th"] == "tau")
      return system["frame_ms"].get<double>();
  }
  return NAN;
}

Section scene(const ordered_json& results) {
  Table table{{"", "views", "PSNR of the exact pictures against the photos, dB"}, {}};
  for (const char* which : {"calibration", "test"}) {
    table.rows.push_back({which, results["views"][which].size(),
                          is_drop(results) ? results["photo_db"][which] : ordered_json()});
  }
  std::string sentence = fmt::format("{} Gaussians in pictures of {} x {} px.", results["gaussians"].dump(),
                                     results["width"].dump(), results["height"].dump());
  if (!is_drop(results)) sentence += " There are no photos: what is lost is told against exact pictures.";
  return {"scene", "The scene (tables I and II)", sentence, {}, table, ""};
}

Section systems(const ordered_json& results) {
  Plot plot{{"system", "", false, true}, {"GPU time", "ms"}, {}, true};
  Table table{{"system", "frame ms", "times 3D-GS", "pairs",
               is_drop(results) ? "drop dB" : "PSNR against exact dB", "worst dB", "in view"},
              {}};
  const double slowest = results["systems"].front()["frame_ms"].get<double>();
  for (const ordered_json& system : results["systems"]) {
    table.rows.push_back({system["name"], system["frame_ms"], slowest / system["frame_ms"].get<double>(),
                          system["pairs"], system["mean_db"], system["worst_db"], system["worst_view"]});
    for (const auto& [stage, ms] : system["stages_ms"].items()) {
      auto found = std::find_if(plot.series.begin(), plot.series.end(),
                                [&stage = stage](const Series& s) { return s.name == stage; });
      if (found == plot.series.end()) found = plot.series.insert(found, {stage, {}});
      found->points.push_back({text(system["name"]), ms.get<double>(), ""});
    }
  }
  const ordered_json& last = results["systems"].back();
  return {"systems",
          "Where the time goes (figures 2 and 8)",
          fmt::format("The systems by what decides their Gaussian-tile pairs, all in this renderer: “{}” "
                      "draws {:.2f} times as fast as “{}”.",
                      text(last["name"]), slowest / last["frame_ms"].get<double>(),
                      text(results["systems"].front()["name"])),
          plot,
          table,
          ""};
}

Section skipping(const ordered_json& results) {
  const ordered_json& curves = results["contributions"]["skipping"];
  const bool drop = curves.front()["points"].front().contains("drop_db");
  Plot plot{{"fragments skipped", "%"}, {"PSNR against exact", "dB"}, {}};
  Table table{{"skipped by", "fragments skipped %", "PSNR against exact dB"}, {}};
  if (drop) table.columns.emplace_back("drop against the photos dB");
  for (const ordered_json& curve : curves) {
    Series& series = plot.series.emplace_back(Series{text(curve["by"]), {}, true});
    for (const ordered_json& point : curve["points"]) {
      const double percent = 100.0 * point["share"].get<double>();
      series.points.push_back({percent, point["psnr_db"].get<double>(), ""});
      ordered_json row = {curve["by"], percent, point["psnr_db"]};
      if (drop) row.push_back(point["drop_db"]);
      table.rows.push_back(std::move(row));
    }
  }
  const auto half = [&](std::size_t curve) { return curves[curve]["points"][4]["psnr_db"].get<double>(); };
  return {
      "skipping",
      "What the lowest contributions are worth (figures 4a, 5a and 5b)",
      fmt::format("Without the half of all that pixels blend that has the lowest alpha T the pictures keep "
                  "{:.1f} dB; {:.1f} dB where max(T) of each Gaussian is known, {:.1f} dB with the light by "
                  "depth, {:.1f} dB by alpha alone.",
                  half(0), half(1), half(2), half(3)),
      plot,
      table,
      ""};
}

/// A plot of one of the values by depth.
Section by_depth(const ordered_json& results, const char* value, const char* id, const std::string& title,
                 const std::string& label, const std::string& sentence) {
  Plot plot{{"view depth", "world units"}, {label, ""}, {}};
  Table table{{"from", "to", "Gaussians", "median", "90 of 100 below", "largest"}, {}};
  const bool light = std::string(value) == "light";
  if (light) table.columns.emplace_back("T_upper");
  for (const auto& [key, name] : {std::pair{"median", "median"}, std::pair{"p90", "90 of 100 below"},
                                  std::pair{"largest", "largest"}}) {
    Series& series = plot.series.emplace_back(Series{name, {}, true});
    for (const ordered_json& bin : results["contributions"]["by_depth"]) {
      if (!bin[value][key].is_number()) continue;
      series.points.push_back({(bin["from"].get<double>() + bin["to"].get<double>()) / 2,
                               bin[value][key].get<double>(), bin["gaussians"].dump() + " Gaussians"});
    }
  }
  if (light) {
    Series& series =
        plot.series.emplace_back(Series{"T_upper of the calibration views", {}, true, true, false});
    for (const ordered_json& bin : results["contributions"]["by_depth"])
      series.points.push_back({bin["from"].get<double>(), bin["upper"].get<double>(), ""});
  }
  for (const ordered_json& bin : results["contributions"]["by_depth"]) {
    const ordered_json& of = bin[value];
    ordered_json row = {bin["from"], bin["to"], bin["gaussians"], of["median"], of["p90"], of["largest"]};
    if (light) row.push_back(bin["upper"]);
    table.rows.push_back(std::move(row));
  }
  return {id,   title, sentence,
          plot, table, plot.series.front().points.empty() ? "No pixel blends anything." : ""};
}

/// How many of the bins, of those that hold Gaussians, have a largest max(T) above a half.
std::string lit_bins(const ordered_json& results) {
  int lit = 0, all = 0;
  for (const ordered_json& bin : results["contributions"]["by_depth"]) {
    if (!bin["light"]["largest"].is_number()) continue;
    ++all;
    lit += bin["light"]["largest"].get<double>() > 0.5;
  }
  return fmt::format("{} of {}", lit, all);
}

Section real_drops(const ordered_json& results) {
  const bool drop = is_drop(results);
  Plot plot{{"target on the calibration views", "dB"},
            {drop ? "drop on the test views" : "PSNR on the test views", "dB"},
            {}};
  Table table{{"rule", "target dB", "reached dB", "test views dB", "worst dB", "in view", "loss"}, {}};
  double excess = -INFINITY;
  for (const std::string& rule : rules_of(results)) {
    Series& series = plot.series.emplace_back(Series{rule, {}, true});
    for (const ordered_json& entry : results["targets"]) {
      if (entry["name"] != rule) continue;
      const double target = entry["target_db"], real = entry["mean_db"];
      excess = std::max(excess, drop ? real - target : target - real);
      series.points.push_back({target, real, fmt::format("worst: {}", text(entry["worst_view"]))});
      table.rows.push_back({rule, target, entry["reached_db"], real, entry["worst_db"], entry["worst_view"],
                            entry["settings"]["loss"]});
    }
  }
  return {"real-drops",
          "What is lost where nothing was calibrated (table III)",
          fmt::format("Losses found on {} calibration views cost {} other views {}.",
                      results["views"]["calibration"].size(), results["views"]["test"].size(),
                      excess > 0 ? fmt::format("at most {:.3f} dB more than the target, in the mean", excess)
                                 : std::string("no more than the target, in the mean")),
          plot,
          table,
          ""};
}

Section removed(const ordered_json& results) {
  Plot plot{{"target", "dB"}, {"pairs removed on the test views", "%"}, {}};
  Table table{{"rule", "target dB", "test views dB", "pairs removed %", "frame ms", "times exact"}, {}};
  const double exact = exact_ms(results);
  const ordered_json* most = nullptr;
  for (const std::string& rule : rules_of(results)) {
    Series& series = plot.series.emplace_back(Series{rule, {}, true});
    for (const ordered_json& entry : results["targets"]) {
      if (entry["name"] != rule) continue;
      const double percent = 100.0 * entry["pairs_removed"].get<double>();
      series.points.push_back({entry["target_db"].get<double>(), percent, ""});
      table.rows.push_back({rule, entry["target_db"], entry["mean_db"], percent, entry["frame_ms"],
                            exact / entry["frame_ms"].get<double>()});
      if (most == nullptr || entry["pairs_removed"] > (*most)["pairs_removed"]) most = &entry;
    }
  }
  if (is_drop(results)) {
    Series& series = plot.series.emplace_back(Series{"AdaGScale's paper, its scenes", {}, true});
    for (const auto& [target, share] : paper_removed) {
      series.points.push_back({target, 100.0 * share, ""});
      table.rows.push_back({series.name, target, nullptr, 100.0 * share, nullptr, nullptr});
    }
  }
  return {"removed",
          "Pairs removed (table IV)",
          fmt::format("“{}” removes the most pairs of the exact ellipse test: {:.1f} % at {} dB.{}",
                      text((*most)["name"]), 100.0 * (*most)["pairs_removed"].get<double>(),
                      (*most)["target_db"].dump(),
                      is_drop(results) ? " The paper's K was tuned on the test views themselves." : ""),
          plot,
          table,
          ""};
}

Section speed(const ordered_json& results) {
  const bool drop = is_drop(results);
  Plot plot{{drop ? "drop on the test views" : "PSNR on the test views", "dB"},
            {"times as fast as the exact frame", ""},
            {}};
  const double exact = exact_ms(results);
  std::string best;
  double fastest = 0.0;
  for (const std::string& rule : rules_of(results)) {
    Series& series = plot.series.emplace_back(Series{rule, {}, true});
    for (const ordered_json& entry : results["targets"]) {
      if (entry["name"] != rule) continue;
      const double times = exact / entry["frame_ms"].get<double>();
      series.points.push_back(
          {entry["mean_db"].get<double>(), times, entry["target_db"].dump() + " dB asked"});
      if (times > fastest) {
        fastest = times;
        best = rule;
      }
    }
  }
  return {"speed",
          "Speed at equal loss (figure 8)",
          fmt::format("The fastest is “{}”: {:.2f} times as fast as the exact frame ({:.4g} ms).", best,
                      fastest, exact),
          plot,
          {},
          ""};
}

}  // namespace

Page analysis_page(const ordered_json& results) {
  Page page;
  page.title = "AdaGScale's analyses of " + text(results["scene"]);
  page.data = results;
  page.facts = {{"device", results["device"]},
                {"scene", results["scene"]},
                {"calibration views", results["views"]["calibration"].size()},
                {"test views", results["views"]["test"].size()}};
  page.sections = {
      scene(results),
      systems(results),
      skipping(results),
      by_depth(results, "contribution", "contributions", "Contribution against depth (figure 4b)",
               "largest alpha T of a Gaussian",
               "What each Gaussian contributes to the pixel that shows it best, by its depth in the view."),
      by_depth(results, "light", "light", "Light against depth (figure 6)", "max(T) of a Gaussian",
               fmt::format("In {} bins of depth some Gaussian is lit by more than half: there a table by "
                           "depth can tell little, and what each Gaussian measured tells much.",
                           lit_bins(results))),
      real_drops(results),
      removed(results),
      speed(results)};
  page.sentence = page.sections[6].sentence;
  return page;
}

}  // namespace binosplat::study
