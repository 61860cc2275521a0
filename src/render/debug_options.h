#pragma once
// Options for tests, for locating a fault, and for other passes over a frame's lists. A correct picture never
// depends on them.

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "gl/dispatch.h"
#include "render/frame_settings.h"
#include "render/stage.h"
#include "scene/model.h"

namespace binosplat::render {

struct FrameBuffers;
struct FramePlan;
struct ModelBuffers;

/// Replaces the stages up to `until`: fill() writes their results into the buffers. For Stage::blend, fill()
/// returns the pictures instead. measure/reference_stages.h has the stand-in by the float64 reference.
struct StandIn {
  Stage until;
  std::function<std::vector<Picture>(const Model&, const FramePlan&, ModelBuffers&, FrameBuffers&)> fill;
};

struct DebugOptions {
  /// Initial capacity for Gaussians in view and for pairs; 0: the frame chooses. Buffers grow if needed.
  std::int64_t slots = 0;
  std::int64_t pairs = 0;
  std::optional<StandIn> stand_in;
  /// The lists also hold splats that are visible only between pixel centres, for ray_blend.h. Requires
  /// TILES_ELLIPSE.
  bool between_pixels = false;
  /// z_sums() stores each pixel's visibility instead of a depth: the sum of alpha T^2 over its splats.
  bool visibility_as_depth = false;
  /// Appends a stage, such as compositing. Called after the last stage, before the frame waits for the GPU;
  /// called again if the frame is drawn again.
  std::function<void(gl::Dispatcher&)> extra_stage;
  const char* extra_stage_name = "extra";
};

/// Throws Error for illegal values, and for a stand-in in a frame that would use earlier measurements.
/// `prefix` as in settings.h.
void check(const DebugOptions& debug, const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
