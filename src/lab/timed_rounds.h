#pragma once
// GPU times of several ways to draw, taken in turns, so that a clock that drifts does the same to all.

#include <functional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "gl/context.h"
#include "render/frame.h"

namespace binosplat::lab {

/// How often each way is timed where nothing else is asked for.
constexpr int turn_rounds = 3;

/// What takes its turn in every round: `begin` draws until times can count, then `frames` frames are timed.
struct Timed {
  int frames = 0;
  std::function<void(int round)> begin;
  std::function<render::FrameReport(int frame)> draw;
};

/// The reports of frames that follow one another.
using Reports = std::vector<render::FrameReport>;

/// Of each of `all`, the frames of each round. `progress` is called after each turn. A GPU's clock is brought
/// up before (wake), by the first.
std::vector<std::vector<Reports>> timed_rounds(const gl::Context& context, int rounds,
                                               std::span<const Timed> all,
                                               const std::function<void()>& progress);

/// What a frame takes.
struct Typical {
  double frame_ms = 0.0, pairs = 0.0;
  std::vector<gl::StageTime> stages;  // ms
};

/// The medians of frames of one view, which a slow frame does not move. Those that measure for the others
/// take longer: both kinds count by their numbers.
Typical typical_of(const Reports& frames);
/// The mean; the stages are the first one's.
Typical mean_of(std::span<const Typical> all);

/// Frames of each of `views`, by itself, with each of the settings, each after as many as settle what is
/// measured: the mean over views and rounds. `progress` is called after each view of a round.
std::vector<Typical> time_in_turns(gl::Context& context, const Model& model,
                                   std::span<const shared::View> views,
                                   std::span<const render::FrameSettings> settings, int frames,
                                   const std::function<void()>& progress);

/// Draws for so long, a second or a little less, after which the clock of a GPU that waited is up again. A
/// software renderer has none.
template <typename Draw>
void wake(const gl::Context& context, double ms, const Draw& draw) {
  if (context.software()) return;
  const auto start = Clock::now();
  while (ms_since(start) < ms) draw();
}

}  // namespace binosplat::lab
