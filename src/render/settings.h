#pragma once
// What a caller may choose about a frame.

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

/// Whether frames measure transmittance for later ones.
constexpr bool measures(int transmittance) { return transmittance == TRANSMITTANCE_LAST; }

/// The frames after a camera cut in which what they measure settles; three are enough for most.
constexpr int settling_frames = 8;

struct FrameSettings {
  int tiles = TILES_ELLIPSE;              // TILES_ of shared/axes.h
  int th = TH_TAU;                        // TH_ of shared/axes.h
  int transmittance = TRANSMITTANCE_ONE;  // TRANSMITTANCE_ of shared/axes.h: where Th takes T_upper from
  DepthTable depth_table;                 // with TRANSMITTANCE_DEPTH
  /// With a measured transmittance: measuring makes a frame slower, and what was measured holds for a while.
  /// At least one of `measure_every` frames measures, as do the first `measure_every` after a camera cut, and
  /// each whose eyes have gone a third of the way to a cut (history.h). Models of Scaffold-GS measure every
  /// frame.
  int measure_every = settling_frames;
  float tolerance = 0.0f;  // what Th may cost, in the unit of its rule (th_choices)
  /// dB. Above 0: the frame chooses its tolerance itself, so that the view that errs most has about this PSNR
  /// against the exact frame, both as 8 bits would keep them. A frame that measures its error draws some
  /// tiles of a view exactly, too, and the next tolerance follows from what they show; one that misses, and
  /// the first one, is drawn again (tolerance_control.h).
  float quality = 0.0f;
  int probe_tiles = 256;  // how many tiles about, at least; all of the view where it has no more
  /// DECODE_, for Scaffold-GS only. Cyclopean decodes views 2k and 2k + 1 together, from between their eyes.
  int decode = DECODE_EYES;
  /// ORDER_ and PROJECTION_ of shared/axes.h; none: what the model was trained with. Together `distance` and
  /// `tangent` make pictures that do not depend on where the head is turned.
  std::optional<int> order, projection;
  bool anchor_cull = true;  // for Scaffold-GS: as trained; false: anchors out of view are decoded, too
  /// px: 8, 16 or 32, on which an exact picture does not depend.
  int tile_size = TILE_SIZE_DEFAULT;
  int precision = PRECISION_FULL;  // PRECISION_, for the model, the splats and all that is made of them
  /// The median is the depth at which T falls below a half: z_sum is then (1 - T) times that. With none z_sum
  /// is 0, and a frame takes some 3 % less time. Foveated frames have the mean, on canvases none.
  Depth depth = Depth::mean;
  std::vector<ViewRegion> regions;  // what is drawn of each view; empty: all of every view
  glm::vec3 background{0.0f};       // behind the scene on canvases and in the probe; pictures are without
};

/// Throws Error for values that no frame has and for settings that contradict each other: an exact rule with
/// a tolerance or a quality, a tolerance with a quality.
/// `prefix` goes before the names of settings in the text: "--" where they were given as options.
void check(const FrameSettings& settings, std::string_view prefix = "");

/// Settings for the exact pictures of the same views: in full precision, and with each eye's own Gaussians.
/// They keep order, projection, anchor_cull and tile_size of `settings`.
FrameSettings exact_of(const FrameSettings& settings);

/// The qualities that may be asked for, dB: below there is no picture any more, and above a picture of 8 bits
/// is the exact one.
constexpr double quality_least = 10.0, quality_most = 100.0;

/// The same as check() for settings that a user chose, of which each must have an effect: it throws for a
/// transmittance with a rule that uses no bound, too. (A frame may measure with any rule, as
/// measure_depth_table does.)
void check_choice(const FrameSettings& settings, std::string_view prefix = "");

}  // namespace binosplat::render
