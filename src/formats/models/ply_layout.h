#pragma once
// Finds a Gaussian's numbers among the properties of a ply file's vertices.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/models/ply_header.h"
#include "scene/model.h"

namespace binosplat {

/// The stored numbers of one Gaussian: position, log-scales, quaternion, opacity logit, the coefficients in
/// the order of Model::sh, and filter_3D if present.
using RawGaussian = std::array<float, 11 + 3 * sh_count(3) + 1>;

struct PlyLayout {
  /// The property that gives a number of a RawGaussian.
  struct Source {
    std::size_t property = 0;  // index among the properties of the vertices
    PlyType type = PlyType::float32;
    bool as_bits = false;  // a half declared as ushort; a text ply has its bits as an integer
  };

  const PlyElement* vertices = nullptr;
  int degree = 0;
  std::vector<Source> sources;  // one for each number of a RawGaussian
  bool wide = false;            // positions may be more precise than floats
  bool rgb = false;             // the first three coefficients are base colours
  bool rgb_bytes = false;       // base colours are 0 to 255 (Nerfstudio)
  bool filter_3d = false;       // the last number is Mip-Splatting's filter (world units)
  bool flat = false;            // Gaussians have two scales (2D Gaussian Splatting)
  bool lacks_degree_4 = false;  // the file has coefficients of degree 4, which the Model lacks
};

/// Takes what a file's comments say about its training (formats/training/trainer_keys.h); `source` names the
/// file.
void read_comments(const std::string& source, const PlyHeader& header, Training& training);

/// Whether a comment says that the Gaussians are flat (2D Gaussian Splatting), as splat-transform's.
bool says_flat(const PlyHeader& header);

/// Returns Model::up from the comment of nerfstudio and Brush, "Vertical axis: z" or three numbers; nothing
/// if there is none, or if it is Brush's y, which points down as in any ply.
std::optional<glm::dvec3> up_comment(const PlyHeader& header);

/// Finds the Gaussians' properties in a file by their names. If some are missing, throws Error and names
/// `path` and the file's apparent content. `header` must outlive the layout.
PlyLayout find_layout(const std::filesystem::path& path, const PlyHeader& header);

/// Decodes Gaussian `i` of a model; returns whether it is valid (scene/model.h, decode_raw).
bool decode(const PlyLayout& layout, Model& model, std::size_t i, const RawGaussian& raw);

}  // namespace binosplat
