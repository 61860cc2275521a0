#include "render/profiled_frame.h"

#include <fmt/core.h>

namespace binosplat::render {

namespace {

std::string times(int count) { return count == 1 ? "once" : fmt::format("{} times", count); }

}  // namespace

std::vector<FrameEvent> events_of(const FrameRecord& frame, const FrameRecord* before) {
  const Report& report = frame.report;
  std::vector<FrameEvent> events;
  if (report.redraws > 0)
    events.push_back({"drawn again", times(report.redraws) + ", since a buffer was too small"});
  if (report.exact != ExactReason::not_exact) events.push_back({"drawn exactly", name_of(report.exact)});
  if (report.sampled_error) events.push_back({"measured its error", ""});
  if (report.new_programs > 0)
    events.push_back({"program compiled", fmt::format("{} or loaded", times(report.new_programs))});
  if (frame.levels.uploaded > 0)
    events.push_back({"levels uploaded", fmt::format("{} Gaussians", frame.levels.uploaded)});
  const std::int64_t grown = before == nullptr ? 0 : report.gpu_bytes - before->report.gpu_bytes;
  if (grown > 0)
    events.push_back({"buffers grew", fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(grown))});
  if (frame.display && frame.display->missed > 0)
    events.push_back({"display missed", times(frame.display->missed)});
  return events;
}

}  // namespace binosplat::render
