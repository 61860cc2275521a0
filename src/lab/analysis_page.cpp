// The page of AdaGScale's analyses: each figure and table of the paper, on this scene.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lab/analyses.h"
#include "lab/settings.h"

namespace binosplat::lab {

namespace {

// AdaGScale, table IV: pairs removed against FlashGS at 0.1 to 0.5 dB, K tuned on the test views, mean over
// the paper's own scenes.
constexpr struct {
  double target_db, removed;
} paper_removed[] = {{0.1, 0.310}, {0.2, 0.358}, {0.3, 0.389}, {0.4, 0.412}, {0.5, 0.431}};

double exact_ms(const Analysis& analysis) {
  for (const AnalysedSystem& system : analysis.systems) {
    if (system.settings.tiles == TILES_ELLIPSE && render::is_exact(system.settings.th))
      return system.times.frame_ms;
  }
  return NAN;
}

Section scene(const Analysis& a) {
  const auto db = [&](double photo_db) { return a.drop() ? Cell(photo_db) : Cell(); };
  const Table table{{"", "views", "PSNR of the exact pictures against the photos, dB"},
                    {row("calibration", a.calibration_views.size(), db(a.calibration_photo_db)),
                     row("test", a.test_views.size(), db(a.test_photo_db))}};
  std::string sentence =
      fmt::format("{} Gaussians in pictures of {} x {} px.", a.gaussians, a.width, a.height);
  if (!a.drop()) sentence += " There are no photos: what is lost is against exact pictures.";
  return {"scene", "The scene (tables I and II)", sentence, table};
}

Section systems(const Analysis& a) {
  Table table{{"system", "frame ms", "times 3D-GS", "pairs", a.drop() ? "drop dB" : "PSNR against exact dB",
               "worst dB", "in view"},
              {}};
  Chart chart{.x = "system", .title = "GPU time, ms", .bars = true};
  for (const gl::StageTime& stage : a.systems.front().times.stages) chart.y.push_back(stage.name + " ms");
  table.columns.insert(table.columns.end(), chart.y.begin(), chart.y.end());
  const double slowest = a.systems.front().times.frame_ms;
  for (const AnalysedSystem& system : a.systems) {
    const Typical& times = system.times;
    auto& cells =
        table.rows.emplace_back(row(system.name, times.frame_ms, slowest / times.frame_ms, times.pairs,
                                    system.mean_db, system.worst_db, system.worst_view));
    for (const gl::StageTime& stage : times.stages) cells.emplace_back(stage.ms);
    cells.resize(table.columns.size());
  }
  const AnalysedSystem& last = a.systems.back();
  return {"systems", "Where the time goes (figures 2 and 8)",
          fmt::format("The systems by what decides their Gaussian-tile pairs, all in this renderer: “{}” "
                      "draws {:.2f} times as fast as “{}”.",
                      last.name, slowest / last.times.frame_ms, a.systems.front().name),
          table, chart};
}

Section systems_pictures(const Analysis& a) {
  Section section{
      "pictures", "The systems' pictures",
      fmt::format("Test view {}: drag across it to see what the systems differ in. The numbers are means "
                  "over all test views.",
                  a.test_views.front())};
  section.compared = true;
  for (const AnalysedSystem& system : a.systems) {
    if (system.picture)
      section.figures.push_back(
          {fmt::format("{}, {:.4g} ms", system.name, system.times.frame_ms), *system.picture});
  }
  return section;
}

Section skipping(const Analysis& a) {
  const std::vector<SkippingCurve>& curves = a.contributions.skipping;
  const bool drop = curves.front().points.front().drop_db.has_value();
  Table table{{"skipped by", "fragments skipped %", "PSNR against exact dB"}, {}};
  if (drop) table.columns.emplace_back("drop against the photos dB");
  for (const SkippingCurve& curve : curves) {
    for (const SkippingCurve::Point& point : curve.points) {
      auto& cells = table.rows.emplace_back(row(curve.by, 100.0 * point.share, point.psnr_db));
      if (drop) cells.emplace_back(point.drop_db);
    }
  }
  const auto half = [&](std::size_t curve) { return curves[curve].points[4].psnr_db; };
  return {
      "skipping", "What the lowest contributions are worth (figures 4a, 5a and 5b)",
      fmt::format("Without the half of all that pixels blend that has the lowest alpha T the pictures keep "
                  "{:.1f} dB; {:.1f} dB where max(T) of each Gaussian is known, {:.1f} dB with the light by "
                  "depth, {:.1f} dB by alpha alone.",
                  half(0), half(1), half(2), half(3)),
      table, Chart{"fragments skipped %", {"PSNR against exact dB"}, "skipped by"}};
}

/// A chart of one of the values by depth.
Section section_by_depth(const Analysis& a, Spread DepthBin::*value, const char* id, const std::string& title,
                         const std::string& label, const std::string& sentence) {
  const std::vector<DepthBin>& bins = a.contributions.by_depth;
  Chart chart{.x = "from", .y = {"median", "90 of 100 below", "largest"}, .title = label, .steps = true};
  Table table{{"from", "to", "Gaussians", "median", "90 of 100 below", "largest"}, {}};
  const bool of_transmittance = value == &DepthBin::transmittance;
  if (of_transmittance) {
    table.columns.emplace_back("T_upper");
    chart.y.emplace_back("T_upper");
  }
  bool shown = false;
  for (const DepthBin& bin : bins) {
    const Spread& of = bin.*value;
    shown = shown || !std::isnan(of.median);
    auto& cells =
        table.rows.emplace_back(row(bin.from, bin.to, bin.gaussians, of.median, of.p90, of.largest));
    if (of_transmittance) cells.emplace_back(bin.bound);
  }
  return {id, title, sentence, table, chart, {}, shown ? "" : "No pixel blends anything."};
}

/// How many of the bins, of those that hold Gaussians, have a largest max(T) above a half.
std::string bright_bins(const Analysis& a) {
  int bright = 0, all = 0;
  for (const DepthBin& bin : a.contributions.by_depth) {
    all += bin.gaussians > 0;
    bright += bin.transmittance.largest > 0.5;
  }
  return fmt::format("{} of {}", bright, all);
}

Section real_drops(const Analysis& a) {
  Table table{{"rule", "target dB", "reached dB", "test views dB", "worst dB", "in view", "tolerance"}, {}};
  double excess = -INFINITY;
  for (const AnalysedSystem& entry : a.targets) {
    const double target = *entry.target_db, real = entry.mean_db;
    excess = std::max(excess, a.drop() ? real - target : target - real);
    table.rows.push_back(row(entry.name, target, entry.reached_db, real, entry.worst_db, entry.worst_view,
                             named(entry.settings).tolerance));
  }
  return {"real-drops", "What is lost where nothing was calibrated (table III)",
          fmt::format("Tolerances found on {} calibration views cost {} other views {}.",
                      a.calibration_views.size(), a.test_views.size(),
                      excess > 0 ? fmt::format("at most {:.3f} dB more than the target, in the mean", excess)
                                 : std::string("no more than the target, in the mean")),
          table, Chart{"target dB", {"test views dB"}, "rule", "in view"}};
}

Section removed(const Analysis& a) {
  Table table{{"rule", "target dB", "test views dB", "pairs removed %", "frame ms", "times exact"}, {}};
  const AnalysedSystem* most = &a.targets.front();
  for (const AnalysedSystem& entry : a.targets) {
    const double ms = entry.times.frame_ms;
    table.rows.push_back(
        row(entry.name, entry.target_db, entry.mean_db, 100.0 * entry.pairs_removed, ms, exact_ms(a) / ms));
    if (entry.pairs_removed > most->pairs_removed) most = &entry;
  }
  if (a.drop()) {
    for (const auto& [target, share] : paper_removed)
      table.rows.push_back(
          row("AdaGScale's paper, its scenes", target, nullptr, 100.0 * share, nullptr, nullptr));
  }
  return {"removed", "Pairs removed (table IV)",
          fmt::format("“{}” removes the most pairs of the exact ellipse test: {:.1f} % at {} dB.{}",
                      most->name, 100.0 * most->pairs_removed, json_text(*most->target_db),
                      a.drop() ? " The paper's K was tuned on the test views themselves." : ""),
          table, Chart{"target dB", {"pairs removed %"}, "rule"}};
}

Section speed(const Analysis& a) {
  Table table{{"rule", "target dB", "test views dB", "times exact"}, {}};
  const AnalysedSystem* best = &a.targets.front();
  for (const AnalysedSystem& entry : a.targets) {
    table.rows.push_back(row(entry.name, entry.target_db, entry.mean_db, exact_ms(a) / entry.times.frame_ms));
    if (entry.times.frame_ms < best->times.frame_ms) best = &entry;
  }
  const std::string sentence =
      fmt::format("The fastest is “{}”: {:.2f} times as fast as the exact frame ({:.4g} ms).", best->name,
                  exact_ms(a) / best->times.frame_ms, exact_ms(a));
  const Chart chart{"test views dB", {"times exact"}, "rule", "target dB"};
  return {"speed", "Speed at equal error (figure 8)", sentence, {}, chart, table};
}

}  // namespace

Page analysis_page(const Analysis& a) {
  Page page;
  page.title = "AdaGScale's analyses of " + a.scene;
  page.facts = {{"device", a.device},
                {"scene", a.scene},
                {"calibration views", a.calibration_views.size()},
                {"test views", a.test_views.size()}};
  page.sections = {
      scene(a),
      systems(a),
      skipping(a),
      section_by_depth(
          a, &DepthBin::contribution, "contributions", "Contribution against depth (figure 4b)",
          "largest alpha T of a Gaussian",
          "What each Gaussian contributes to the pixel that shows it best, by its depth in the view."),
      section_by_depth(
          a, &DepthBin::transmittance, "light", "Transmittance against depth (figure 6)",
          "max(T) of a Gaussian",
          fmt::format("In {} bins of depth some Gaussian has a transmittance above a half: there a table by "
                      "depth can tell little, and what each Gaussian measured tells much.",
                      bright_bins(a))),
      real_drops(a),
      removed(a),
      speed(a)};
  page.sentence = page.sections[6].sentence;
  if (Section seen = systems_pictures(a); seen.figures.size() > 1)
    page.sections.insert(page.sections.begin() + 2, std::move(seen));  // after the systems
  return page;
}

}  // namespace binosplat::lab
