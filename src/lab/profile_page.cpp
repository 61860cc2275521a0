// Builds report.html of a profile.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/statistics.h"
#include "lab/profile.h"

namespace binosplat::lab {

namespace {

using render::Recording;

/// Columns of frames.csv, renamed for readers.
Table selected_columns(const Recording& recording,
                       const std::vector<std::pair<std::string, std::string>>& named) {
  Table selected;
  for (const auto& [name, shown] : named) selected.columns.push_back(shown);
  for (std::size_t n = 0; n < recording.frames.size(); n += rows_at_once) {
    Table all = lab::frames_table(recording, n, rows_at_once);
    std::vector<std::size_t> at;
    for (const auto& [name, shown] : named)
      at.push_back(static_cast<std::size_t>(std::ranges::find(all.columns, name) - all.columns.begin()));
    for (std::vector<Cell>& from : all.rows) {
      std::vector<Cell>& cells = selected.rows.emplace_back();
      cells.reserve(at.size() + 1);
      for (const std::size_t k : at) cells.push_back(std::move(from[k]));
    }
  }
  return selected;
}

/// A chart of columns of frames.csv over the frames.
void plot_frames(const Recording& recording, std::vector<std::pair<std::string, std::string>> named,
                 const std::string& title, Section& section) {
  named.insert(named.begin(), {"frame", "frame"});
  const Table& numbers = section.numbers.emplace(selected_columns(recording, named));
  section.chart = Chart{.x = "frame", .y = {numbers.columns.begin() + 1, numbers.columns.end()}};
  section.chart->title = title;
  section.chart->zero = title == "ms";
  section.chart->dots = false;
}

Section frame_times(const Profile& profile, const ProfileSummary& summary) {
  const Recording& recording = profile.recording;
  const double budget = recording.budget_ms();
  Section section{"frames", "Every frame",
                  fmt::format("Frames take {:.2f} ms (median), {:.2f} at p99, {:.2f} at most.",
                              summary.wall.median, summary.wall.p99, summary.wall.max)};
  plot_frames(recording, {{"events", "events"}, {"wall_ms", "frame ms"}, {"gpu_ms", "GPU ms"}}, "ms",
              section);
  Table& table = *section.numbers;
  section.chart->y.erase(section.chart->y.begin());
  section.chart->label = "events";
  if (budget == 0.0) return section;
  table.columns.emplace_back("budget ms");
  for (std::vector<Cell>& cells : table.rows) cells.emplace_back(budget);
  section.chart->y.emplace_back("budget ms");
  section.sentence +=
      fmt::format(" {} of {} ended after the next one was due ({:.1f} ms, {:g} frames a second).",
                  summary.missed, recording.frames.size(), budget, recording.fps);
  return section;
}

Section stacked_stages(const Recording& recording, const ProfileSummary& summary) {
  Section section{"stages", "Stages on the GPU",
                  "GPU time of each frame by stage, including repeated drawings."};
  if (summary.gpu.max == 0.0) {
    section.problem = "This driver does not report when stages begin and end.";
    return section;
  }
  std::vector<std::pair<std::string, std::string>> named;
  for (const StageTime& stage : summary.stages) named.emplace_back("gpu_" + stage.name + "_ms", stage.name);
  plot_frames(recording, named, "ms", section);
  section.chart->areas = true;
  Table& means = section.table.emplace(Table{{"stage", "mean ms", "% of the GPU time"}, {}});
  double all = 0.0;
  for (const StageTime& stage : summary.stages) all += stage.ms;
  for (const StageTime& stage : summary.stages)
    means.rows.push_back(row(stage.name, stage.ms, 100.0 * stage.ms / all));
  return section;
}

Section histogram(const Profile& profile, const ProfileSummary& summary) {
  Section section{
      "spread", "How frame times spread",
      "Histogram of frame times. The table has the times that 50, 90 and 99 % of the frames do not exceed."};
  constexpr std::size_t max_bins = 24;
  std::vector<double> wall;
  for (const render::FrameRecord& frame : profile.recording.frames) wall.push_back(frame.wall_ms());
  const double least = quantile(wall, 0.0),
               width = round_up(std::max(1e-3, (summary.wall.max - least) / 16.0));
  const double first = width * std::floor(least / width);
  std::vector<std::int64_t> counts(
      std::min(max_bins, static_cast<std::size_t>((summary.wall.max - first) / width) + 1));
  for (const double ms : wall)
    ++counts[std::min(counts.size() - 1, static_cast<std::size_t>((ms - first) / width))];
  Table& bins = section.numbers.emplace(Table{{"frame ms", "frames"}, {}});
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double from = first + width * static_cast<double>(k);
    bins.rows.push_back(row(fmt::format("{:.4g} to {:.4g}", from, from + width), counts[k]));
  }
  section.chart = Chart{.x = "frame ms", .y = {"frames"}, .bars = true};
  section.table = Table{{"ms", "median", "p90", "p99", "max"}, {}};
  for (const auto& [name, q] : {std::pair{"frame", summary.wall}, {"GPU", summary.gpu}, {"CPU", summary.cpu}})
    section.table->rows.push_back(row(name, q.median, q.p90, q.p99, q.max));
  return section;
}

Section worst_frames(const Profile& profile, const ProfileSummary& summary) {
  const Recording& recording = profile.recording;
  Section section{"worst", "The frames that took longest",
                  "The longest frames, with their events and the work that took longer than usual."};
  Table& table = section.table.emplace(Table{{"frame", "s", "frame ms", "GPU ms", "CPU ms", "why"}, {}});
  for (std::size_t k = 0; k < summary.worst.size(); ++k) {
    const std::size_t n = summary.worst[k];
    const render::FrameRecord& frame = recording.frames[n];
    const double seconds =
        std::chrono::duration<double>(frame.begin - recording.frames.front().begin).count();
    table.rows.push_back(
        row(n, seconds, frame.wall_ms(), gpu_ms(frame), cpu_ms(frame), reason_of(profile, summary, n)));
    if (k < profile.pictures.size() && profile.pictures[k])
      section.figures.push_back(
          {fmt::format("frame {}, {:.2f} ms", n, frame.wall_ms()), *profile.pictures[k]});
  }
  return section;
}

Section bound(const Recording& recording) {
  Section section{"bound", "GPU against CPU",
                  "CPU time is that of the drawing thread, without its waits for the GPU."};
  std::vector<std::pair<std::string, std::string>> named = {{"gpu_ms", "GPU"}, {"read_ms", "read back"}};
  for (const std::string part : {"levels", "plan", "upload", "submit", "wait"})
    named.emplace_back(part + "_ms", part);
  plot_frames(recording, named, "ms", section);
  return section;
}

Section work(const Recording& recording) {
  Section section{"work", "Work per frame",
                  "Pairs and Gaussians in view of each frame, and those of the model."};
  plot_frames(recording,
              {{"pairs", "pairs"}, {"visible", "Gaussians in view"}, {"gaussians", "Gaussians of the model"}},
              "count", section);
  return section;
}

Section clock_section(const Profile& profile, const ProfileSummary& summary) {
  Section section{"clock", "The GPU's clock", ""};
  if (!summary.mhz) {
    section.problem = fmt::format("The clock is unknown: {}.", profile.recording.no_clock);
    return section;
  }
  section.sentence =
      fmt::format("{:.0f} MHz (median); {} frames were drawn below 95 % of the fastest, {:.0f} MHz.",
                  summary.mhz->median, summary.slow_clock, summary.mhz->max);
  plot_frames(profile.recording, {{"mhz", "MHz"}}, "MHz", section);
  return section;
}

}  // namespace

Page profile_page(const Profile& profile, const ProfileSummary& summary,
                  const std::vector<std::string>& changes) {
  const Recording& recording = profile.recording;
  const auto& views = recording.frames.front().views;
  Page page{.title = fmt::format("Frame times: {}, {}", profile.facts.scene, profile.facts.motion),
            .sentence = fmt::format(
                "Half of {} frames take at most {:.2f} ms, 99 % at most {:.2f} ms. Bottleneck: {}.",
                recording.frames.size(), summary.wall.median, summary.wall.p99, bound_of(profile, summary))};
  page.facts = {
      {"scene", profile.facts.scene},
      {"Gaussians", recording.frames.back().gaussians},
      {"path", profile.facts.motion},
      {"drawn", profile.facts.drawing},
      {"pictures", fmt::format("{} x {} x {} px", views.size(), views.front().width, views.front().height)},
      {"device", profile.facts.device},
      {"rate",
       recording.fps > 0.0 ? fmt::format("{:g} frames a second", recording.fps) : "as fast as possible"}};
  page.sections = {frame_times(profile, summary),  stacked_stages(recording, summary),
                   histogram(profile, summary),    worst_frames(profile, summary),
                   bound(profile.recording),       work(recording),
                   clock_section(profile, summary)};
  const std::string advice = advice_of(profile, summary);
  if (!advice.empty()) page.sentence += fmt::format(" Try {}.", as_shown(advice));
  if (!changes.empty()) {
    Section& section = page.sections.emplace_back(Section{"changes", "What changed", changes.back() + "."});
    section.table = Table{{"changed beyond noise"}, {}};
    for (std::size_t k = 0; k + 1 < changes.size(); ++k) section.table->rows.push_back(row(changes[k]));
    if (changes.size() == 1) section.table.reset();
  }
  return page;
}

}  // namespace binosplat::lab
