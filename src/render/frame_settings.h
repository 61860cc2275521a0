#pragma once
// The settings of a frame.

#include <binosplat/settings.h>

#include <string_view>
#include <vector>

#include "render/rules.h"
#include "render/view_regions.h"
#include "shared/choices.h"

namespace binosplat::render {

/// Whether frames measure transmittance for later frames.
inline bool measures(const Settings& settings) { return settings.transmittance == Transmittance::last; }

/// Measured transmittance settles within this many frames after a camera cut, usually within three.
constexpr int settling_frames = 8;

/// The library's settings, and those for views and studies. A Frame takes the near plane from the views, and
/// ignores `layout` and `foveation`.
struct FrameSettings : Settings {
  int tiles = TILES_ELLIPSE;       // TILES_ of shared/choices.h
  int precision = PRECISION_FULL;  // PRECISION_, for the model, the splats and the results
  /// False: z_sum is 0, and a frame takes some 3 % less time. Foveated frames have depths unless they are on
  /// canvases. The median is the depth at which T falls below a half; z_sum is then (1 - T) times the median.
  bool has_depths = true;
  /// With measured transmittance: one of `measure_every` frames measures, because measuring slows a frame and
  /// the result holds for a while. Frames that also measure: the first `measure_every` frames after a camera
  /// cut, a frame in which a view has gone a third of the way to a cut since the last measurement
  /// (history.h), and all frames of Scaffold-GS models.
  int measure_every = settling_frames;
  /// With a quality: about the minimum of tiles that a frame draws a second time to measure its error
  /// (tolerance_control.h). Views of less than four times as many tiles are exact.
  int probe_tiles = 256;
  bool anchor_cull = true;  // for Scaffold-GS; true: culls anchors as trained; false: decodes all
  std::vector<ViewRegion> regions = {};  // the drawn part of each view; empty: all of every view
};

/// The settings' threshold. If they have none: with a quality `squared`, but each frame chooses for itself
/// (tolerance_control.h). With a tolerance alone: `adagscale`, which is stable in scenes that nobody measured
/// (docs/measuring.md, "Every rule on every case"). Else `exact`.
inline Threshold chosen_threshold(const Settings& settings) {
  return settings.threshold.value_or(settings.quality     ? Threshold::squared
                                     : settings.tolerance ? Threshold::adagscale
                                                          : Threshold::exact);
}

/// The settings' source of T_upper. If they name none: the rule's usual_source(), but no table that they
/// lack.
inline Transmittance chosen_transmittance(const Settings& settings) {
  const bool has_table = !settings.depth_table.bounds.empty();
  return settings.transmittance.value_or(has_table ? usual_source(chosen_threshold(settings))
                                                   : Transmittance::one);
}

/// The legal range of a quality, dB. Below this range no picture remains; above it, a picture of 8 bits
/// equals the exact one.
constexpr double min_quality = 10.0, max_quality = 100.0;

/// Throws Error for illegal values, and for settings that contradict each other or have no effect. (A frame
/// itself draws any settings: it may measure transmittance with any rule, as measure_depth_table does.)
/// `prefix` precedes the names of members in the text: "--" for options. If `finds_tolerance`, a calibration
/// or a search provides the tolerance, if the settings have none.
void check(const FrameSettings& settings, std::string_view prefix = "", bool finds_tolerance = false);

/// Returns settings for the exact pictures of the same views: in full precision. Keeps order, projection,
/// depth and anchor_cull of `settings`.
FrameSettings exact_of(const FrameSettings& settings);

}  // namespace binosplat::render
