#pragma once
// Trained models in INRIA's ply layout (3D-GS, Kerbl 2023), as many trainers write it.
//
// Vertex properties are found by name: x y z, f_dc_0..2, f_rest_*, opacity (logit), scale_0..2 (logarithms),
// rot_0..3 (quaternion w x y z of any length). The number of f_rest gives the degree of the spherical
// harmonics: 0, 9, 24 or 45 for degrees 0 to 3; of 72 (degree 4) degree 3 is read, and Model::lacks_degree_4
// is set. They are channel-major in the file, f_rest[c * K + k], and coefficient-major in Model::sh. Text and
// binary of either byte order, any scalar type, any order of properties, CRLF in the header, other elements
// and properties: all are read or skipped as ply defines.
//
// A number of a Gaussian that is declared as ushort is a half (IEEE 754 binary16), of which ply has no type:
// some exporters write them so, and other viewers read them so. In text it is the whole number of its bits.
// The types half and float16, which are no part of ply either, are read as what they say.
//
// Three relatives are read as well: two scales and no scale_2 are flat Gaussians (2D Gaussian Splatting,
// Huang 2024), whose third scale is 0; `red green blue` in f_dc's place are base colours, as uchar
// (Nerfstudio) or floats, of 0 to 1 or, where one is above 2, of 0 to 255, and `filter_3D` is folded into
// scales and opacities (Mip-Splatting, Yu 2024). PlayCanvas' compressed ply (formats/compressed_ply.h) is
// read as well.

#include <filesystem>

#include "scene/model.h"

namespace binosplat {

/// Reads a model; degree and count are the file's, Model::left_out counts what was not usable. The file is
/// mapped into memory and decoded on all cores; progress is shown where it takes long. Throws Error naming
/// the file and the place: a broken header, missing properties, a file shorter than its header promises, a
/// point cloud without opacities, a header that promises no Gaussians.
Model load_ply(const std::filesystem::path& path);

}  // namespace binosplat
