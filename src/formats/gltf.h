#pragma once
// glTF and GLB with KHR_gaussian_splatting: Gaussians as points of a mesh, also compressed as an spz file
// (KHR_gaussian_splatting_compression_spz_2), and drafts of it (_ROTATION, _SCALE, COLOR_0). Frame: glTF's
// (LUF).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "scene/model.h"

namespace binosplat {

/// Whether a JSON file is one.
bool is_gltf(const nlohmann::json& root);

/// Reads the Gaussians of all nodes of the scene, with the nodes' translations, uniform scales and, where
/// there are no harmonics above degree 0, rotations. Throws Error naming the key where something is damaged,
/// missing or cannot be drawn: nodes that mirror, scale unevenly or turn harmonics, other kernels, meshopt. A
/// file without Gaussians is named for what it holds. Colours that are linear light are drawn as they are,
/// with a warning.
Model load_gltf(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
