#pragma once
// Which properties of a ply file's vertices make a Gaussian, and how.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/ply_header.h"
#include "scene/model.h"

namespace binosplat {

/// The numbers of one Gaussian as stored: position, log-scales, quaternion, opacity logit, then the
/// coefficients in the order of Model::sh, then filter_3D where there is one.
using RawGaussian = std::array<float, 11 + 3 * sh_count(3) + 1>;

struct PlyLayout {
  /// Where a number of a RawGaussian comes from.
  struct Source {
    std::size_t property = 0;  // of the vertices
    PlyType type = PlyType::float32;
    bool as_bits = false;  // declared as ushort: in text, too, a half is the whole number of its bits
  };

  const PlyElement* vertices = nullptr;
  int degree = 0;
  std::vector<Source> sources;  // for each number of a RawGaussian
  bool wide = false;            // positions may be finer than floats (from zero)
  bool rgb = false;             // the first three coefficients are base colours
  bool rgb_bytes = false;       // of 0 to 255 (Nerfstudio)
  bool filter_3d = false;       // the last number is Mip-Splatting's filter (world units)
  bool antialiased = false;
  std::string antialiased_by;   // as Model has it
  bool flat = false;            // a Gaussian has two scales (2D Gaussian Splatting)
  bool lacks_degree_4 = false;  // the file has more coefficients than are read
};

/// The low-pass that Mip-Splatting trains with, px^2; a ply with filter_3D is drawn with it.
constexpr double mip_splatting_kernel_px2 = 0.1;

/// Whether a model was trained with anti-aliasing, by the last comment that says so or not (Brush's and
/// Postshot's); nothing where none does.
std::optional<bool> said_antialiased(const PlyHeader& header);

/// What says so where a comment does, for people.
constexpr const char* by_comment = "a comment of the ply";

/// Finds the Gaussians in a file by the names of properties. Throws Error naming `path` if there are none or
/// something is missing, saying what the file looks like instead. `header` must outlive the layout.
PlyLayout find_layout(const std::filesystem::path& path, const PlyHeader& header);

/// Decodes one Gaussian into slot `i` of a model; returns whether it may be kept (scene/model.h, decode_raw).
bool decode(const PlyLayout& layout, Model& model, std::size_t i, const RawGaussian& raw);

}  // namespace binosplat
