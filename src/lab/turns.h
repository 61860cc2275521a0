#pragma once
// GPU times of several ways to draw, taken in turns, so that a clock that drifts does the same to all.

#include <functional>
#include <span>
#include <vector>

#include "gl/context.h"
#include "gl/dispatch.h"
#include "render/settings.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::lab {

/// How often each of them is timed.
constexpr int turn_rounds = 3;

/// What a frame takes: the medians of each view and round, in the mean.
struct Typical {
  double frame_ms = 0.0, pairs = 0.0;
  std::vector<gl::StageTime> stages;
};

/// `frames` frames of each of `views`, by itself, with each of the settings in every one of the rounds, each
/// after as many as settle what is measured. `progress` is called after each of the settings of a round.
std::vector<Typical> time_in_turns(gl::Context& context, const Model& model,
                                   std::span<const shared::View> views,
                                   std::span<const render::FrameSettings> settings, int frames,
                                   const std::function<void()>& progress);

}  // namespace binosplat::lab
