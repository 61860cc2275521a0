#pragma once
// How a frame goes about it, where a test, the search for a fault or another pass over the same lists wants
// to say: no right picture depends on it.

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

/// Puts what the stages up to `until` would leave into the buffers, in their place; with Stage::blend the
/// pictures themselves are returned. measure/twins.h has the float64 reference's.
struct StandIn {
  Stage until;
  std::function<std::vector<Picture>(const Model&, const FramePlan&, ModelBuffers&, FrameBuffers&)> fill;
};

struct Workings {
  /// So many tiles along each side are a supertile, 1 or 2: with 2 there are fewer pairs to sort. 0:
  /// the frame chooses.
  int supertile_side = 0;
  /// Room to start with, in Gaussians in view and in pairs; 0: chosen by the frame. A frame that needs more
  /// grows its buffers and is drawn again.
  std::int64_t slots = 0;
  std::int64_t pairs = 0;
  std::optional<StandIn> stand_in;
  /// With a quality, at least 1 of so many frames measures its error, and each whose eyes have gone a
  /// fifteenth of the way to a camera cut since the last that did (history.h): a degree, say.
  int probe_every = 4;
  /// Of Scaffold-GS: an anchor whose Gaussians of the last frame Th would all leave out, whatever they had
  /// become, is not decoded. With a measured transmittance, and no quality to probe.
  bool anchor_reuse = true;
  /// The lists hold what is seen between the centres of pixels only, too, for ray_blend.h. With
  /// TILES_ELLIPSE.
  bool between_pixels = false;
  /// z_sums() are no depths, but how much is seen in each pixel: the sum of alpha T^2, without a unit.
  bool visibility_as_depth = false;
  /// Recorded after the last stage, as a stage of this name: what somebody makes of the pictures on the GPU
  /// before anybody waits for them. Again where the frame is drawn again.
  std::function<void(gl::Dispatcher&)> then;
  const char* then_called = "then";
};

/// Throws Error for values that no frame has, and for what stands in for stages in a frame that goes by
/// earlier ones. `prefix` as in settings.h.
void check(const Workings& workings, const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
