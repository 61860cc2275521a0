#pragma once
// `--place FILE`: other models in the world of a scene.

#include <string>

#include "app/scene_options.h"
#include "scene/model.h"

namespace binosplat::app {

/// Appends the models that the JSON file of --place lists, each at its place: a list of objects with
/// - "model": a path, relative to the file, or the name of a built-in scene;
/// - "matrix": 16 numbers, column by column, that bring the model into the world of the cameras (x right, y
///   down, z forward); or "translation", "rotation" and "scale": as a node of glTF; the identity without any.
/// The result has the highest degree of all models. Throws Error for Scaffold-GS models, and for models that
/// were trained with another low-pass or anti-aliasing than `model`, because one setting draws all models.
void append_placed(const SceneOptions& options, Model& model);

/// Returns a hash of the file of --place and of the models that it lists.
std::string placed_key(const std::string& file);

}  // namespace binosplat::app
