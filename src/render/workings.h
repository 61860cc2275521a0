#pragma once
// How a frame is drawn, for tests, the search for a fault and other passes over the same lists. No right
// picture depends on it.

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/settings.h"
#include "render/stage.h"
#include "scene/model.h"

namespace binosplat::render {

struct FrameBuffers;
struct FramePlan;
struct ModelBuffers;

/// Stands in for the stages up to `until`: fill() puts into the buffers what they would leave there; with
/// Stage::blend it returns the pictures themselves. measure/twins.h has the float64 reference's.
struct StandIn {
  Stage until;
  std::function<std::vector<Picture>(const Model&, const FramePlan&, ModelBuffers&, FrameBuffers&)> fill;
};

struct Workings {
  /// Room to start with, in Gaussians in view and in pairs; 0: the frame chooses. A frame that needs more
  /// grows its buffers and is drawn again.
  std::int64_t slots = 0;
  std::int64_t pairs = 0;
  std::optional<StandIn> stand_in;
  /// The lists also hold splats that are seen only between the centres of pixels, for ray_blend.h. For
  /// TILES_ELLIPSE.
  bool between_pixels = false;
  /// z_sums() has no depths, but how much is seen in each pixel: the sum of alpha T^2, without a unit.
  bool visibility_as_depth = false;
  /// Called after the last stage, to record a further one that makes something of the pictures on the GPU
  /// before the frame waits for them. Called again where the frame is drawn again.
  std::function<void(gl::Dispatcher&)> then;
  const char* then_called = "then";  // that stage's name
};

/// Throws Error for values that no frame has, and for a stand-in where a frame would use what earlier ones
/// measured. `prefix` as in settings.h.
void check(const Workings& workings, const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
