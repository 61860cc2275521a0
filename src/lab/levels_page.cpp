#include "lab/levels_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "lab/timed_rounds.h"

namespace binosplat::lab {

namespace {

std::string detail_text(const LevelsStudy& study, const LevelsRow& row) {
  return row.detail ? fmt::format("{:g} {}", *row.detail, study.in_db ? "dB" : "px") : "finest";
}

double thousands(double gaussians) { return 1e-3 * gaussians; }

std::string detail_column(const LevelsStudy& study) {
  return fmt::format("asked for {}", study.in_db ? "dB" : "px");
}

/// A chart of columns of levels_table() over the detail that is asked for; nothing where these are empty.
Section over_detail(const LevelsStudy& study, const Table& table, const std::string& id,
                    const std::string& title, const std::string& sentence, const std::string& column) {
  const auto at = std::ranges::find(table.columns, column) - table.columns.begin();
  const bool known = std::ranges::any_of(
      table.rows, [&](const auto& row) { return row[static_cast<std::size_t>(at)] != Cell(); });
  const Chart chart{detail_column(study), {column}, "scene"};
  return {id, title, sentence, {}, chart, table, known ? "" : "This was not measured."};
}

Section losses(const LevelsStudy& study, const Table& table) {
  std::string sentence =
      "Against the finest levels, the mean over the views; dB by the mean of squared errors. True is of both "
      "eyes' pictures together, predicted of the eye that loses more.";
  for (const std::string& problem : problems_of(study)) sentence += " " + problem;
  const Chart chart{detail_column(study), {"true dB", "predicted dB"}, "scene"};
  return {"losses", "What is lost", sentence, table, chart};
}

Section levels_times(const LevelsStudy& study, const Table& table) {
  const std::string sentence = fmt::format(
      "A point a detail. The median of {} frames of a view, in the mean of {} rounds in which all "
      "details took turns, and over the views.",
      study.frames, turn_rounds);
  const Chart chart{"thousand Gaussians", {"frame ms"}, "scene", detail_column(study)};
  return {"times", "What frames take", sentence, {}, chart, table};
}

/// From the fewest Gaussians on.
std::vector<const LevelsScene*> by_size(const LevelsStudy& study) {
  std::vector<const LevelsScene*> scenes;
  for (const LevelsScene& scene : study.scenes) scenes.push_back(&scene);
  std::ranges::stable_sort(scenes, {}, [](const LevelsScene* scene) { return scene->finest; });
  return scenes;
}

/// What is drawn of any scene, in order.
std::vector<std::string> details_of(const LevelsStudy& study) {
  std::vector<std::string> details;
  for (const LevelsScene* scene : by_size(study)) {
    for (const LevelsRow& one : scene->rows) {
      const std::string detail = detail_text(study, one);
      if (std::ranges::find(details, detail) == details.end()) details.push_back(detail);
    }
  }
  return details;
}

std::optional<double> ms_of_detail(const LevelsStudy& study, const LevelsScene& scene,
                                   const std::string& detail) {
  for (const LevelsRow& one : scene.rows) {
    if (detail_text(study, one) == detail) return mean_of(one).frame_ms;
  }
  return std::nullopt;
}

double times_the_gaussians(const std::vector<const LevelsScene*>& scenes, std::size_t k) {
  return static_cast<double>(scenes[k]->finest) / static_cast<double>(scenes.front()->finest);
}

Section growth(const LevelsStudy& study) {
  const std::vector<const LevelsScene*> scenes = by_size(study);
  Chart chart{.x = "thousand Gaussians", .label = "scene", .title = "GPU time of a frame, ms"};
  chart.log_x = chart.log_y = true;
  for (const std::string& detail : details_of(study)) chart.y.push_back(detail + ": ms");
  return {"growth", "Growth with the model",
          fmt::format("From {} to {}: {:.3g} times the Gaussians.", scenes.front()->name, scenes.back()->name,
                      times_the_gaussians(scenes, scenes.size() - 1)),
          growth_table(study), chart};
}

Section views(const LevelsStudy& study) {
  Table table{{"scene", "view", "detail", "thousand Gaussians", "predicted dB", "true dB", "FLIP",
               "disagreement dB", "frame ms"},
              {}};
  for (const LevelsScene& scene : study.scenes) {
    for (std::size_t k = 0; k < scene.shots.size(); ++k) {
      for (const LevelsRow& of : scene.rows) {
        if (k >= of.shots.size()) continue;
        const LevelsNumbers& n = of.shots[k];
        table.rows.push_back(row(scene.name, scene.shots[k], detail_text(study, of), thousands(n.gaussians),
                                 n.predicted_db, n.psnr_db, n.flip, n.disagreement_db, n.frame_ms));
      }
    }
  }
  return {"views", "Each view", "The numbers that the means above are of.", table};
}

}  // namespace

Table levels_table(const LevelsStudy& study) {
  Table table{{"scene", detail_column(study), "thousand Gaussians", "of the finest %", "predicted dB",
               "true dB", "worst true dB", "FLIP", "disagreement dB", "frame ms", "of the finest's"},
              {}};
  for (const LevelsScene& scene : study.scenes) {
    const bool has_finest = !scene.rows.back().detail;
    for (const LevelsRow& of : scene.rows) {
      const LevelsNumbers n = mean_of(of);
      const double share = n.gaussians / static_cast<double>(scene.finest);
      const Cell of_time = has_finest ? Cell(n.frame_ms / mean_of(scene.rows.back()).frame_ms) : Cell();
      table.rows.push_back(row(scene.name, of.detail ? Cell(*of.detail) : Cell("finest"),
                               thousands(n.gaussians), 100.0 * share, n.predicted_db, n.psnr_db, worst_db(of),
                               n.flip, n.disagreement_db, n.frame_ms, of_time));
    }
  }
  return table;
}

Table growth_table(const LevelsStudy& study) {
  Table table{{"scene", "thousand Gaussians", "times"}, {}};
  if (study.scenes.size() < 2) return table;
  const std::vector<const LevelsScene*> scenes = by_size(study);
  for (std::size_t k = 0; k < scenes.size(); ++k)
    table.rows.push_back(row(scenes[k]->name, thousands(static_cast<double>(scenes[k]->finest)),
                             times_the_gaussians(scenes, k)));
  for (const std::string& detail : details_of(study)) {
    table.columns.push_back(detail + ": ms");
    table.columns.push_back(detail + ": times");
    const std::optional<double> smallest = ms_of_detail(study, *scenes.front(), detail);
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      const std::optional<double> ms = ms_of_detail(study, *scenes[k], detail);
      table.rows[k].emplace_back(ms);
      table.rows[k].emplace_back(ms && smallest ? Cell(*ms / *smallest) : Cell());
    }
  }
  return table;
}

std::vector<std::string> problems_of(const LevelsStudy& study) {
  std::vector<std::string> all;
  for (const LevelsScene& scene : study.scenes) {
    if (scene.problem.empty()) continue;
    all.push_back(fmt::format("{}: its finest levels, {} Gaussians, were not drawn in all views: {}",
                              scene.name, scene.finest, scene.problem));
    if (!all.back().ends_with('.')) all.back() += '.';
  }
  return all;
}

Page levels_page(const LevelsStudy& study) {
  Page page;
  const LevelsScene& first = study.scenes.front();
  page.title = study.scenes.size() == 1 ? "Levels of detail of " + first.name
                                        : fmt::format("Levels of detail of {} scenes", study.scenes.size());
  page.sentence = "What levels of detail lose against the finest, and the time that they take.";
  page.facts = {{"device", study.device}};
  for (const LevelsScene& scene : study.scenes) {
    page.facts.emplace_back(
        scene.name, fmt::format("{} Gaussians, {} views of {} x {} x {} px", scene.finest, scene.shots.size(),
                                scene.eyes, scene.width, scene.height));
  }
  const Table table = levels_table(study);
  page.sections = {
      losses(study, table),
      over_detail(study, table, "flip", "What somebody sees who flips between the two",
                  "FLIP against the finest levels, the mean over pixels, eyes and views; 0 is no difference.",
                  "FLIP"),
      over_detail(study, table, "disagreement", "What only one eye sees",
                  "Disagreement: the part of the error that the eyes do not share; more dB are less of it.",
                  "disagreement dB"),
      levels_times(study, table)};
  if (study.scenes.size() > 1) page.sections.push_back(growth(study));
  page.sections.push_back(views(study));
  return page;
}

}  // namespace binosplat::lab
