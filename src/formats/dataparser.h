#pragma once
// nerfstudio trains in a world of its own: what its dataparser makes of the poses, and leaves as
// dataparser_transforms.json in the folder of a training.

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// The file of the training that a model or its folder belongs to: in that folder, or up to three above it.
std::optional<std::filesystem::path> find_dataparser(const std::filesystem::path& model);

/// Moves cameras into the world of the training: p' = scale (T p), with T and scale those of `dataparser`, if
/// `cameras_file` is a transforms.json, whose own applied_transform and applied_scale are taken back first,
/// or a COLMAP reconstruction. Others stay, since they are given in the model's world (nerfstudio's paths and
/// exported poses, too). Returns whether it did. Throws Error naming the file and the key for what is missing
/// or no such transform.
bool move_into_training(const std::filesystem::path& dataparser, const std::filesystem::path& cameras_file,
                        std::vector<Camera>& cameras);

}  // namespace binosplat
