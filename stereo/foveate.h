#pragma once
// Foveated pictures: each eye has an inset around its gaze, exact to the bit. The context around the inset
// has fewer pixels, and the GPU scales it up. Inset and context are views of one frame and are projected
// together.

#include <binosplat/settings.h>

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "gl/dispatch.h"
#include "render/frame.h"

namespace binosplat::stereo {

using Foveation = binosplat::Foveation;

/// Throws Error for illegal numbers; `prefix` precedes their names in the text.
void check(const Foveation& foveation, std::string_view prefix = "");

/// The parts of one eye's picture, px. The context has a hole where only the inset is visible.
struct FoveatedEye {
  glm::uvec2 inset_begin{0}, inset_end{0};  // the exact pixels
  double seam = 0.0;                        // width of the border around the inset
  shared::View context;                     // the context's view, with fewer pixels
  render::ViewRegion context_region;        // the drawn part of the context: all but the hole
  render::ViewRegion window;                // the drawn part of the full-size view: inset and seam
};

/// Plans the parts of an eye's view. `nth` is the eye's index in foveation.gaze. Throws Error as check()
/// does, if the list of gazes lacks this eye, and if the inset lies outside the picture.
FoveatedEye foveate(const shared::View& eye, const Foveation& foveation, std::size_t nth = 0);

/// The views of a frame that draws these eyes by settings.foveation, two per eye (its context, then its
/// window), and the frame's settings. The tolerance applies to the contexts; the insets are exact.
struct FoveatedViews {
  std::vector<FoveatedEye> eyes;
  std::vector<shared::View> views;
  render::FrameSettings settings;
};

/// Throws Error for more than MAX_VIEWS / 2 eyes, for settings with regions or the median depth, and as
/// foveate() does.
FoveatedViews foveated_views(std::span<const shared::View> eyes, const render::FrameSettings& settings);

}  // namespace binosplat::stereo
