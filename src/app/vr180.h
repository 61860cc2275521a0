#pragma once
// `render --vr180`: what lies ahead of each eye as players of VR180 show it.

#include "app/cli.h"
#include "app/render_options.h"
#include "app/shots.h"
#include "render/memory.h"
#include "stereo/panorama.h"

namespace binosplat::app {

void add_vr180_option(CLI::App& sub, Lens& lens);

/// Throws Error for options that do not go with --vr180, where it is given.
void check_vr180(const RenderOptions& options);

/// Holds the head of a shot level, as one who wears a headset does: it looks where it did (a pair of eyes
/// between them), seen from above, and the eyes lie level about their middle.
void level(Shot& shot, const glm::dvec3& up);

/// What one shot's largest face and the panoramas take on the GPU.
render::MemoryNeeds vr180_memory(const Shot& shot, const Model& model, double near_plane);

/// The pictures of the shot's eyes, in the model's axes.
render::FrameReport draw(stereo::Panorama& panorama, const Shot& shot, const ModelAxes& axes,
                         double near_plane);

}  // namespace binosplat::app
