#pragma once
// What there is to draw: a model file, or one of the scenes that the program makes itself.

#include <functional>
#include <vector>

#include "app/render_options.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::app {

struct Scene {
  std::vector<Camera> cameras;   // that come with a scene the program makes; of a file: none
  std::function<Model()> model;  // the long part: reads or makes it, and repeats it where options ask for that
};

/// The scene that the options name. Throws Error for a built-in one that there is not.
Scene open_scene(const RenderOptions& options);

}  // namespace binosplat::app
