#pragma once
// The record of one frame for a profile: its times, views and levels.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "render/frame.h"

namespace binosplat::render {

/// The levels of detail that arrived for a frame.
struct FrameLevels {
  double ms = 0.0;           // CPU time on the drawing thread
  std::size_t uploaded = 0;  // Gaussians
};

/// A frame's timing as the headset's runtime reports it.
struct FrameDisplay {
  double predicted_ms = 0.0;  // predicted display time, relative to the first frame's
  int missed = 0;             // display periods without a new frame, since the previous frame
};

struct FrameRecord {
  Clock::time_point due = {};    // scheduled begin; equals `begin` without a schedule
  Clock::time_point begin = {};  // before the update of the levels
  Clock::time_point end = {};    // after the drawing
  Report report;
  std::vector<shared::View> views;
  std::size_t gaussians = 0;  // in the model
  FrameLevels levels;
  std::optional<double> mhz;  // the GPU's clock rate
  std::optional<FrameDisplay> display;

  double wall_ms() const { return ms_between(begin, end); }
};

struct FrameEvent {
  std::string name, detail;  // "drawn again", "2 times, since a buffer was too small"

  std::string text() const { return detail.empty() ? name : name + ": " + detail; }
};

/// `before` is the preceding frame; null for the first one.
std::vector<FrameEvent> events_of(const FrameRecord& frame, const FrameRecord* before);

}  // namespace binosplat::render
