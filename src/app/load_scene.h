#pragma once
// Models to draw: from files, or made by the program itself.

#include <optional>
#include <span>
#include <vector>

#include "app/scene_options.h"
#include "demo/demo.h"
#include "scene/camera.h"
#include "scene/model.h"
#include "stream/load_within.h"

namespace binosplat::app {

/// The city that the options ask for.
CitySettings city_settings(const SceneOptions& options);

/// What the options say of how a model file is to be taken: axes and anti-aliasing.
void set_as_asked(const SceneOptions& options, Model& model);

/// The cameras of a scene that is built in, quickly; of a file: none. Throws Error for a built-in one that
/// there is not.
std::vector<Camera> built_in_cameras(const SceneOptions& options);

/// The axes of an spz, which is written in two frames, where no option says which: those in which
/// `cameras`, or the ones beside the model, look at it (scene/detected_axes.h), or else the file's or the
/// format's. Says which, unless it is what the file says, and how to choose others.
void settle_axes(const SceneOptions& options, std::span<const Camera> cameras, Model& model);

/// The long part: reads or makes the model, and repeats it where the options ask for that. `budget` of a file
/// with levels of detail; `cameras` are those that it is seen from, where they are known. Throws Error as
/// built_in_cameras() and load_model() do.
Model load_scene(const SceneOptions& options, const std::optional<DetailBudget>& budget = {},
                 std::span<const Camera> cameras = {});

}  // namespace binosplat::app
