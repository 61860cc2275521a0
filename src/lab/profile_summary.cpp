// The text of a profile, for the terminal and for its page.

#include <fmt/ranges.h>

#include <algorithm>

#include "base/log.h"
#include "base/statistics.h"
#include "base/text.h"
#include "lab/profile.h"

namespace binosplat::lab {

namespace {

double all_stages(const ProfileSummary& summary) {
  double all = 0.0;
  for (const StageTime& stage : summary.stages) all += stage.ms;
  return all;
}

const StageTime& longest_stage(const ProfileSummary& summary) {
  return *std::ranges::max_element(summary.stages, {}, &StageTime::ms);
}

bool is_gpu_bound(const Profile& profile, const ProfileSummary& summary) {
  return 2 * summary.gpu_bound >= profile.recording.frames.size();
}

std::string line_of(const char* what, const Quantiles& q) {
  return fmt::format("{:<8}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}", what, q.median, q.p90, q.p99, q.max);
}

std::string clock_of(const Profile& profile, const ProfileSummary& summary) {
  if (!summary.mhz) return "unknown: " + profile.recording.no_clock;
  return fmt::format("{:.0f} MHz (median), {} of {} frames below 95 % of {:.0f}", summary.mhz->median,
                     summary.slow_clock, profile.recording.frames.size(), summary.mhz->max);
}

/// The medians of up to ten stretches, each of at least five frames.
std::vector<double> by_stretch(const std::vector<double>& ms) {
  constexpr std::size_t stretches = 10, min_stretch_frames = 5;
  const std::size_t count = std::clamp<std::size_t>(ms.size() / min_stretch_frames, 1, stretches);
  std::vector<double> medians;
  for (std::size_t k = 0; k < count; ++k) {
    const auto first = ms.begin() + static_cast<std::ptrdiff_t>(k * ms.size() / count);
    const auto last = ms.begin() + static_cast<std::ptrdiff_t>((k + 1) * ms.size() / count);
    medians.push_back(quantile({first, last}, 0.5));
  }
  return medians;
}

}  // namespace

std::string bound_of(const Profile& profile, const ProfileSummary& summary) {
  const std::size_t frames = profile.recording.frames.size();
  const double all = all_stages(summary);
  const std::string stage = all > 0.0 ? fmt::format("{} {:.0f} %", longest_stage(summary).name,
                                                    100.0 * longest_stage(summary).ms / all)
                                      : "stages are not timed";
  if (profile.facts.is_software) return fmt::format("the CPU, which draws ({})", stage);
  if (is_gpu_bound(profile, summary))
    return fmt::format("GPU ({}), in {} of {} frames", stage, summary.gpu_bound, frames);
  const auto& most = *std::ranges::max_element(summary.usual, {}, [&](const StageTime& part) {
    const bool is_stage =
        std::ranges::find(summary.stages, part.name, &StageTime::name) != summary.stages.end();
    return is_stage ? -1.0 : part.ms;
  });
  return fmt::format("CPU ({} {:.2f} ms), in {} of {} frames", most.name, most.ms, frames - summary.gpu_bound,
                     frames);
}

std::string advice_of(const Profile& profile, const ProfileSummary& summary) {
  const double all = all_stages(summary);
  const render::Recording& recording = profile.recording;
  if (recording.fps > 0.0 && summary.missed == 0) return "";
  if (!profile.facts.is_software && !is_gpu_bound(profile, summary))
    return bound_of(profile, summary).starts_with("CPU (levels ")
               ? "a coarser `detail`: the GPU waits for the CPU, which chooses and uploads levels"
               : "fewer other programs and a CPU at its full clock: the GPU waits for the CPU, so smaller "
                 "pictures and `quality` save no time";
  if (profile.saving && profile.saving->share > 0.02)
    return fmt::format(
        "`quality` {:g} would save {:.0f} % of a frame: binosplat bench {} `size` {}x{} compares settings",
        profile.saving->quality_db, 100.0 * profile.saving->share, profile.facts.scene,
        recording.frames.back().views.front().width, recording.frames.back().views.front().height);
  if (summary.slow_clock > 0 && summary.missed > 0)
    return "a locked GPU clock (nvidia-smi --lock-gpu-clocks), then profile again";
  const std::string& drawing = profile.facts.drawing;
  const bool has_levels = drawing.find("levels of detail") != std::string::npos;
  if (!has_levels && recording.frames.back().gaussians > 1'000'000 && all > 0.0 &&
      longest_stage(summary).name == "project")
    return fmt::format("levels of detail: binosplat levels {} writes them", profile.facts.scene);
  if (summary.missed == 0) return "";
  std::vector<std::string> words = {"a smaller `size`"};
  if (has_levels) words.emplace_back("a coarser `detail`");
  if (drawing.find("foveated") != std::string::npos) words.emplace_back("a smaller context of `foveate`");
  if (drawing.starts_with("at about")) words.emplace_back("a lower `quality`");
  if (drawing == "exact" && !profile.saving) words.emplace_back("`quality` 40");
  if (drawing == "exact") words.emplace_back("`foveate` if a device tracks the eyes");
  return alternatives(words);
}

std::vector<std::string> lines_of(const Profile& profile, const ProfileSummary& summary) {
  const render::Recording& recording = profile.recording;
  const auto& views = recording.frames.front().views;
  std::vector<std::string> lines = {
      fmt::format("{}, {}: {} frames of {} x {} x {} px, {}", profile.facts.scene, profile.facts.motion,
                  recording.frames.size(), views.size(), views.front().width, views.front().height,
                  profile.facts.drawing),
      fmt::format("{:<8}{:>10}{:>10}{:>10}{:>10}", "ms", "median", "p90", "p99", "max"),
      line_of("frame", summary.wall), line_of("GPU", summary.gpu), line_of("CPU", summary.cpu)};
  if (recording.fps > 0.0) {
    lines.push_back(fmt::format(
        "missed  {} of {} frames: they ended after the next one was due ({:.1f} ms, {:g} a second)",
        summary.missed, recording.frames.size(), recording.budget_ms(), recording.fps));
  }
  std::vector<int> again;  // drawings of each frame after its first
  for (const render::FrameRecord& frame : recording.frames) again.push_back(frame.report.redraws);
  if (const auto most = std::ranges::max_element(again); *most > 0)
    lines.push_back(fmt::format("again   {} of {} frames were drawn again: frame {} most often ({} x)",
                                again.size() - std::ranges::count(again, 0), again.size(),
                                most - again.begin(), *most));
  for (const ExactReason reason : {ExactReason::unmeasured, ExactReason::no_gain, ExactReason::small}) {
    const auto exact =
        std::ranges::count(recording.frames, reason, [](const auto& f) { return f.report.exact; });
    if (exact > 0)
      lines.push_back(fmt::format("exact   {} of {} frames were drawn exactly: {}", exact,
                                  recording.frames.size(), name_of(reason)));
  }
  for (std::size_t k = 0; k < std::min<std::size_t>(2, summary.worst.size()); ++k) {
    const std::size_t n = summary.worst[k];
    lines.push_back(fmt::format("worst   frame {}, {:.2f} ms: {}", n, recording.frames[n].wall_ms(),
                                reason_of(profile, summary, n)));
  }
  lines.push_back(
      fmt::format("bound   {}; clock {}", bound_of(profile, summary), clock_of(profile, summary)));
  const std::string advice = advice_of(profile, summary);
  if (!advice.empty()) lines.push_back("try     " + as_shown(advice));
  return lines;
}

Point profile_point(const Profile& profile, const ProfileSummary& summary) {
  const render::Recording& recording = profile.recording;
  const auto& views = recording.frames.front().views;
  std::vector<double> wall, gpu, pairs, visible;
  for (const render::FrameRecord& frame : recording.frames) {
    wall.push_back(frame.wall_ms());
    gpu.push_back(gpu_ms(frame));
    pairs.push_back(static_cast<double>(frame.report.pairs));
    visible.push_back(static_cast<double>(frame.report.visible));
  }
  Point point{object("scene", profile.facts.scene, "eyes", views.size(), "size",
                     fmt::format("{}x{}", views.front().width, views.front().height), "along",
                     profile.facts.motion, "name", profile.facts.drawing, "device", profile.facts.device)};
  Row& row = point.row;
  put(row, "frame_ms", mean(gpu), "p99_ms", summary.gpu.p99, "max_ms", summary.gpu.max, "wall_ms", mean(wall),
      "wall_p99_ms", summary.wall.p99, "wall_max_ms", summary.wall.max, "frames", recording.frames.size(),
      "missed", summary.missed, "pairs", mean(pairs), "visible", mean(visible), "gaussians",
      recording.frames.back().gaussians, "gpu_bytes", recording.frames.back().report.gpu_bytes);
  if (recording.fps > 0.0) put(row, "fps", recording.fps);
  put_stages(summary.stages, row);
  if (gpu.front() > 0.0) row["repeats_ms"] = by_stretch(gpu);
  row["wall_repeats_ms"] = by_stretch(wall);
  if (!profile.cpu.empty()) {
    std::vector<double> used;
    for (const CpuUse& frame : profile.cpu) used.push_back(frame.used);
    put_cpu_times(profile.cpu, row);
    row["cpu_repeats_ms"] = by_stretch(used);
  }
  put(row, "bound", bound_of(profile, summary), "clock", clock_of(profile, summary), "advice",
      as_shown(advice_of(profile, summary)));
  for (const std::size_t n : summary.worst)
    point.details.push_back(object("kind", "worst", "frame", n, "wall_ms", wall[n], "frame_ms", gpu[n],
                                   "reason", reason_of(profile, summary, n)));
  return point;
}

}  // namespace binosplat::lab
