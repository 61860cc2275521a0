#include "lab/times.h"

#include <algorithm>
#include <ctime>

#include "base/statistics.h"

namespace binosplat::lab {

namespace {

/// Of value(frame), if the frame has one.
template <typename Value>
double typical(const Reports& frames, const Value& value) {
  double sum = 0.0;
  for (const bool measures : {false, true}) {
    std::vector<double> values;
    for (const render::FrameReport& frame : frames) {
      if (frame.measured == measures) values.push_back(value(frame));
    }
    const auto count = static_cast<double>(values.size());
    if (!values.empty()) sum += count * quantile(std::move(values), 0.5);
  }
  return sum / static_cast<double>(frames.size());
}

double time_of_stage(const std::vector<gl::StageTime>& stages, const std::string& name) {
  const auto found = std::ranges::find(stages, name, &gl::StageTime::name);
  return found == stages.end() ? 0.0 : found->ms;
}

}  // namespace

Typical typical_of(const Reports& frames) {
  Typical all{.frame_ms = typical(frames, [](const render::FrameReport& f) { return f.total_ms; })};
  const auto plain = std::ranges::find(frames, false, &render::FrameReport::measured);
  for (const gl::StageTime& stage : (plain == frames.end() ? frames.front() : *plain).stages) {
    all.stages.push_back({stage.name, typical(frames, [&](const render::FrameReport& f) {
                            return time_of_stage(f.stages, stage.name);
                          })});
  }
  return all;
}

Typical mean_of(std::span<const Typical> all) {
  Typical result{.stages = all.front().stages};
  for (gl::StageTime& stage : result.stages) stage.ms = 0.0;
  const double weight = 1.0 / static_cast<double>(all.size());
  for (const Typical& one : all) {
    result.frame_ms += weight * one.frame_ms;
    for (gl::StageTime& stage : result.stages) stage.ms += weight * time_of_stage(one.stages, stage.name);
  }
  return result;
}

void put_times(const std::vector<double>& repeats, const std::vector<double>& cpu_repeats,
               const std::vector<double>& all_ms, Row& row) {
  const auto [least, most] = std::ranges::minmax(repeats);
  put(row, "frame_ms", mean(repeats), "p99_ms", quantile(all_ms, 0.99), "most_ms", quantile(all_ms, 1.0),
      "frames", all_ms.size(), "repeats_ms", repeats);
  if (repeats.size() > 1) put(row, "noise_ms", (most - least) / 2);
  if (!cpu_repeats.empty()) put(row, "cpu_ms", mean(cpu_repeats), "cpu_repeats_ms", cpu_repeats);
}

double process_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace binosplat::lab
