#pragma once
// `render --foveate`: sharp where an eye looks, in fewer pixels around it.

#include <optional>
#include <span>
#include <string>

#include "app/cli.h"
#include "app/render_options.h"
#include "render/memory.h"
#include "stereo/foveate.h"

namespace binosplat::app {

void add_foveate_option(CLI::App& sub, std::optional<stereo::Foveation>& foveate);

/// Throws Error for options that do not go with --foveate, where it is given.
void check_foveate(const RenderOptions& options);

/// What a frame of these eyes and their composed pictures take on the GPU.
render::MemoryNeeds foveated_memory(std::span<const shared::View> eyes, const stereo::Foveation& foveation,
                                    const render::FrameSettings& settings, const Model& model);

}  // namespace binosplat::app
