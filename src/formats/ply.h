#pragma once
// Trained models in INRIA's ply layout (3D-GS, Kerbl 2023), which many trainers write.
//
// Vertex properties are found by name: x y z, f_dc_0..2, f_rest_*, opacity (logit), scale_0..2 (logarithms),
// rot_0..3 (quaternion w x y z of any length). The number of f_rest is 0, 9, 24 or 45 for harmonics of
// degrees 0 to 3. With 72 (degree 4), degrees up to 3 are read, and Model::lacks_degree_4 is set. With
// K coefficients per channel, the f_rest are channel-major in the file, f_rest[c * K + k], and
// coefficient-major in Model::sh. The file may be text, or binary of either byte order. Any scalar types, any
// order of properties, CRLF in the header, and other elements and properties are read or skipped as ply
// defines.
//
// If a property of a Gaussian is declared as ushort, it is a half (IEEE 754 binary16), a type that ply lacks.
// Some exporters and viewers use this. In text it is the decimal value of its bits. The types half and
// float16, also not in ply, are halves, too.
//
// Other layouts that are read: two scales without scale_2 are flat Gaussians (2D Gaussian Splatting, Huang
// 2024), with a third scale of 0. `red green blue` instead of f_dc are base colours, as uchar (Nerfstudio) or
// floats from 0 to 1 (0 to 255 if one is above 2). `filter_3D` is folded into scales and opacities
// (Mip-Splatting, Yu 2024). formats/compressed_ply.h reads PlayCanvas' compressed ply.

#include <filesystem>

#include "scene/model.h"

namespace binosplat {

/// Reads a model; Model::left_out counts invalid Gaussians. Maps the file into memory and decodes it on all
/// cores; shows progress if it takes long. Throws Error naming the file and the fault's position for a broken
/// header, missing properties, a cut file, a point cloud without opacities, and a header without Gaussians.
Model load_ply(const std::filesystem::path& path);

}  // namespace binosplat
