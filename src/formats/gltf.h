#pragma once
// glTF and GLB with KHR_gaussian_splatting: Gaussians as points of a mesh, also compressed as an spz file
// (KHR_gaussian_splatting_compression_spz_2), and drafts of it (_ROTATION, _SCALE, COLOR_0). Frame: glTF's
// (LUF).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "scene/model.h"

namespace binosplat {

/// Whether a JSON file is one.
bool is_gltf(const nlohmann::json& root);

/// Reads the Gaussians of all nodes of the scene that are not hidden (KHR_node_visibility), as often as
/// EXT_mesh_gpu_instancing shows them, moved by their transforms, of whatever kind (scene/transform.h).
/// Throws Error naming the key where something is damaged, missing or cannot be drawn: extensions that are
/// required and not known, other kernels, data that are only there compressed by meshopt, skins, morph
/// targets. A file without Gaussians is named for what it holds. With a warning, colours that are linear
/// light are drawn as they are, scales below 0 are taken for logarithms, as drafts had them, and other meshes
/// are left out.
Model load_gltf(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The files that it names besides itself, whether they are there or not.
std::vector<std::filesystem::path> files_of_gltf(const std::filesystem::path& path,
                                                 std::span<const std::byte> bytes);

}  // namespace binosplat
