#include "formats/models/gltf.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <optional>
#include <utility>

#include "base/log.h"
#include "base/numbers.h"
#include "base/text.h"
#include "formats/cameras/distortion.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/nerfstudio.h"
#include "formats/cameras/transforms.h"
#include "formats/containers/size_limits.h"
#include "formats/models/append_model.h"
#include "formats/models/gltf_document.h"
#include "formats/models/gltf_nodes.h"
#include "formats/models/spz.h"
#include "formats/training/training_words.h"
#include "scene/axes.h"
#include "scene/transform.h"

namespace binosplat {

namespace {

constexpr const char* splatting_extension = "KHR_gaussian_splatting";
constexpr const char* packed_names[] = {"KHR_gaussian_splatting_compression_spz_2",
                                        "KHR_gaussian_splatting_compression_spz",
                                        "KHR_spz_gaussian_splats_compression", "KHR_spz_compression"};

/// Extensions that this reader implements; a file that requires any other must not be drawn.
constexpr const char* also_known[] = {splatting_extension, "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                                      "KHR_mesh_quantization"};

bool is_known(const std::string& name) {
  const auto is = [&](const char* known) { return name == known; };
  return std::ranges::any_of(also_known, is) || std::ranges::any_of(packed_names, is);
}

/// Parses two integers separated by a point, as in "2.0".
std::pair<unsigned, unsigned> version_in(const JsonValue& value) {
  const std::string text = value.text();
  const auto numbers = two_numbers(text, '.');
  if (!numbers) value.fail_here("expected a version as in 2.0, found '{}'", text);
  return *numbers;
}

void check_asset(const JsonValue& root) {
  const JsonValue asset = root.at("asset");
  const bool has_min_version = asset.has("minVersion");
  const JsonValue version = has_min_version ? asset.at("minVersion") : asset.at("version");
  // A reader of 2.0 can read all of 2.x, unless the file has a minVersion.
  const auto [major, minor] = version_in(version);
  if (major != 2 || (has_min_version && minor > 0))
    version.fail_here("unknown glTF version {}.{}: expected 2.0", major, minor);
  if (!root.has("extensionsRequired")) return;
  for (const JsonValue& name : root.at("extensionsRequired").items()) {
    if (!is_known(name.text()))
      name.fail_here("the file needs the unknown extension '{}'; export it without", name.text());
  }
}

/// Returns an unknown extension, which may store numbers in place of attributes.
std::string unknown_extension(const JsonValue& holder) {
  if (!holder.has("extensions")) return {};
  const JsonValue extensions = holder.at("extensions");
  for (const auto& [name, value] : extensions.value().items())
    if (!is_known(name)) return name;
  return {};
}

std::optional<std::size_t> packed_view(const JsonValue& primitive, const JsonValue& splatting) {
  for (const char* name : packed_names) {
    for (const JsonValue& holder : {splatting, primitive}) {
      if (const auto extension = extension_of(holder, name))
        return extension->at("bufferView").whole(max_gltf_number);
    }
  }
  return std::nullopt;
}

/// Whether splat-transform before 2.7.0 wrote the file, which stored logarithms of scales.
bool stores_logarithms(const JsonValue& root) {
  const JsonValue asset = root.at("asset");
  const std::string generator = asset.has("generator") ? asset.at("generator").text() : "";
  std::string_view version = generator;
  constexpr std::string_view name = "splat-transform ";
  if (!version.starts_with(name)) return false;
  version.remove_prefix(name.size());
  if (version.starts_with('v')) version.remove_prefix(1);
  const auto numbers = two_numbers(version.substr(0, version.rfind('.')), '.');
  return numbers && *numbers < std::pair(2u, 7u);
}

/// Whether colours are linear light. Drafts of the extension have other words for the same.
bool is_linear(const JsonValue& splatting) {
  if (!splatting.has("colorSpace")) return false;
  const std::string word = splatting.at("colorSpace").text(), small = lowered(word);
  if (word == linear_word || small == "bt.709-linear") return true;
  if (word != "srgb_rec709_display" && small != "bt.709" && small != "bt.709-srgb")
    log_warning("{}: colours of the unknown colorSpace '{}' are drawn as sRGB", splatting.source(), word);
  return false;
}

/// Converts logarithms, which drafts of the extension store, to scales. Only logarithms can be below 0.
void undo_logarithms(const std::filesystem::path& path, bool known, std::vector<float>& scales) {
  constexpr std::ptrdiff_t damage_divisor = 100;  // one scale in this many may be damaged
  const auto below = std::ranges::count_if(scales, [](float s) { return s < 0.0f; });
  if (!known && below <= std::ssize(scales) / damage_divisor) return;
  if (!known)
    log_warning("{}: scales are below 0, so all are read as logarithms, as in drafts of the extension", path);
  for (float& s : scales) s = std::exp(s);
}

void split_colours(const std::vector<float>& colours, std::vector<float>& base,
                   std::vector<float>& opacities) {
  for (std::size_t k = 0; k < colours.size(); k += 4) {
    for (std::size_t c = 0; c < 3; ++c) base.push_back(sh_of_colour(colours[k + c]));
    opacities.push_back(colours[k + 3]);
  }
}

class GltfReader {
 public:
  explicit GltfReader(const OpenedFile& file) : path_(file.path), document_(file) {}

  Model read() {
    check_asset(document_.root());
    const std::vector<GltfNode> nodes = nodes_with("mesh", document_.root());
    for (const GltfNode& node : nodes) ++meshes_[node.number].left;
    for (const GltfNode& node : nodes) show(node);
    if (model_.count() == 0 && model_.left_out == 0) {
      fail("{} is a glTF scene without visible Gaussians ({}): {} meshes, {} points", path_,
           splatting_extension, others_, points_);
    }
    if (others_ + points_ > 0) {
      log_warning("{}: only Gaussians are drawn; {} meshes and {} sets of points are ignored", path_, others_,
                  points_);
    }
    model_.format = packed_ ? "glTF with spz" : "glTF";
    model_.axes.letters = "LUF";
    set_far_positions(model_, places_);
    return std::move(model_);
  }

 private:
  /// A mesh is read once for all of its nodes, since nodes times primitives may far exceed the file's size.
  struct Mesh {
    std::size_t left = 0;  // number of nodes that have not shown the mesh yet
    bool known = false;
    bool morphs = false;  // weights move the Gaussians
    Model model;
    std::size_t others = 0, points = 0;  // primitives that are no Gaussians
  };

  void show(const GltfNode& shown) {
    Mesh& mesh = meshes_[shown.number];
    if (!mesh.known) read_mesh(shown, mesh);
    others_ += mesh.others;
    points_ += mesh.points;
    const std::size_t of_one = mesh.model.count() + mesh.model.left_out;
    --mesh.left;
    if (of_one == 0) return;
    check_still(shown, mesh);
    const MeshInstances places(document_, shown.node);
    check_copies(shown.node, of_one, places.count());
    read_ += of_one * places.count();
    for (std::size_t i = 0; i < places.count(); ++i) {
      const glm::dmat4 matrix = shown.matrix * places.at(i);
      // A scale of 0 hides a node.
      if (glm::dmat3(matrix) == glm::dmat3(0.0)) continue;
      const bool is_last = mesh.left == 0 && i + 1 == places.count();
      Model part = is_last ? std::move(mesh.model) : mesh.model;
      if (!transform(part, matrix, places_))
        shown.node.fail_here("its transform, or a parent's, moves Gaussians beyond the range of floats");
      append_model(model_, std::move(part));
    }
  }

  /// Throws Error if anything except the node's transform moves the Gaussians of a node.
  void check_still(const GltfNode& shown, const Mesh& mesh) const {
    if (shown.node.has("skin"))
      shown.node.at("skin").fail_here("it moves Gaussians by joints, which cannot be drawn");
    const JsonValue of_mesh = document_.root().at("meshes").at(shown.number);
    const JsonValue& holder = shown.node.has("weights") ? shown.node : of_mesh;
    if (!mesh.morphs || !holder.has("weights")) return;
    for (const JsonValue& weight : holder.at("weights").items())
      if (weight.number() != 0.0)
        weight.fail_here("it moves Gaussians by morph targets, which cannot be drawn");
  }

  void read_mesh(const GltfNode& shown, Mesh& mesh) {
    const JsonValue of_mesh = document_.root().at("meshes").at(shown.number);
    for (const JsonValue& primitive : of_mesh.at("primitives").items()) {
      const bool is_points = primitive.has("mode") && primitive.at("mode").whole(100) == 0;
      const auto extension = extension_of(primitive, splatting_extension);
      if (!extension) {
        ++(is_points ? mesh.points : mesh.others);
        continue;
      }
      const JsonValue& splatting = *extension;
      check(primitive, splatting);
      mesh.morphs = mesh.morphs || primitive.has("targets");
      const auto packed = packed_view(primitive, splatting);
      Model part = packed ? load_spz(fmt::format("{}: its spz data", path_), document_.view(*packed))
                          : read_points(primitive.at("attributes"));
      if (packed && !part.format.ends_with(axes_assumed)) bring_into_axes(part, "LUF");
      part.perspective = read_perspective(splatting, {.order = Order::distance});  // glTF's default
      part.linear = is_linear(splatting);
      part.perspective_by = part.linear_by = path_.string();
      packed_ = packed_ || packed.has_value();
      check_copies(shown.node, mesh.model.count() + mesh.model.left_out + part.count() + part.left_out, 1);
      append_model(mesh.model, std::move(part));
    }
    mesh.known = true;
  }

  /// Checks the total number of Gaussians before memory is allocated for the copies.
  void check_copies(const JsonValue& node, std::size_t count, std::size_t copies) const {
    // Nodes can share a mesh, and meshes can share numbers, so a few bytes can add any number of Gaussians.
    const std::size_t max_gaussians = max_gaussians_in(document_.size());
    if (count == 0) return;
    if (copies > (max_gaussians - std::min(max_gaussians, read_)) / count) {
      node.fail_here(
          "with this node the scene has more than {} Gaussians, too many for a file of {} bytes: nodes "
          "repeat the same Gaussians{}",
          max_gaussians, document_.size(), more_may_be_allowed);
    }
  }

  void check(const JsonValue& primitive, const JsonValue& splatting) {
    if (primitive.has("indices"))
      primitive.at("indices").fail_here("Gaussians with indices cannot be read; export them without");
    unknown_ = unknown_extension(splatting);
    if (unknown_.empty()) {
      unknown_ = unknown_extension(primitive);
    } else {
      log_warning("{}: its Gaussians are drawn without the unknown extension '{}'", path_, unknown_);
    }
    if (splatting.has("kernel") && splatting.at("kernel").text() != "ellipse")
      splatting.at("kernel").fail_here("unknown '{}': expected 'ellipse'", splatting.at("kernel").text());
  }

  std::vector<float> attribute(const JsonValue& attributes, const std::string& name, std::size_t components,
                               std::size_t count) {
    const std::size_t accessor = attributes.at(name).whole(max_gltf_number);
    if (!unknown_.empty() && !document_.has_numbers(accessor)) {
      attributes.at(name).fail_here("its numbers are in the unknown extension '{}'; export it without",
                                    unknown_);
    }
    return document_.read(accessor, components, count);
  }

  Model read_points(const JsonValue& attributes) {
    const bool draft =
        !attributes.has(fmt::format("{}:ROTATION", splatting_extension)) && attributes.has("_ROTATION");
    const auto name = [&](const std::string& end) {
      return draft ? fmt::format("_{}", end) : fmt::format("{}:{}", splatting_extension, end);
    };
    const std::size_t n = document_.count(attributes.at("POSITION").whole(max_gltf_number));
    const std::vector<float> positions = attribute(attributes, "POSITION", 3, n);
    const std::vector<float> rotations = attribute(attributes, name("ROTATION"), 4, n);
    std::vector<float> scales = attribute(attributes, name("SCALE"), 3, n);
    undo_logarithms(path_, stores_logarithms(document_.root()), scales);
    std::vector<float> opacities;
    std::vector<std::vector<float>> harmonics;
    Model model;
    const auto coefficient = [&](int degree, int m) {
      return name(fmt::format("SH_DEGREE_{}_COEF_{}", degree, m));
    };
    // Drafts store base colour and opacity in COLOR_0, as points do.
    if (!attributes.has(name("OPACITY")) && !attributes.has(coefficient(0, 0)) && attributes.has("COLOR_0")) {
      const std::vector<float> colours = attribute(attributes, "COLOR_0", 4, n);
      split_colours(colours, harmonics.emplace_back(), opacities);
    } else {
      opacities = attribute(attributes, name("OPACITY"), 1, n);
      harmonics.push_back(attribute(attributes, coefficient(0, 0), 3, n));
    }
    check_opacities(path_.string(), opacities);
    // Up to the highest degree present, all coefficients must exist.
    for (int degree = 1; degree <= 3; ++degree) {
      for (int m = 0; m <= 2 * degree; ++m)
        if (attributes.has(coefficient(degree, m))) model.degree = degree;
    }
    for (int degree = 1; degree <= model.degree; ++degree) {
      for (int m = 0; m <= 2 * degree; ++m)
        harmonics.push_back(attribute(attributes, coefficient(degree, m), 3, n));
    }
    model.lacks_degree_4 = attributes.has(coefficient(4, 0));  // the format does not define degree 4
    decode_all(model, n, [&](std::size_t i) {
      std::array<float, 3 * sh_count(3)> sh{};
      for (std::size_t k = 0; k < harmonics.size(); ++k) std::copy_n(&harmonics[k][3 * i], 3, &sh[3 * k]);
      const float* q = &rotations[4 * i];
      return place(model, i,
                   {glm::make_vec3(&positions[3 * i]),
                    glm::make_vec3(&scales[3 * i]),
                    {q[3], q[0], q[1], q[2]},
                    opacities[i],
                    sh.data()});
    });
    return model;
  }

  const std::filesystem::path& path_;
  GltfDocument document_;
  Model model_;
  std::vector<glm::dvec3> places_;  // positions of the model's Gaussians in the scene
  bool packed_ = false;
  std::string unknown_;  // an unknown extension of the current primitive
  std::map<std::size_t, Mesh> meshes_;
  std::size_t read_ = 0;                 // Gaussians of all nodes so far
  std::size_t others_ = 0, points_ = 0;  // primitives that are no Gaussians
};

}  // namespace

bool is_gltf(const nlohmann::json& root) {
  // Other files of 3D Tiles also have the key `asset`.
  return root.is_object() && root.contains("asset") &&
         (root.contains("buffers") || root.contains("meshes") || root.contains("cameras"));
}

Model load_gltf(const OpenedFile& file) { return GltfReader(file).read(); }

std::vector<std::filesystem::path> files_of_gltf(const OpenedFile& file) {
  return GltfDocument(file).files();
}

std::vector<Camera> load_gltf_cameras(const OpenedFile& file) {
  const std::filesystem::path& path = file.path;
  const GltfDocument document(file);
  const glm::dmat3 to_world = world_from_axes("LUF");
  std::vector<Camera> cameras;
  LensReport lens_report(path.string());
  for (const GltfNode& shown : nodes_with("camera", document.root())) {
    const JsonValue lens = document.root().at("cameras").at(shown.number);
    Camera camera;
    camera.name =
        shown.node.has("name") ? shown.node.at("name").text() : fmt::format("camera_{}", shown.number);
    if (lens.at("type").text() == "orthographic") {
      lens_report.add_skipped(
          fmt::format("{}: camera '{}' is orthographic, and cannot be drawn", path, camera.name));
      continue;
    }
    const JsonValue perspective = lens.at("perspective"), fov = perspective.at("yfov");
    if (!(fov.above_zero() < glm::pi<double>())) fov.fail_here("expected radians below pi");
    const auto aspect = perspective.find("aspectRatio");
    camera.height = pose_height;
    camera.width = pose_width;
    if (aspect)
      camera.width = static_cast<int>(std::lround(std::min(pose_height * aspect->above_zero(), 1e9)));
    set_vertical_fov(camera, glm::degrees(fov.number()));
    check_lens(path.string(), camera);
    glm::dmat3 axes(shown.matrix);
    const std::string fault = make_rotation(path.string(), axes);
    if (!fault.empty()) shown.node.fail_here("its camera's axes: {}", fault);
    place_as_opengl(camera, {to_world * axes, to_world * glm::dvec3(shown.matrix[3])});
    cameras.push_back(camera);
    lens_report.add(false);
  }
  lens_report.report();
  if (cameras.empty()) fail("{} is a glTF scene without cameras", path);
  std::ranges::reverse(cameras);  // nodes_with() returns the last first
  return cameras;
}

}  // namespace binosplat
