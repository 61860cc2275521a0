#pragma once
// `--place FILE`: other models in the world of a scene.

#include <span>
#include <string>

#include "app/options/options.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat::app {

/// Appends the models that the JSON file of --place lists, each at its place: a list of objects with
/// - "model": a path, relative to the file, or the name of a built-in scene;
/// - "matrix": 16 numbers, column by column, that bring the model into the world of the cameras (x right, y
///   down, z forward); or "translation", "rotation" and "scale": as a node of glTF; the identity without any;
/// - "opacity": from 0 to 1 (1), multiplies each Gaussian's opacity.
/// The result has the highest degree of all models, and an origin that suits the cameras (move_near). --lod
/// is for all models that have levels. Throws Error for other keys, Scaffold-GS models, and models that were
/// trained with another low-pass or anti-aliasing than `model`, because one setting draws all models.
void append_placed(const SceneOptions& options, Model& model, std::span<const Camera> cameras = {});

/// Notes the file of --place and the files of the models that it lists as inputs (base/inputs.h).
void protect_placed(const std::string& file);

}  // namespace binosplat::app
