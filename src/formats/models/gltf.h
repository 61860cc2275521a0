#pragma once
// glTF and GLB with KHR_gaussian_splatting: Gaussians as points of a mesh, or compressed as an spz file
// (KHR_gaussian_splatting_compression_spz_2). Also drafts of the extension (_ROTATION, _SCALE, COLOR_0).
// Axes: glTF's (LUF).

#include <filesystem>
#include <vector>

#include "formats/containers/opened_file.h"
#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

bool is_gltf(const nlohmann::json& root);

/// Reads the Gaussians of all visible nodes of the scene (KHR_node_visibility), with the copies of
/// EXT_mesh_gpu_instancing, and applies the nodes' transforms (scene/transform.h). Throws Error naming the
/// key if something is damaged, missing or cannot be drawn: unknown required extensions, other kernels, data
/// only in meshopt compression, skins, morph targets. If the file has no Gaussians, the error names its
/// contents. Warns if colours are linear light (drawn unconverted), if scales are below 0 (read as
/// logarithms, as in drafts), and if other meshes are ignored.
Model load_gltf(const OpenedFile& file);

/// Reads the scene's perspective cameras, named after their nodes. The format has no sizes: pictures are
/// pose_height px high (formats/cameras/nerfstudio.h). LensReport (formats/cameras/distortion.h) skips
/// orthographic cameras.
std::vector<Camera> load_gltf_cameras(const OpenedFile& file);

/// Returns the files to which a glTF refers, existing or not.
std::vector<std::filesystem::path> files_of_gltf(const OpenedFile& file);

}  // namespace binosplat
