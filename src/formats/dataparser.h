#pragma once
// nerfstudio trains in its own world: its dataparser transforms the poses, and dataparser_transforms.json in
// the training's folder holds that transform.

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns the file of the training of a model or its folder: in that folder, or up to three levels above it.
std::optional<std::filesystem::path> find_dataparser(const std::filesystem::path& model);

/// Moves cameras into the world of the training: p' = scale (T p), with T and scale from `dataparser`. It
/// applies to a COLMAP reconstruction and to a transforms.json, whose own applied_transform and applied_scale
/// it inverts first. Other cameras stay, since they are already in the model's world, as nerfstudio's paths
/// and exported poses are. Returns whether it moved them. Throws Error naming the file and the key if a value
/// is missing or no such transform.
bool move_into_training(const std::filesystem::path& dataparser, const std::filesystem::path& cameras_file,
                        std::vector<Camera>& cameras);

}  // namespace binosplat
