// What changed between two runs of the same frames.

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"
#include "lab/profile.h"

namespace binosplat::lab {

namespace {

constexpr std::size_t stretches = 10, stretch_least = 5;  // at most so many, of so many frames
constexpr double told_by_chance = 0.01;                   // of runs in which nothing changed
constexpr double least_change = 0.02;                     // of what it was
constexpr double much_noise = 0.1;                        // likewise: a run this short says little
constexpr double most = 1e30;                             // in a cell: no time or count is larger

bool is_compared(const std::string& name) {
  return (name.ends_with("_ms") && name != "begin_ms" && name != "late_ms" && name != "display_ms") ||
         name == "pairs" || name == "visible";
}

/// The numbers of a column, NaN for a cell that is none; nothing where there is no such column.
std::vector<double> column_of(const Table& table, const std::string& name) {
  const auto found = std::ranges::find(table.columns, name);
  std::vector<double> values;
  if (found == table.columns.end()) return values;
  const auto at = static_cast<std::size_t>(found - table.columns.begin());
  for (const std::vector<Cell>& row : table.rows) {
    const auto* const number = std::get_if<double>(&row[at].value);
    const auto* const whole = std::get_if<std::int64_t>(&row[at].value);
    values.push_back(number != nullptr ? *number : whole != nullptr ? static_cast<double>(*whole) : NAN);
  }
  return values;
}

/// The middle, or the mean of both middles: of differences, neither sign comes first.
double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The median difference of each stretch of frames: frames beside each other share their disturbances.
std::vector<double> differences(const std::vector<double>& before, const std::vector<double>& now) {
  const std::size_t count = std::min(stretches, before.size() / stretch_least);
  std::vector<double> medians;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> some;
    for (std::size_t n = k * now.size() / count; n < (k + 1) * now.size() / count; ++n)
      some.push_back(now[n] - before[n]);
    medians.push_back(median_of(some));
  }
  return medians;
}

/// A line where a column changed beyond noise, else nothing. `noise` becomes the change that noise makes.
std::string change_of(const std::string& name, const std::vector<double>& before,
                      const std::vector<double>& now, double outside, double& noise) {
  const std::vector<double> by_stretch = differences(before, now);
  const double change = mean(by_stretch), was = quantile(before, 0.5), is = quantile(now, 0.5);
  const auto n = static_cast<double>(by_stretch.size());
  noise = student_t(outside, static_cast<int>(n) - 1) * deviation(by_stretch) / std::sqrt(n);
  if (std::abs(change) <= std::max(noise, least_change * std::abs(was))) return "";
  return fmt::format("{}: median {:.4g} -> {:.4g} ({:+.1f} %, noise {:.1f} %)", name, was, is,
                     100.0 * change / std::abs(was), 100.0 * noise / std::abs(was));
}

/// Between which numbers the quantile of what a sample is from lies, but for three in a thousand cases; it
/// may be beyond all that a small sample has.
std::pair<double, double> bounds_of(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  const double scatter = 3.0 * std::sqrt(n * share * (1.0 - share));
  const double low = std::floor(n * share - scatter), high = std::ceil(n * share + scatter);
  return {low < 0.0 ? -INFINITY : values[static_cast<std::size_t>(low)],
          high < n ? values[static_cast<std::size_t>(high)] : INFINITY};
}

}  // namespace

void check_comparable(const Table& before, std::size_t frames, const std::string& place) {
  for (const char* const name : {"wall_ms", "gpu_ms"}) {
    if (std::ranges::find(before.columns, name) == before.columns.end())
      fail("--compare {}: no column {}: expected the frames.csv of a profile", place, name);
  }
  for (const std::string& name : before.columns) {
    if (!is_compared(name)) continue;
    const std::vector<double> values = column_of(before, name);
    const auto wrong =
        std::ranges::find_if(values, [](double value) { return !(value >= 0.0 && value <= most); });
    if (wrong != values.end())
      fail("--compare {}:{}: {}: expected a number from 0 to {:g}", place, wrong - values.begin() + 2, name,
           most);
  }
  if (before.rows.size() != frames) {
    fail("--compare {}: {} frames, and this run has {}: compare runs of the same options", place,
         before.rows.size(), frames);
  }
  if (frames < 3 * stretch_least)
    fail("--compare {}: {} frames do not tell noise: expected {} or more, of longer --seconds", place, frames,
         3 * stretch_least);
}

std::vector<std::string> compare_frames(const Table& before, const Table& now) {
  std::vector<std::string> names;
  for (const std::string& name : now.columns) {
    if (is_compared(name) && !column_of(before, name).empty()) names.push_back(name);
  }
  std::vector<std::string> lines;
  double noise = 0.0, of_frames = 0.0;
  for (const std::string& name : names) {
    const std::string line = change_of(name, column_of(before, name), column_of(now, name),
                                       told_by_chance / static_cast<double>(names.size()), noise);
    if (!line.empty()) lines.push_back(line);
    if (name == "wall_ms") of_frames = noise / quantile(column_of(before, name), 0.5);
  }
  for (const char* const name : {"wall_ms", "gpu_ms"}) {
    for (const double share : {0.9, 0.99}) {
      const auto was = bounds_of(column_of(before, name), share), is = bounds_of(column_of(now, name), share);
      if (is.first > (1.0 + least_change) * was.second || was.first > (1.0 + least_change) * is.second)
        lines.push_back(fmt::format("{}: p{:g} {:.4g} -> {:.4g}", name, 100.0 * share,
                                    quantile(column_of(before, name), share),
                                    quantile(column_of(now, name), share)));
    }
  }
  lines.push_back(fmt::format("{} of {} numbers changed beyond noise", lines.size(), names.size() + 4));
  if (of_frames > much_noise)
    lines.back() +=
        fmt::format(", which hides changes of wall_ms below {:.0f} %: longer --seconds show smaller ones",
                    100.0 * of_frames);
  return lines;
}

}  // namespace binosplat::lab
