// The page of AdaGScale's analyses: each figure and table of the paper, on this scene.

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
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
  if (!a.chosen.empty()) sentence += fmt::format(" Test views: {}.", a.chosen);
  return {"scene", "The scene (tables I and II)", sentence, table};
}

/// Of Scaffold-GS what its networks take, which no threshold changes (figure 8e); else nothing.
std::string networks(const Analysis& a) {
  const auto decoding = [](const AnalysedSystem& system) {
    double ms = 0.0;
    for (const gl::StageTime& stage : system.times.stages) ms += stage.name == "decode" ? stage.ms : 0.0;
    return ms;
  };
  const AnalysedSystem &first = a.systems.front(), &last = a.systems.back();
  if (!(decoding(first) > 0.0)) return "";
  return fmt::format(" Its networks take {:.0f} % of that; without them “{}” is {:.2f} times as fast.",
                     100.0 * decoding(first) / first.times.frame_ms, last.name,
                     (first.times.frame_ms - decoding(first)) / (last.times.frame_ms - decoding(last)));
}

/// The paper's four stages of 3D-GS (figure 2), in ms, of ours.
std::array<double, 4> paper_stages(const Typical& times) {
  std::array<double, 4> ms{};
  for (const gl::StageTime& stage : times.stages) {
    const bool before = stage.name == "decode" || stage.name == "project";
    ms[before ? 0 : stage.name == "bin" ? 1 : stage.name == "sort" ? 2 : 3] += stage.ms;
  }
  return ms;
}

Section systems(const Analysis& a) {
  Table table{{"system", "frame ms", "times 3D-GS", "pairs", a.drop() ? "drop dB" : "PSNR against exact dB",
               "worst dB", "in view"},
              {}};
  const Chart chart{.x = "system",
                    .y = {"preprocessing ms", "duplication ms", "sorting ms", "rendering ms"},
                    .title = "GPU time, ms",
                    .bars = true};
  table.columns.insert(table.columns.end(), chart.y.begin(), chart.y.end());
  for (const gl::StageTime& stage : a.systems.front().times.stages)
    table.columns.push_back(stage.name + " ms");
  const double slowest = a.systems.front().times.frame_ms;
  for (const AnalysedSystem& system : a.systems) {
    const Typical& times = system.times;
    auto& cells =
        table.rows.emplace_back(row(system.name, times.frame_ms, slowest / times.frame_ms, times.pairs,
                                    system.mean_db, system.worst_db, system.worst_view));
    for (const double ms : paper_stages(times)) cells.emplace_back(ms);
    for (const gl::StageTime& stage : times.stages) cells.emplace_back(stage.ms);
    cells.resize(table.columns.size());
  }
  const AnalysedSystem &first = a.systems.front(), &last = a.systems.back();
  std::vector<std::string> shares;
  for (const double ms : paper_stages(first.times))
    shares.push_back(fmt::format("{:.0f}", 100.0 * ms / slowest));
  return {
      "systems", "Where the time goes (figures 2 and 8)",
      fmt::format("The systems by what decides their Gaussian-tile pairs, all in this renderer: “{}” "
                  "draws {:.2f} times as fast as “{}”, which spends {} % on preprocessing, duplication, "
                  "sorting and rendering.{}",
                  last.name, slowest / last.times.frame_ms, first.name, fmt::join(shares, ", "), networks(a)),
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
  std::string sentence = fmt::format(
      "Without the half of all fragments that has the lowest alpha T the pictures keep {:.1f} dB against "
      "exact; {:.1f} dB where max(T) of each Gaussian is known, {:.1f} dB with the table by depth, {:.1f} dB "
      "by alpha alone.",
      half(0), half(1), half(2), half(3));
  if (drop) {
    const auto dropped = [&](std::size_t curve, std::size_t share) {
      return *curves[curve].points[share].drop_db;
    };
    sentence += fmt::format(
        " Against the photos 80 % skipped by alpha T cost {:.2f} dB (the paper's four scenes: 0.60), 60 % by "
        "alpha max(T) {:.2f} (0.41), 50 % by alpha T_upper(depth) {:.2f} (0.51).",
        dropped(0, 7), dropped(1, 5), dropped(2, 4));
  }
  return {"skipping", "What the lowest contributions are worth (figures 4a, 5a and 5b)", sentence, table,
          Chart{"fragments skipped %", {"PSNR against exact dB"}, "skipped by"}};
}

Section by_distance(const Analysis& a) {
  Table table{{"px", "to", "fragments", "mean", "largest", "of all contribution, nearer %"}, {}};
  double all = 0.0, nearer = 0.0, most = NAN;
  for (const reference::DistanceBin& bin : a.contributions.by_distance) all += bin.sum;
  for (const reference::DistanceBin& bin : a.contributions.by_distance) {
    nearer += bin.sum;
    if (std::isnan(most) && nearer >= 0.9 * all) most = bin.to;
    const double mean = bin.fragments > 0 ? bin.sum / static_cast<double>(bin.fragments) : NAN;
    table.rows.push_back(row(bin.from, bin.to, bin.fragments, mean, bin.largest, 100.0 * nearer / all));
  }
  return {
      "contributions",
      "Contribution against the distance between Gaussian and pixel (figure 4b)",
      fmt::format("90 % of all contribution reaches pixels within {:.3g} px of the Gaussian's middle.", most),
      table,
      Chart{.x = "px", .y = {"mean", "largest"}, .title = "alpha T", .steps = true},
      {},
      all > 0.0 ? "" : "No pixel blends anything."};
}

Section by_depth(const Analysis& a) {
  Table table{{"from", "to", "Gaussians", "median", "90 of 100 below", "largest", "T_upper"}, {}};
  int bright = 0, shown = 0;
  for (const DepthBin& bin : a.contributions.by_depth) {
    const Spread& of = bin.transmittance;
    shown += bin.gaussians > 0;
    bright += of.largest > 0.5;
    table.rows.push_back(row(bin.from, bin.to, bin.gaussians, of.median, of.p90, of.largest, bin.bound));
  }
  const auto& paper = a.depth_table.bounds;
  const auto ones = std::count_if(paper.begin(), paper.end(), [](float bound) { return bound > 0.995f; });
  const auto empty = std::count(paper.begin(), paper.end(), 0.0f);
  return {
      "light",
      "Transmittance against depth (figure 6)",
      fmt::format("In {} of {} bins of depth some Gaussian has a transmittance above a half: there a table "
                  "by depth can tell little, and what each Gaussian measured tells much. Of the paper's {} "
                  "bins over [0, {:g}] {} are 1, and {} have no Gaussian.",
                  bright, shown, paper.size(), a.depth_table.far, ones, empty),
      table,
      Chart{.x = "from",
            .y = {"median", "90 of 100 below", "largest", "T_upper"},
            .title = "max(T) of a Gaussian",
            .steps = true},
      {},
      shown > 0 ? "" : "No pixel blends anything."};
}

Section real_drops(const Analysis& a) {
  Table table{{"rule", "target dB", "reached dB", "test views dB", "worst dB", "in view", "tolerance"}, {}};
  double excess = -INFINITY;
  for (const AnalysedSystem& entry : a.found) {
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
  const AnalysedSystem* most = &a.tuned.front();
  for (const AnalysedSystem& entry : a.tuned) {
    const double ms = entry.times.frame_ms;
    table.rows.push_back(
        row(entry.name, entry.target_db, entry.mean_db, 100.0 * entry.pairs_removed, ms, exact_ms(a) / ms));
    if (entry.pairs_removed > most->pairs_removed) most = &entry;
  }
  if (a.drop()) {
    for (const auto& [target, share] : paper_removed)
      table.rows.push_back(row("the paper, its scenes", target, nullptr, 100.0 * share, nullptr, nullptr));
  }
  return {"removed", "Pairs removed (table IV)",
          fmt::format("“{}” removes the most pairs of the exact ellipse test: {:.1f} % at {} dB. Tolerances "
                      "are tuned on the test views themselves, as the paper's are.",
                      most->name, 100.0 * most->pairs_removed, json_text(*most->target_db)),
          table, Chart{"target dB", {"pairs removed %"}, "rule"}};
}

Section speed(const Analysis& a) {
  Table table{{"rule", "target dB", "test views dB", "times exact"}, {}};
  const AnalysedSystem* best = &a.tuned.front();
  for (const AnalysedSystem& entry : a.tuned) {
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
  page.sections = {scene(a),    systems(a),    skipping(a), by_distance(a),
                   by_depth(a), real_drops(a), removed(a),  speed(a)};
  page.sentence = page.sections[6].sentence;
  if (Section seen = systems_pictures(a); seen.figures.size() > 1)
    page.sections.insert(page.sections.begin() + 2, std::move(seen));  // after the systems
  return page;
}

Table means_over_scenes(std::span<const Analysis> analyses) {
  Table table{{"system", "times 3D-GS", "times FlashGS", "pairs removed %", "mean dB"}, {}};
  const auto count = static_cast<double>(analyses.size());
  for (std::size_t k = 0; k < analyses.front().systems.size(); ++k) {
    double over_first = 0.0, over_exact = 0.0, removed = 0.0, db = 0.0;
    for (const Analysis& a : analyses) {
      const AnalysedSystem& system = a.systems[k];
      over_first += std::log(a.systems.front().times.frame_ms / system.times.frame_ms) / count;
      over_exact += std::log(exact_ms(a) / system.times.frame_ms) / count;
      removed += 100.0 * system.pairs_removed / count;
      db += system.mean_db / count;
    }
    table.rows.push_back(
        row(analyses.front().systems[k].name, std::exp(over_first), std::exp(over_exact), removed, db));
  }
  return table;
}

}  // namespace binosplat::lab
