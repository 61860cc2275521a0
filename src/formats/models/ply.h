#pragma once
// Trained models in INRIA's ply layout (3D-GS, Kerbl 2023), which many trainers write.
//
// Vertex properties are found by name: x y z, f_dc_0..2, f_rest_*, opacity (logit), scale_0..2 (logarithms),
// rot_0..3 (quaternion w x y z of any length). The number of f_rest is 0, 9, 24 or 45 for harmonics of
// degrees 0 to 3. With 72 (degree 4), degrees up to 3 are read, and Model::lacks_degree_4 is set. With K
// coefficients per channel, the file is channel-major, f_rest[c * K + k], and Model::sh coefficient-major.
// The file may be text, or binary of either byte order. Its header may have CRLF, any scalar types, any order
// of properties, and other elements and properties.
//
// A property of type ushort, half or float16 is a half (IEEE 754 binary16), a type that ply lacks and some
// exporters and viewers use. A ushort in a text file is the decimal value of the half's bits.
//
// Other layouts that are read: two scales without scale_2 are flat Gaussians (2D Gaussian Splatting, Huang
// 2024), with a third scale of 0. `red green blue` instead of f_dc are base colours, as uchar (Nerfstudio) or
// floats from 0 to 1 (0 to 255 if one is above 2). `filter_3D` is folded into scales and opacities
// (Mip-Splatting, Yu 2024).

#include "formats/containers/opened_file.h"
#include "scene/model.h"

namespace binosplat {

/// Reads a model; Model::left_out counts invalid Gaussians. Decodes the file on all cores; shows progress if
/// it takes long. Throws Error naming the file and the fault's position for a broken
/// header, missing properties, a cut file, a point cloud without opacities, and a header without Gaussians.
Model load_ply(const OpenedFile& file);

}  // namespace binosplat
