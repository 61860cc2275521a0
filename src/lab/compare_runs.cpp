// Finds the changes between two runs.

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/statistics.h"
#include "lab/results.h"

namespace binosplat::lab {

namespace {

constexpr double min_time_change = 0.02;  // smallest relative change of a time to report
constexpr double found_by_chance = 0.01;  // share of comparisons of equal runs that report a change by chance
constexpr double min_db_change = 0.01, min_pairs_change = 1e-3;

struct BothRuns {
  const Row* was;
  const Row* is;
  std::string name;
};

/// One kind of time of a point in both runs.
struct TimePair {
  std::string name;
  double was = 0.0, is = 0.0;      // ms, the means
  std::vector<double> changes;     // per repeat, the logarithm of new over old time
  double least = min_time_change;  // smallest relative change to report
};

std::vector<double> times_of(const Row& row, const char* name) {
  std::vector<double> times;
  if (!row.contains(name) || !row[name].is_array()) return times;
  for (const auto& one : row[name]) {
    const double ms = one.is_number() ? one.get<double>() : NAN;
    if (!(std::isfinite(ms) && ms > 0.0)) return {};
    times.push_back(ms);
  }
  return times;
}

/// The times of a point to compare; empty if the runs have none, or different numbers of frames or repeats.
std::vector<TimePair> times_of(const BothRuns& both) {
  const auto both_have = [&](const char* list) {
    return both.was->contains(list) && both.is->contains(list);
  };
  std::vector<TimePair> pairs;
  if (number(*both.was, "frames") != number(*both.is, "frames")) return pairs;
  const char* frames = both_have("cpu_repeats_ms") ? "cpu_repeats_ms" : "repeats_ms";
  // If the CPU draws, wall times also depend on other programs, so they are not compared.
  const bool by_cpu = std::string_view(frames) == "cpu_repeats_ms";
  for (const auto& [list, what] : {std::pair{frames, ""}, {"wall_repeats_ms", ", wall"}}) {
    if (by_cpu && list != frames) continue;
    const std::vector<double> was = times_of(*both.was, list), is = times_of(*both.is, list);
    if (was.empty() || was.size() != is.size()) continue;
    TimePair& pair = pairs.emplace_back(TimePair{both.name + what, mean(was), mean(is), {}});
    // Other programs also slow the computation itself, because they share its caches. So a change must exceed
    // the share of time that threads waited for them.
    for (const Row* run : {both.was, both.is}) {
      const double waited = number(*run, "waited");
      if (by_cpu && !std::isnan(waited)) pair.least = std::max(pair.least, 0.01 * waited);
    }
    for (std::size_t k = 0; k < is.size(); ++k) pair.changes.push_back(std::log(is[k] / was[k]));
  }
  return pairs;
}

/// The scatter of repeats, pooled over many pairs of times.
struct Scatter {
  double squares = 0.0;
  int freedom = 0;

  void add(const std::vector<double>& changes) {
    const double middle = mean(changes);
    for (const double change : changes) squares += (change - middle) * (change - middle);
    freedom += static_cast<int>(changes.size()) - 1;
  }
  double deviation() const { return freedom > 0 ? std::sqrt(squares / freedom) : 0.0; }
};

std::string name_of(const Row& row) {
  return fmt::format("{}, {}", Point{.row = row}.chart(), text(row, "name"));
}

bool is_there(const Row& row) { return Point{.row = row}.tried(); }

}  // namespace

RunComparison compare_runs(const std::vector<Row>& before, const std::vector<Row>& now) {
  std::map<std::string, const Row*> old;
  for (const Row& row : before) {
    if (is_there(row)) old[identity_of(row).dump()] = &row;
  }
  RunComparison result;
  std::vector<BothRuns> both;
  std::vector<TimePair> times;
  std::set<std::string> others;  // sentences about runs on two devices
  std::ptrdiff_t measured = 0;
  for (const Row& row : now) {
    if (!is_there(row)) continue;
    ++measured;
    const auto found = old.find(identity_of(row).dump());
    if (found == old.end()) continue;
    both.push_back({found->second, &row, name_of(row)});
    if (const std::string was = text(*found->second, "device"), is = text(row, "device"); was != is) {
      others.insert(fmt::format("times on {} and on {} are not compared", was, is));
      continue;
    }
    const std::vector<TimePair> of_point = times_of(both.back());
    result.timed += of_point.empty() ? 0 : 1;
    times.insert(times.end(), of_point.begin(), of_point.end());
    const bool has_times = row.contains("repeats_ms") || both.back().was->contains("repeats_ms");
    if (of_point.empty() && has_times)
      result.lines.push_back(
          fmt::format("{}: its times cannot be compared: both runs need the same numbers of frames and "
                      "repeats, and times above 0",
                      both.back().name));
  }
  result.lines.insert(result.lines.end(), others.begin(), others.end());
  result.matched = both.size();
  const std::size_t broken = result.lines.size();
  Scatter scatter;
  for (const TimePair& pair : times) scatter.add(pair.changes);
  if (scatter.freedom == 0) result.timed = 0;
  for (const TimePair& pair : times) {
    if (scatter.freedom == 0) break;
    Scatter own;
    own.add(pair.changes);
    const double noise = student_t(found_by_chance / static_cast<double>(times.size()), scatter.freedom) *
                         std::max(scatter.deviation(), own.deviation()) /
                         std::sqrt(static_cast<double>(pair.changes.size()));
    const double change = mean(pair.changes);
    if (std::abs(change) <= std::max(noise, pair.least)) continue;
    const double percent = 100.0 * (std::exp(change) - 1.0);
    result.lines.push_back(fmt::format("{}: {:.3f} ms -> {:.3f} ms ({:+.1f} %, noise {:.1f} %)", pair.name,
                                       pair.was, pair.is, percent, 100.0 * noise));
    if (percent > result.slower_percent) {
      result.slower_percent = percent;
      result.slowest = pair.name;
    }
  }
  for (const BothRuns& one : both) {
    const auto tell = [&](const char* column, double least) {
      if (std::abs(number(*one.is, column) - number(*one.was, column)) > least)
        result.lines.push_back(fmt::format("{}: {} {} -> {}", one.name, title_of(column),
                                           shown(*one.was, column), shown(*one.is, column)));
    };
    tell("psnr_db", min_db_change);
    tell("pairs", min_pairs_change * number(*one.was, "pairs"));
  }
  result.lines.push_back(fmt::format(
      "{} numbers of {} points in both runs changed beyond noise; {} points are new, {} are gone{}",
      result.lines.size() - broken, both.size(), measured - static_cast<std::ptrdiff_t>(both.size()),
      old.size() - both.size(),
      scatter.freedom == 0 && !times.empty()
          ? ". Times were not compared, because one repeat per point shows no noise"
          : ""));
  return result;
}

}  // namespace binosplat::lab
