#include "formats/models/ply_layout.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"
#include "formats/training/trainer_keys.h"
#include "formats/training/training_words.h"

namespace binosplat {

namespace {

/// Properties by which files of other kernels are recognised, and the names of these kernels.
constexpr std::pair<const char*, const char*> other_kernels[] = {
    {"beta", "Beta kernels (Deformable Beta Splatting)"},
    {"sb_params_0", "colours of spherical Betas (Deformable Beta Splatting)"},
    {"binding_0", "Gaussians in the triangles of a mesh that moves (GaussianAvatars)"},
    {"trbf_center", "Gaussians that come and go with time (Spacetime Gaussians)"},
};

/// Throws Error for files that are well-formed but not models of Gaussians.
void refuse_other_kinds(const std::filesystem::path& path, const PlyHeader& header) {
  const std::string name = path.string();
  const PlyElement* vertices = header.find("vertex");
  if (vertices == nullptr && header.find("codebook_centers") != nullptr)
    fail(
        "{} is a model of Reduced-3DGS with a codebook (codebook_centers), which is not read: name the plain "
        "point_cloud.ply that its trainer writes, too",
        name);
  if (vertices == nullptr)
    fail("{}: the ply header has no element 'vertex'; it is not a model of Gaussians", name);
  const auto has = [&](std::string_view property) { return vertices->find(property) != nullptr; };
  if (has("f_anchor_feat_0")) fail("{} holds the anchors of Scaffold-GS, not Gaussians", name);
  if (!has("opacity") && !has("scale_0") && !has("rot_0")) {
    const PlyElement* faces = header.find("face");
    if (faces != nullptr && faces->count > 0)
      fail("{} is a mesh of {} faces, not a model of Gaussians", name, faces->count);
    fail(
        "{} is a point cloud: its {} vertices have no opacity, scale_* and rot_*. Trained models lie in "
        "point_cloud/iteration_N/point_cloud.ply; input.ply has only the points from which training began",
        name, vertices->count);
  }
  for (const auto& [property, kind] : other_kernels) {
    if (has(property))
      fail("{} holds {} (property '{}'); only static Gaussians can be drawn", name, kind, property);
  }
  if (!has("f_dc_0") && !has("red")) {
    fail("{}: its {} vertices have no known colours: neither f_dc_0 to f_dc_2 nor red, green and blue", name,
         vertices->count);
  }
  if (vertices->count == 0) fail("{} holds no Gaussians: its header says 'element vertex 0'", name);
}

/// Returns the number of f_rest properties after checking that they run from 0 without a gap.
std::size_t count_rest(const std::filesystem::path& path, const PlyElement& vertices) {
  const std::size_t count = vertices.count_of("f_rest_");
  if (count != 0 && count != 9 && count != 24 && count != 45 && count != 72) {
    fail("{}: {} properties f_rest_*; expected 0, 9, 24 or 45 (degrees 0 to 3 of the spherical harmonics)",
         path, count);
  }
  return count;
}

/// Adds the source of a Gaussian's next number: the property `name`.
void add_source(const std::filesystem::path& path, PlyLayout& layout, const std::string& name) {
  const PlyProperty* property = layout.vertices->find(name);
  if (property == nullptr) fail("{}: element 'vertex' has no property '{}'", path, name);
  if (property->count_type)
    fail("{}: property '{}' of element 'vertex' is a list; expected one number", path, name);
  // ply has no type for halves. Exporters declare them as ushort, a type that Gaussians never have otherwise.
  const bool halves = property->type == PlyType::uint16;
  layout.sources.push_back({static_cast<std::size_t>(property - layout.vertices->properties.data()),
                            halves ? PlyType::float16 : property->type, halves});
}

/// If there are base colours instead of coefficients, sets layout.rgb and their type.
void find_rgb(const std::filesystem::path& path, PlyLayout& layout) {
  if (layout.vertices->find("f_dc_0") != nullptr) return;
  layout.rgb = layout.rgb_bytes = true;
  for (const char* name : {"red", "green", "blue"}) {
    const PlyProperty* property = layout.vertices->find(name);
    const PlyType type = property == nullptr ? PlyType::uint8 : property->type;
    if (type != PlyType::uint8) layout.rgb_bytes = false;
    if (type != PlyType::uint8 && size_of(type) < size_of(PlyType::float32))
      fail(
          "{}: property '{}' of element 'vertex' has an unsupported type for a colour: expected uchar or "
          "float",
          path, name);
  }
}

bool is_by_brush(const FlatValues& values) { return find_value(values, "exported from") == "brush"; }

}  // namespace

void read_comments(const std::string& source, const PlyHeader& header, Training& training) {
  constexpr const char* by = "a comment of the ply";
  training.perspective = read_perspective(header.comments);
  if (training.perspective != Perspective{}) training.perspective_by = by;
  const FlatValues values = comment_values(header.comments);
  follow(read_keys({"ply", is_by_brush(values) ? "Brush's ply" : ""}, values), by, source, training);
}

bool says_flat(const PlyHeader& header) {
  return std::ranges::any_of(header.comments, [](const std::string& comment) {
    return lowered(comment).find("splatrendermode: 2dgs") != std::string::npos;
  });
}

std::optional<glm::dvec3> up_comment(const PlyHeader& header) {
  constexpr std::string_view key = "vertical axis:";
  for (const std::string& line : header.comments) {
    const auto at = lowered(line).find(key);
    if (at == std::string::npos) continue;
    std::istringstream text(line.substr(at + key.size()));
    glm::dvec3 up;
    if (text >> up.x >> up.y >> up.z && glm::length(up) > 1e-3) {
      // Brush turns the file's axes by 180 degrees about z, and its numbers are the turned direction down.
      if (is_by_brush(comment_values(header.comments))) up.z = -up.z;
      return glm::normalize(up);
    }
    if (lowered(line).ends_with('z')) return glm::dvec3(0, 0, 1);
  }
  return std::nullopt;
}

PlyLayout find_layout(const std::filesystem::path& path, const PlyHeader& header) {
  refuse_other_kinds(path, header);
  PlyLayout layout;
  layout.vertices = header.find("vertex");
  const std::size_t in_file = count_rest(path, *layout.vertices) / 3;
  const std::size_t higher = std::min<std::size_t>(in_file, 15);
  layout.degree = static_cast<int>(std::lround(std::sqrt(static_cast<double>(higher + 1)))) - 1;

  const auto add = [&](const std::string& name) { add_source(path, layout, name); };
  const auto has = [&](const char* name) { return layout.vertices->find(name) != nullptr; };
  layout.flat = (has("scale_1") && !has("scale_2")) || says_flat(header);
  // Spheres have only scale_0. decode() replaces the third scale of flat Gaussians.
  const char* const second = has("scale_1") || has("scale_2") ? "scale_1" : "scale_0";
  for (const char* name : {"x", "y", "z", "scale_0", second, has("scale_2") ? "scale_2" : second, "rot_0",
                           "rot_1", "rot_2", "rot_3", "opacity"}) {
    add(name);
  }
  layout.wide = header.format == PlyFormat::ascii ||
                std::ranges::any_of(layout.sources.begin(), layout.sources.begin() + 3,
                                    [](const auto& source) { return source.type != PlyType::float32; });
  find_rgb(path, layout);
  for (const char* name :
       layout.rgb ? std::array{"red", "green", "blue"} : std::array{"f_dc_0", "f_dc_1", "f_dc_2"}) {
    add(name);
  }
  for (std::size_t k = 0; k < higher; ++k) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      add(fmt::format("f_rest_{}", channel * in_file + k));
  }
  layout.filter_3d = layout.vertices->find("filter_3D") != nullptr;
  if (layout.filter_3d) add("filter_3D");
  layout.lacks_degree_4 = in_file > higher;
  if (std::ranges::any_of(layout.sources, &PlyLayout::Source::as_bits))
    log_info("{}: its properties of type ushort are taken as halves (16-bit floats)", path);
  return layout;
}

bool decode(const PlyLayout& layout, Model& model, std::size_t i, const RawGaussian& raw) {
  glm::vec3 position(raw[0], raw[1], raw[2]);
  std::array<float, 3 * sh_count(3)> sh{};
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(layout.degree));
  std::copy_n(&raw[11], values, sh.begin());
  if (layout.rgb) {
    for (int c = 0; c < 3; ++c) sh[c] = sh_of_colour(sh[c] / (layout.rgb_bytes ? 255.0 : 1.0));
  }
  const bool good = decode_raw(model, i,
                               {position, glm::vec3(raw[3], raw[4], layout.flat ? -INFINITY : raw[5]),
                                glm::vec4(raw[6], raw[7], raw[8], raw[9]), raw[10], sh.data()});
  if (!layout.filter_3d) return good;

  // Mip-Splatting widens the Gaussian by convolution with one of standard deviation f, and keeps its mass.
  const double f = raw[11 + values];
  double mass = 1.0;
  for (int c = 0; c < 3; ++c) {
    const double scale = model.scale[i][c];
    const double wider = std::sqrt(scale * scale + f * f);
    if (wider > 0.0) mass *= scale / wider;
    model.scale[i][c] = static_cast<float>(wider);
  }
  model.opacity[i] *= static_cast<float>(mass);
  const glm::vec3& scale = model.scale[i];
  return good && std::isfinite(f) && std::isfinite(scale.x) && std::isfinite(scale.y) &&
         std::isfinite(scale.z);
}

}  // namespace binosplat
