#include "lab/times.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/log.h"
#include "base/statistics.h"
#include "lab/results.h"

namespace binosplat::lab {

namespace {

/// The typical value(frame), by the rule of typical_of().
template <typename Value>
double typical(const Reports& frames, const Value& value) {
  double sum = 0.0;
  for (const bool measures : {false, true}) {
    std::vector<double> values;
    for (const Report& frame : frames) {
      if (frame.measured == measures) values.push_back(value(frame));
    }
    const auto count = static_cast<double>(values.size());
    if (!values.empty()) sum += count * quantile(std::move(values), 0.5);
  }
  return sum / static_cast<double>(frames.size());
}

}  // namespace

Typical typical_of(const Reports& frames) {
  Typical all{.frame_ms = typical(frames, [](const Report& f) { return f.gpu_ms; })};
  const auto plain = std::ranges::find(frames, false, &Report::measured);
  for (const StageTime& stage : (plain == frames.end() ? frames.front() : *plain).stages) {
    all.stages.push_back(
        {stage.name, typical(frames, [&](const Report& f) { return gl::time_of(f.stages, stage.name); })});
  }
  return all;
}

Typical mean_of(std::span<const Typical> all) {
  Typical result{.stages = all.front().stages};
  for (StageTime& stage : result.stages) stage.ms = 0.0;
  const double weight = 1.0 / static_cast<double>(all.size());
  for (const Typical& one : all) {
    result.frame_ms += weight * one.frame_ms;
    for (StageTime& stage : result.stages) stage.ms += weight * gl::time_of(one.stages, stage.name);
  }
  return result;
}

void put_times(const std::vector<double>& repeats, const std::vector<double>& all_ms, Row& row) {
  const auto [least, most] = std::ranges::minmax(repeats);
  put(row, "frame_ms", mean(repeats), "p99_ms", quantile(all_ms, 0.99), "max_ms", quantile(all_ms, 1.0),
      "frames", all_ms.size(), "repeats_ms", repeats);
  if (repeats.size() > 1) put(row, "noise_ms", (most - least) / 2);
}

void put_stages(const std::vector<StageTime>& stages, Row& row) {
  for (const StageTime& stage : stages) put(row, stage_column(stage.name), stage.ms);
}

void put_clock(bool full, Row& row) {
  put(row, "full_clock", full);
  if (!full)
    log_warning(
        "the GPU's clock was low each time that these frames were timed, so their times are too long");
}

void put_cpu_times(const std::vector<CpuUse>& repeats, Row& row) {
  if (repeats.empty()) return;
  std::vector<double> used;
  CpuUse all;
  for (const CpuUse& repeat : repeats) {
    used.push_back(repeat.used);
    all += repeat;
  }
  put(row, "cpu_ms", mean(used), "cpu_repeats_ms", used, "waited",
      100.0 * all.waited / (all.used + all.waited));
}

CpuUse CpuUse::now(const gl::Context& context) {
  CpuUse use;
  if (!context.software()) return use;
  std::error_code ignored;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", ignored)) {
    std::ifstream in(task.path() / "schedstat");
    double used_ns = 0.0, waited_ns = 0.0;
    if (in >> used_ns >> waited_ns) use += {1e-6 * used_ns, 1e-6 * waited_ns};
  }
  return use;
}

}  // namespace binosplat::lab
