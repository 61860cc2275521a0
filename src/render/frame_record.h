#pragma once
// A frame of a run, as profiles keep it: what was drawn, and when.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "render/frame.h"

namespace binosplat::render {

/// Levels of detail that came for a frame.
struct FrameLevels {
  double ms = 0.0;           // CPU time on the thread that draws
  std::size_t uploaded = 0;  // Gaussians
};

/// What a headset's runtime said of a frame.
struct FrameDisplay {
  double predicted_ms = 0.0;  // when it is to be shown, since the first frame was
  int missed = 0;             // times that something was shown between the last frame and this one
};

struct FrameRecord {
  Clock::time_point due = {};    // when it was to begin; `begin` where nothing says so
  Clock::time_point begin = {};  // before its levels
  Clock::time_point end = {};    // once it is drawn
  FrameReport report;
  std::vector<shared::View> views;
  std::size_t gaussians = 0;  // of the model
  FrameLevels levels;
  std::optional<double> mhz;  // the GPU's clock
  std::optional<FrameDisplay> display;

  double wall_ms() const { return std::chrono::duration<double, std::milli>(end - begin).count(); }
};

/// Something that happened in a frame.
struct FrameEvent {
  std::string name, detail;  // "drawn again", "2 times, since a buffer was too small"

  std::string text() const { return detail.empty() ? name : name + ": " + detail; }
};

/// `before` is the frame before it; null for the first one.
std::vector<FrameEvent> events_of(const FrameRecord& frame, const FrameRecord* before);

}  // namespace binosplat::render
