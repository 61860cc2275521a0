#pragma once
// From the options to a context and to how its frames are drawn.

#include <memory>

#include "app/render_options.h"
#include "gl/context.h"
#include "render/settings.h"
#include "render/workings.h"

namespace binosplat::app {

/// The context that --backend and --device name; the log says what it is.
std::unique_ptr<gl::Context> open_context(const RenderOptions& options);

/// What the options say of a frame; of a table of depths or a calibration it knows nothing.
render::FrameSettings settings_of(const RenderOptions& options);

/// --reference-until.
render::Workings workings_of(const RenderOptions& options);

}  // namespace binosplat::app
