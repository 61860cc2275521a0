#pragma once
// nerfstudio transforms poses into the world of its training: dataparser_transforms.json has the transform.

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns the dataparser_transforms.json of a model's training: in the model's folder, or in one of the
/// three folders above. `model` is the model's file or its folder.
std::optional<std::filesystem::path> find_dataparser(const std::filesystem::path& model);

/// Moves the cameras of a COLMAP reconstruction or a transforms.json into the world of the training:
/// p' = scale (T p), with T and scale from `dataparser`. For a transforms.json, first inverts its own
/// applied_transform and applied_scale. Other cameras, such as nerfstudio's paths and exported poses, are in
/// the model's world already and are not moved. Returns whether the cameras were moved. If a value is missing
/// or invalid, throws Error and names the file and the key.
bool move_into_training(const std::filesystem::path& dataparser, const std::filesystem::path& cameras_file,
                        std::vector<Camera>& cameras);

}  // namespace binosplat
