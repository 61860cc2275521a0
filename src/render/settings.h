#pragma once
// The settings of a frame.

#include <binosplat/settings.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "render/rules.h"
#include "render/view_regions.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::render {

/// Whether frames measure transmittance for later frames.
constexpr bool measures(int transmittance) { return transmittance == TRANSMITTANCE_LAST; }

/// Measured transmittance settles within this many frames after a camera cut, usually within three.
constexpr int settling_frames = 8;

struct FrameSettings {
  int tiles = TILES_ELLIPSE;              // TILES_ of shared/axes.h
  int th = TH_TAU;                        // TH_ of shared/axes.h
  int transmittance = TRANSMITTANCE_ONE;  // TRANSMITTANCE_ of shared/axes.h: the source of T_upper
  DepthTable depth_table;                 // with TRANSMITTANCE_DEPTH
  /// With measured transmittance: one of `measure_every` frames measures, because measuring slows a frame and
  /// the result holds for a while. Frames that also measure: the first `measure_every` frames after a camera
  /// cut, a frame in which a view has gone a third of the way to a cut since the last measurement
  /// (history.h), and all frames of Scaffold-GS models.
  int measure_every = settling_frames;
  float tolerance = 0.0f;  // the loss that Th may cause, in the unit of its rule (th_choices)
  /// dB. Above 0: the frame chooses its tolerance, so that the worst view has about this PSNR against the
  /// exact frame, both rounded to 8 bits. Some frames also draw tiles of a view a second time; their error
  /// determines the next tolerance. Frames of unknown error are exact (tolerance_control.h).
  float quality = 0.0f;
  int probe_tiles = 256;  // about the minimum of a probe; views of less than four times as many are exact
  /// ORDER_ and PROJECTION_ of shared/axes.h; none: as the model was trained. `distance` with `tangent` makes
  /// pictures that do not depend on the direction of the head.
  std::optional<int> order, projection;
  bool anchor_cull = true;         // for Scaffold-GS; true: culls anchors as trained; false: decodes all
  int precision = PRECISION_FULL;  // PRECISION_, for the model, the splats and the results
  /// The median is the depth at which T falls below a half; z_sum is then (1 - T) times the median. With
  /// none, z_sum is 0, and a frame takes some 3 % less time. Foveated frames use the mean, or none if the
  /// frames are on canvases.
  Depth depth = Depth::mean;
  std::vector<ViewRegion> regions;  // the drawn part of each view; empty: all of every view
  glm::vec3 background{0.0f};       // behind the scene on canvases and in the probe, and of linear light
};

/// Throws Error for illegal values and contradictory settings: an exact rule with a tolerance or a quality, a
/// tolerance with a quality. `prefix` precedes the names of settings in the text: "--" for options.
void check(const FrameSettings& settings, std::string_view prefix = "");

/// Returns settings for the exact pictures of the same views: in full precision. Keeps order, projection
/// and anchor_cull of `settings`.
FrameSettings exact_of(const FrameSettings& settings);

/// The legal range of a quality, dB. Below this range no picture remains; above it, a picture of 8 bits
/// equals the exact one.
constexpr double quality_least = 10.0, quality_most = 100.0;

/// The same as check() for settings that a user chose. Also throws for a quality out of range, and for a
/// transmittance without effect, because the rule uses no bound. (A frame may measure with any rule, as
/// measure_depth_table does.)
void check_choice(const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
