// Finds the events of a frame and the causes of long times.

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/statistics.h"
#include "lab/profile.h"

namespace binosplat::lab {

namespace {

using render::FrameEvent;
using render::FrameRecord;
using render::Recording;

constexpr double slow_share = 0.95;  // of the run's fastest clock; frames with a slower clock are marked

/// The programs that were compiled or loaded during the frame, from their spans.
std::string programs_of(const Recording& recording, const FrameRecord& frame) {
  std::set<std::string> names;
  for (const ThreadSpan& span : recording.spans) {
    if (span.begin < frame.begin || span.end > frame.end) continue;
    for (const std::string start : {"compile ", "load "}) {
      if (span.name.starts_with(start)) names.insert(span.name.substr(start.size()));
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The times of a frame: GPU stages, then CPU work. A software renderer draws while it submits, so its submit
/// time would count the stages twice.
std::vector<StageTime> parts_of(const FrameRecord& frame, bool is_software) {
  std::vector<StageTime> parts = gl::sums_of(frame.report.spans);
  const Report& report = frame.report;
  parts.insert(parts.end(), {{"levels", frame.levels.ms},
                             {"plan", report.plan_ms},
                             {"upload", report.upload_ms},
                             {"read back", report.read_ms}});
  if (!is_software) parts.push_back({"submit", report.submit_ms});
  return parts;
}

Quantiles quantiles_of(const std::vector<double>& values) {
  return {quantile(values, 0.5), quantile(values, 0.9), quantile(values, 0.99), quantile(values, 1.0)};
}

/// All frames' parts (stages, CPU work) in order of appearance, with `sum` (the mean, ...) of their times.
template <typename Parts, typename Sum>
std::vector<StageTime> over_frames(const Recording& recording, const Parts& parts, const Sum& sum) {
  std::vector<StageTime> all;
  std::vector<std::vector<double>> values;
  for (std::size_t n = 0; n < recording.frames.size(); ++n) {
    for (const StageTime& part : parts(recording.frames[n])) {
      const auto found = std::ranges::find(all, part.name, &StageTime::name);
      const auto k = static_cast<std::size_t>(found - all.begin());
      if (found == all.end()) {
        all.push_back({part.name, 0.0});
        values.emplace_back(recording.frames.size(), 0.0);
      }
      values[k][n] = part.ms;
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) all[k].ms = sum(values[k]);
  return all;
}

}  // namespace

double fastest_mhz(const Recording& recording) {
  double most = 0.0;
  for (const FrameRecord& frame : recording.frames) most = std::max(most, frame.mhz.value_or(0.0));
  return most;
}

double gpu_ms(const FrameRecord& frame) {
  double ms = 0.0;
  for (const StageSpan& span : frame.report.spans) ms += span.ms();
  return ms;
}

double cpu_ms(const FrameRecord& frame) {
  const Report& report = frame.report;
  return frame.levels.ms + report.plan_ms + report.upload_ms + report.submit_ms + report.read_ms;
}

bool is_missed(const Recording& recording, std::size_t n) {
  const FrameRecord& frame = recording.frames[n];
  if (frame.display && frame.display->missed > 0) return true;
  return recording.fps > 0.0 && ms_between(frame.due, frame.end) > recording.budget_ms();
}

std::vector<FrameEvent> events_of(const Recording& recording, std::size_t n, double fastest) {
  const FrameRecord& frame = recording.frames[n];
  std::vector<FrameEvent> events = render::events_of(frame, n == 0 ? nullptr : &recording.frames[n - 1]);
  for (FrameEvent& event : events) {
    if (event.name == "program compiled") event.detail = programs_of(recording, frame);
  }
  if (frame.mhz && *frame.mhz < slow_share * fastest)
    events.push_back({"low clock", fmt::format("{:.0f} MHz", *frame.mhz)});
  return events;
}

ProfileSummary summary_of(const Profile& profile) {
  const Recording& recording = profile.recording;
  const bool is_software = profile.facts.is_software;
  if (recording.frames.empty()) fail("no frame was recorded: there is nothing to report");
  ProfileSummary summary;
  std::vector<double> wall, gpu, cpu, mhz;
  const double fastest = fastest_mhz(recording);
  for (std::size_t n = 0; n < recording.frames.size(); ++n) {
    const FrameRecord& frame = recording.frames[n];
    wall.push_back(frame.wall_ms());
    gpu.push_back(gpu_ms(frame));
    cpu.push_back(cpu_ms(frame));
    if (frame.mhz) mhz.push_back(*frame.mhz);
    summary.missed += is_missed(recording, n);
    summary.gpu_bound += gpu.back() >= cpu.back();
    summary.slow_clock += frame.mhz && *frame.mhz < slow_share * fastest;
    summary.worst.push_back(n);
  }
  summary.wall = quantiles_of(wall);
  summary.gpu = quantiles_of(gpu);
  summary.cpu = quantiles_of(cpu);
  if (!mhz.empty()) summary.mhz = quantiles_of(mhz);
  summary.stages = over_frames(
      recording, [](const FrameRecord& frame) { return gl::sums_of(frame.report.spans); },
      [](const std::vector<double>& values) { return mean(values); });
  summary.usual = over_frames(
      recording, [&](const FrameRecord& frame) { return parts_of(frame, is_software); },
      [](const std::vector<double>& values) { return quantile(values, 0.5); });
  std::ranges::stable_sort(summary.worst, [&](std::size_t a, std::size_t b) { return wall[a] > wall[b]; });
  summary.worst.resize(std::min<std::size_t>(10, wall.size()));
  return summary;
}

std::string reason_of(const Profile& profile, const ProfileSummary& summary, std::size_t n) {
  const FrameRecord& frame = profile.recording.frames[n];
  std::vector<std::string> reasons;
  const double fastest = summary.mhz ? summary.mhz->max : 0.0;
  for (const FrameEvent& event : events_of(profile.recording, n, fastest)) reasons.push_back(event.text());
  const double longer = frame.wall_ms() - summary.wall.median;
  StageTime most{"", 0.0};
  double all = 0.0;
  for (const StageTime& part : parts_of(frame, profile.facts.is_software)) {
    const double beyond = part.ms - gl::time_of(summary.usual, part.name);
    all += std::max(beyond, 0.0);
    if (beyond > most.ms) most = {part.name, beyond};
  }
  const double min_excess_ms = 0.1 * std::max(longer, 0.1 * summary.wall.median);
  if (most.ms > min_excess_ms)
    reasons.push_back(fmt::format("{} took {:.2f} ms more than usual", most.name, most.ms));
  if (longer - all > std::max(min_excess_ms, 0.5 * longer))
    reasons.push_back(fmt::format("{:.2f} ms more elsewhere: in the driver or other programs", longer - all));
  return reasons.empty() ? "like other frames" : fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace binosplat::lab
