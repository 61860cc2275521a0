#pragma once
// What there is to draw: a model file, or one of the scenes that the program makes itself.

#include <functional>
#include <vector>

#include "app/render_options.h"
#include "demo/city.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::app {

struct Scene {
  std::vector<Camera> cameras;  // that come with a scene the program makes; of a file: none
  /// The long part: reads or makes it, and repeats it where the options ask for that.
  std::function<Model()> model;
};

/// The city that the options ask for.
CitySettings city_settings(const RenderOptions& options);

/// What the options say of how a model file is to be taken: axes and anti-aliasing.
void set_as_asked(const RenderOptions& options, Model& model);

/// The scene that the options name; they must outlive it. Throws Error for a built-in one that there is not.
Scene open_scene(const RenderOptions& options);

}  // namespace binosplat::app
