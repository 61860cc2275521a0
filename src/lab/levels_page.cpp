#include "lab/levels_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "lab/turns.h"

namespace binosplat::lab {

namespace {

std::string detail_text(const LevelsStudy& study, const LevelsRow& row) {
  return row.detail ? fmt::format("{:g} {}", *row.detail, study.in_db ? "dB" : "px") : "finest";
}

/// The name of a series of a scene.
std::string series_name(const LevelsStudy& study, const LevelsScene& scene, const std::string& what) {
  if (study.scenes.size() == 1) return what;
  return what.empty() ? scene.name : fmt::format("{}: {}", scene.name, what);
}

double thousands(double gaussians) { return 1e-3 * gaussians; }

Axis detail_axis(const LevelsStudy& study) { return {"asked for", study.in_db ? "dB" : "px"}; }

/// Adds a line a scene: a number over the detail that is asked for.
void add_lines(const LevelsStudy& study, const std::string& what,
               std::optional<double> LevelsNumbers::*number, Plot& plot) {
  for (const LevelsScene& scene : study.scenes) {
    Series line{series_name(study, scene, what), {}, true};
    for (const LevelsRow& row : scene.rows) {
      const std::optional<double> mean = mean_of(row).*number;
      if (row.detail && mean) line.add(*row.detail, *mean);
    }
    if (!line.points.empty()) plot.series.push_back(std::move(line));
  }
}

Section over_detail(const LevelsStudy& study, const std::string& id, const std::string& title,
                    const std::string& sentence, const Axis& axis,
                    std::optional<double> LevelsNumbers::*number) {
  Section section{id, title, sentence};
  Plot plot{detail_axis(study), axis, {}};
  add_lines(study, axis.label, number, plot);
  if (plot.series.empty()) {
    section.problem = "This was not measured.";
  } else {
    section.plot = std::move(plot);
  }
  return section;
}

Section losses(const LevelsStudy& study) {
  Plot plot{detail_axis(study), {"PSNR", "dB"}, {}};
  add_lines(study, "true", &LevelsNumbers::psnr_db, plot);
  add_lines(study, "predicted", &LevelsNumbers::predicted_db, plot);
  std::string sentence =
      "Against the finest levels, the mean over the views; dB by the mean of squared errors. True is of both "
      "eyes' pictures together, predicted of the eye that loses more.";
  for (const std::string& problem : problems_of(study)) sentence += " " + problem;
  return {"losses", "What is lost", sentence, plot, levels_table(study)};
}

Section levels_times(const LevelsStudy& study) {
  Plot plot{{"Gaussians drawn", "thousands"}, {"GPU time of a frame", "ms"}, {}};
  for (const LevelsScene& scene : study.scenes) {
    Series line{series_name(study, scene, ""), {}, true};
    if (line.name.empty()) line.name = "frame";
    for (const LevelsRow& row : scene.rows) {
      const LevelsNumbers mean = mean_of(row);
      line.add(thousands(mean.gaussians), mean.frame_ms, detail_text(study, row), !row.detail);
    }
    plot.series.push_back(std::move(line));
  }
  return {"times", "What frames take",
          fmt::format("A point a detail, the finest levels filled. The median of {} frames of a view, in the "
                      "mean of {} rounds "
                      "in which all details took turns, and over the views.",
                      study.frames, turn_rounds),
          plot};
}

/// From the fewest Gaussians on.
std::vector<const LevelsScene*> by_size(const LevelsStudy& study) {
  std::vector<const LevelsScene*> scenes;
  for (const LevelsScene& scene : study.scenes) scenes.push_back(&scene);
  std::ranges::stable_sort(scenes, {}, [](const LevelsScene* scene) { return scene->finest; });
  return scenes;
}

/// Of each scene, in the order of by_size(), and of what is drawn of any: the time of a frame.
struct Growth {
  std::string detail;
  std::vector<std::optional<double>> ms;

  /// As a multiple of the smallest scene's.
  std::optional<double> times(std::size_t scene) const {
    return ms[scene] && ms.front() ? std::optional(*ms[scene] / *ms.front()) : std::nullopt;
  }
};

std::vector<Growth> growths(const LevelsStudy& study) {
  std::vector<Growth> all;
  const std::vector<const LevelsScene*> scenes = by_size(study);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    for (const LevelsRow& row : scenes[k]->rows) {
      const std::string detail = detail_text(study, row);
      auto found = std::ranges::find(all, detail, &Growth::detail);
      if (found == all.end()) found = all.insert(all.end(), {detail, {}});
      found->ms.resize(scenes.size());
      found->ms[k] = mean_of(row).frame_ms;
    }
  }
  return all;
}

double times_the_gaussians(const std::vector<const LevelsScene*>& scenes, std::size_t k) {
  return static_cast<double>(scenes[k]->finest) / static_cast<double>(scenes.front()->finest);
}

Section growth(const LevelsStudy& study) {
  Plot plot{{"Gaussians at the finest levels", "thousands", true}, {"GPU time of a frame", "ms", true}, {}};
  const std::vector<const LevelsScene*> scenes = by_size(study);
  std::vector<std::string> ratios;
  for (const Growth& one : growths(study)) {
    Series& line = plot.series.emplace_back(Series{one.detail, {}, true});
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      if (one.ms[k]) line.add(thousands(static_cast<double>(scenes[k]->finest)), *one.ms[k], scenes[k]->name);
    }
    if (const auto times = one.times(scenes.size() - 1))
      ratios.push_back(fmt::format("{} {:.2f}", one.detail, *times));
  }
  return {"growth", "Growth with the model",
          fmt::format("From {} to {}: {:.3g} times the Gaussians. Times the frame's time: {}.",
                      scenes.front()->name, scenes.back()->name,
                      times_the_gaussians(scenes, scenes.size() - 1), fmt::join(ratios, ", ")),
          plot, growth_table(study)};
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
  return {"views", "Each view", "The numbers that the means above are of.", {}, table};
}

}  // namespace

Table levels_table(const LevelsStudy& study) {
  Table table{{"scene", "detail", "thousand Gaussians", "of the finest %", "predicted dB", "true dB",
               "worst true dB", "FLIP", "disagreement dB", "frame ms", "of the finest's"},
              {}};
  for (const LevelsScene& scene : study.scenes) {
    const bool has_finest = !scene.rows.back().detail;
    for (const LevelsRow& of : scene.rows) {
      const LevelsNumbers n = mean_of(of);
      const double share = n.gaussians / static_cast<double>(scene.finest);
      const Cell of_time = has_finest ? Cell(n.frame_ms / mean_of(scene.rows.back()).frame_ms) : Cell();
      table.rows.push_back(row(scene.name, detail_text(study, of), thousands(n.gaussians), 100.0 * share,
                               n.predicted_db, n.psnr_db, worst_db(of), n.flip, n.disagreement_db, n.frame_ms,
                               of_time));
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
  for (const Growth& one : growths(study)) {
    table.columns.push_back(one.detail + ": ms");
    table.columns.push_back(one.detail + ": times");
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      table.rows[k].emplace_back(one.ms[k]);
      table.rows[k].emplace_back(one.times(k));
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
  page.sections = {
      losses(study),
      over_detail(study, "flip", "What somebody sees who flips between the two",
                  "FLIP against the finest levels, the mean over pixels, eyes and views; 0 is no difference.",
                  {"FLIP", ""}, &LevelsNumbers::flip),
      over_detail(study, "disagreement", "What only one eye sees",
                  "Disagreement: the part of the error that the eyes do not share; more dB are less of it.",
                  {"disagreement", "dB"}, &LevelsNumbers::disagreement_db),
      levels_times(study)};
  if (study.scenes.size() > 1) page.sections.push_back(growth(study));
  page.sections.push_back(views(study));
  return page;
}

}  // namespace binosplat::lab
