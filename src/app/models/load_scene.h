#pragma once
// Loads models from files, or makes built-in models.

#include <optional>
#include <span>
#include <vector>

#include "app/options/options.h"
#include "demo/demo.h"
#include "scene/camera.h"
#include "scene/model.h"
#include "stream/load_within.h"

namespace binosplat::app {

CitySettings city_settings(const SceneOptions& options);

/// Applies the options for axes and anti-aliasing to a model.
void apply_options(const SceneOptions& options, Model& model);

/// The cameras of a built-in scene, without its model; none for a file. Throws Error for an unknown scene.
std::vector<Camera> built_in_cameras(const SceneOptions& options);

/// Returns the cameras beside the model; none if they are unreadable, since the user did not name them.
std::vector<Camera> cameras_beside(const SceneOptions& options);

/// Without --axes, chooses the axes of an spz, because programs write spz with two different axes. Prefers
/// the axes with which `cameras`, or else the cameras beside the model, see the model
/// (scene/detected_axes.h). Otherwise takes the file's axes, or else the format's. Logs a choice that the
/// file does not state, and how to change it.
void choose_axes(const SceneOptions& options, std::span<const Camera> cameras, Model& model);

/// Reads or makes the model, repeats it (--repeat) and appends the models of --place. It may take long.
/// `budget` applies to files with levels of detail. `cameras` are the model's views, if known. Throws Error
/// as built_in_cameras() and load_model() do.
Model load_scene(const SceneOptions& options, const std::optional<DetailBudget>& budget = {},
                 std::span<const Camera> cameras = {});

}  // namespace binosplat::app
