#include "lab/motion_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <span>

#include "lab/settings.h"

namespace binosplat::lab {

namespace {

/// Nothing where the part has no frames.
Cell of_part(const MotionSummary& part, double MotionSummary::*number) {
  return part.frames == 0 ? Cell() : Cell(part.*number);
}

/// A column a path of what value(path, rule) is.
template <typename Value>
void add_columns(const MotionStudy& study, const std::string& what, const Value& value, Table& table) {
  for (const MotionResult& path : study.paths) {
    table.columns.push_back(fmt::format("{}: {}", path.path.name, what));
    for (std::size_t k = 0; k < table.rows.size(); ++k)
      table.rows[k].emplace_back(value(path, path.rules[k]));
  }
}

Table rules_of(const MotionStudy& study) {
  Table table{{"rule"}, {}};
  for (const MovedRule& rule : study.paths.front().rules) table.rows.push_back(row(rule.name()));
  return table;
}

/// Whether rules keep their word.
Section words_kept(const MotionStudy& study) {
  Table table = rules_of(study);
  const auto moving = [](double MotionSummary::*number) {
    return [number](const MotionResult&, const MovedRule& rule) { return rule.asked.moving.*number; };
  };
  add_columns(study, "true dB", moving(&MotionSummary::true_db), table);
  add_columns(study, "worst dB", moving(&MotionSummary::worst_db), table);
  add_columns(study, "reported minus true dB", moving(&MotionSummary::reported_beyond), table);
  const MovedRule* worst = nullptr;
  std::string where;
  for (const MotionResult& path : study.paths) {
    for (const MovedRule& rule : path.rules) {
      if (worst != nullptr && worst->asked.moving.true_db <= rule.asked.moving.true_db) continue;
      worst = &rule;
      where = path.path.name;
    }
  }
  const std::string sentence = fmt::format(
      "Every rule was asked for {:g} dB. “{}” falls farthest below: its moving frames come to {:.1f} dB in "
      "the "
      "mean ({}).",
      study.settings.quality, worst->name(), worst->asked.moving.true_db, where);
  return {"words", "Whether rules keep their word", sentence, table};
}

/// What rules take at one true quality.
Section gains(const MotionStudy& study) {
  Section section{"gains", "What rules take at one true quality", ""};
  bool compared = true, problems = false;
  for (const MotionResult& path : study.paths) {
    for (const MovedRule& rule : path.rules) {
      compared = compared && rule.compared;
      problems = problems || !rule.problem.empty();
    }
  }
  if (!compared) {
    section.problem = "This was not measured (--no-equal).";
    return section;
  }
  Table& table = section.table.emplace(rules_of(study));
  const auto at = [](std::optional<double> MovedShares::*share) {
    return
        [share](const MotionResult& path, const MovedRule& rule) { return shares(path, rule, true).*share; };
  };
  add_columns(study, "ms of `one`", at(&MovedShares::ms_of_one), table);
  add_columns(study, "pairs of `one`", at(&MovedShares::pairs_of_one), table);
  add_columns(study, "ms of exact", at(&MovedShares::ms_of_exact), table);
  if (problems)
    add_columns(
        study, "why not", [](const MotionResult&, const MovedRule& rule) { return rule.problem; }, table);
  section.sentence = fmt::format(
      "At {:g} dB, the true mean of each path's moving frames: GPU time and pairs in those of the rule with "
      "the "
      "same threshold and a transmittance of 1, and in the exact frame's.",
      study.settings.target);
  return section;
}

using Number = double (*)(const MovedFrame&);

/// Numbers of every frame of a path, its segments one after the other: a column for each pass and number.
Table frames_table(const MotionPath& path, std::span<const std::pair<std::string, const MovedFrames*>> passes,
                   std::span<const std::pair<std::string, Number>> numbers) {
  Table table{{"frame", "part"}, {}};
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    const MotionSegment& segment = path.segments[s];
    for (std::size_t n = 0; n < segment.frames.size(); ++n) {
      const char* part = n < segment.lead ? "lead" : n < segment.lead + segment.moving() ? "moving" : "stop";
      auto& cells =
          table.rows.emplace_back(row(table.rows.size(), fmt::format("stretch {}, {}", s + 1, part)));
      for (const auto& [name, frames] : passes) {
        for (const auto& [what, number] : numbers) cells.emplace_back(number((*frames)[s][n]));
      }
    }
  }
  for (const auto& [name, frames] : passes) {
    for (const auto& [what, number] : numbers) table.columns.push_back(name + what);
  }
  return table;
}

/// A chart of all columns of such a table.
Section frames_section(const std::string& id, const std::string& title, const std::string& sentence,
                       std::optional<Table> table, const std::string& axis, Table numbers) {
  Chart chart{.x = "frame",
              .y = {numbers.columns.begin() + 2, numbers.columns.end()},
              .label = "part",
              .title = axis,
              .dots = false};
  return {id, title, sentence, std::move(table), std::move(chart), std::move(numbers)};
}

std::vector<std::pair<std::string, const MovedFrames*>> passes_of(const MotionResult& path, bool exact) {
  std::vector<std::pair<std::string, const MovedFrames*>> passes;
  if (exact) passes.emplace_back("exact", &path.exact.frames);
  for (const MovedRule& rule : path.rules) passes.emplace_back(rule.name(), &rule.asked.frames);
  return passes;
}

Section asked(const MotionStudy& study, const MotionResult& path) {
  const std::pair<std::string, Number> numbers[] = {
      {": true dB", [](const MovedFrame& frame) { return frame.true_db(); }},
      {": reported dB", [](const MovedFrame& frame) { return frame.reported(); }}};
  const std::string& name = path.path.name;
  return frames_section(
      "asked-" + name, fmt::format("{}: true and reported", name),
      fmt::format(
          "{}; {}. Asked for {:g} dB; the worse eye's PSNR against the exact frame, of 8-bit pictures, and "
          "what the program reported of itself. Means are over moving frames; {:g} dB are equal pictures.",
          path.path.motion, lengths_of(path.path), study.settings.quality, equal_db),
      asked_table(path), "PSNR, dB", frames_table(path.path, passes_of(path, false), numbers));
}

/// A number of the frames where all were asked for the same; the exact frame's beside them.
Table costs(const MotionResult& path, Number number) {
  const std::pair<std::string, Number> numbers[] = {{"", number}};
  return frames_table(path.path, passes_of(path, true), numbers);
}

Section pairs(const MotionStudy& study, const MotionResult& path) {
  std::string sentence = fmt::format("Gaussian-tile pairs of a frame, a probe's included, asked for {:g} dB.",
                                     study.settings.quality);
  std::optional<Table> table = target_table(path);
  if (table->rows.empty()) table.reset();
  if (table)
    sentence +=
        fmt::format(" The table is of the requests at which moving frames come to {:g} dB in the mean.",
                    study.settings.target);
  return frames_section("pairs-" + path.path.name, fmt::format("{}: pairs", path.path.name), sentence,
                        std::move(table), "pairs, M",
                        costs(path, [](const MovedFrame& frame) { return 1e-6 * frame.pairs; }));
}

Section motion_times(const MotionStudy& study, const MotionResult& path) {
  return frames_section("times-" + path.path.name, fmt::format("{}: time", path.path.name),
                        fmt::format("GPU time of a frame, the median of {} rounds in which rules took turns.",
                                    study.settings.rounds),
                        {}, "GPU time, ms", costs(path, [](const MovedFrame& frame) { return frame.ms; }));
}

}  // namespace

Table asked_table(const MotionResult& path) {
  Table table{{"rule", "true dB", "tenth dB", "worst dB", "reported minus true dB", "farthest dB",
               "lead, worst dB", "stop dB", "stop, worst dB", "pairs, M", "removed %", "drawn", "frame ms",
               "of exact", "of `one`", "drawn once, ms", "most ms"},
              {}};
  const Cell none;
  const MotionSummary& exact = path.exact.moving;
  table.rows.push_back(row("exact", none, none, none, none, none, none, none, none, 1e-6 * exact.pairs, 0.0,
                           1.0, exact.ms, 1.0, none, exact.once_ms, exact.most_ms));
  for (const MovedRule& rule : path.rules) {
    const MotionSummary &moving = rule.asked.moving, &stop = rule.asked.stop;
    const MovedShares part = shares(path, rule, false);
    table.rows.push_back(row(rule.name(), moving.true_db, moving.tenth_db, moving.worst_db,
                             moving.reported_beyond, moving.reported_worst,
                             of_part(rule.asked.lead, &MotionSummary::worst_db),
                             of_part(stop, &MotionSummary::true_db), of_part(stop, &MotionSummary::worst_db),
                             1e-6 * moving.pairs, 100.0 * moving.removed, moving.drawn, moving.ms,
                             part.ms_of_exact, part.ms_of_one, moving.once_ms, moving.most_ms));
  }
  return table;
}

Table target_table(const MotionResult& path) {
  Table table{{"rule", "asked for dB", "true dB", "tenth dB", "worst dB", "pairs, M", "pairs of `one`",
               "removed %", "drawn", "frame ms", "of exact", "of `one`", "why not"},
              {}};
  for (const MovedRule& rule : path.rules) {
    if (!rule.compared) continue;
    const MotionSummary& moving = rule.at_target().moving;
    const MovedShares part = shares(path, rule, true);
    table.rows.push_back(row(rule.name(), rule.at_target().request, moving.true_db, moving.tenth_db,
                             moving.worst_db, 1e-6 * moving.pairs, part.pairs_of_one, 100.0 * moving.removed,
                             moving.drawn, moving.ms, part.ms_of_exact, part.ms_of_one, rule.problem));
  }
  return table;
}

std::string lengths_of(const MotionPath& path) {
  std::set<std::string> kinds;
  for (const MotionSegment& one : path.segments) {
    std::string kind = fmt::format("{} frames, after {} to find a tolerance", one.moving(), one.lead);
    if (one.stop != 0) kind += fmt::format(", then a stop of {}", one.stop);
    kinds.insert(std::move(kind));
  }
  const std::size_t count = path.segments.size();
  return fmt::format("{} of {}", count == 1 ? "one stretch" : fmt::format("{} stretches", count),
                     fmt::join(kinds, ", or of "));
}

Page motion_page(const MotionStudy& study) {
  Page page;
  page.title = "Rules along moving heads on " + study.scene;
  page.facts = {
      {"device", study.device},
      {"scene", study.scene},
      {"Gaussians", study.gaussians},
      {"pictures", fmt::format("{} x {} x {} px", study.eyes, study.width, study.height)},
      {"frames a second", study.frames_per_second},
      {"a metre", fmt::format("{:.4g} world units ({})", study.units_per_metre, study.metre_source)}};
  page.sections = {words_kept(study), gains(study)};
  page.sentence = page.sections.front().sentence;
  for (const MotionResult& path : study.paths) {
    page.sections.push_back(asked(study, path));
    page.sections.push_back(pairs(study, path));
    page.sections.push_back(motion_times(study, path));
  }
  return page;
}

}  // namespace binosplat::lab
