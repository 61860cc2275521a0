#pragma once
// The eyes that scenes which are built in are drawn with, so that their pictures are comfortable as they
// come.

#include "app/render_options.h"

namespace binosplat::app {

/// What is drawn of a built-in scene's own views where no option says anything of eyes, screen, lens or way:
/// a pair of eyes and a screen that make all of its views comfortable (stereo/comfort.h), and says so. A
/// head's eyes with the screen infinitely far, as for models, ask for more than that of whoever looks at the
/// pictures on a screen. Else the options as they are.
RenderOptions with_eyes_of_demo(RenderOptions options);

}  // namespace binosplat::app
