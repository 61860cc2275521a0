#include "formats/gltf.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/log.h"
#include "formats/gltf_document.h"
#include "formats/perspective.h"
#include "formats/plausible.h"
#include "formats/spz.h"

namespace binosplat {

namespace {

constexpr const char* extension = "KHR_gaussian_splatting";
constexpr const char* packed_names[] = {"KHR_gaussian_splatting_compression_spz_2",
                                        "KHR_gaussian_splatting_compression_spz",
                                        "KHR_spz_gaussian_splats_compression", "KHR_spz_compression"};
constexpr std::uint64_t most = std::uint64_t{1} << 40;

/// A node's own transform: a matrix, or translation, rotation and scale.
glm::dmat4 transform_of(const JsonValue& node) {
  const auto numbers = [&](const char* key, std::size_t n, auto* to) {
    if (!node.has(key)) return;
    const JsonValue list = node.at(key).list_of(n);
    for (std::size_t i = 0; i < n; ++i) to[i] = list.at(i).number();
  };
  glm::dmat4 matrix(1.0);
  numbers("matrix", 16, glm::value_ptr(matrix));
  if (node.has("matrix")) return matrix;
  glm::dvec3 translation(0.0), scale(1.0);
  double xyzw[] = {0, 0, 0, 1};
  numbers("translation", 3, &translation.x);
  numbers("rotation", 4, xyzw);
  numbers("scale", 3, &scale.x);
  const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  matrix = glm::mat4_cast(glm::normalize(q));
  for (int c = 0; c < 3; ++c) matrix[c] *= scale[c];
  matrix[3] = glm::dvec4(translation, 1.0);
  return matrix;
}

/// Moves Gaussians by a node's transform in the world of the scene.
void move(const JsonValue& node, const glm::dmat4& matrix, Model& model) {
  const glm::dmat3 linear(matrix);
  const double determinant = glm::determinant(linear);
  if (!(determinant > 0.0 && std::isfinite(determinant)))
    node.fail_here("its transform mirrors, or flattens, what is in it");
  const double scale = std::cbrt(determinant);
  const glm::dmat3 rotation = linear / scale, square = glm::transpose(rotation) * rotation;
  double uneven = 0.0, turned = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      uneven = std::max(uneven, std::abs(square[i][j] - (i == j ? 1.0 : 0.0)));
      turned = std::max(turned, std::abs(rotation[i][j] - (i == j ? 1.0 : 0.0)));
    }
  }
  if (uneven > 1e-4) node.fail_here("it scales its axes differently, which Gaussians in it cannot follow");
  const bool turns = turned > 1e-6;
  if (turns && model.degree > 0) {
    node.fail_here(
        "it turns harmonics of degree {}, which is not supported; apply the rotation when exporting",
        model.degree);
  }
  // As exact as the matrix, whose axes may be uneven by the bound above, is not exact enough.
  const glm::dquat turn = glm::normalize(glm::quat_cast(rotation));
  for (std::size_t i = 0; i < model.count(); ++i) {
    model.position[i] = glm::dvec3(matrix * glm::dvec4(model.position[i], 1.0));
    model.scale[i] = glm::dvec3(model.scale[i]) * scale;
    for (const glm::vec3& v : {model.position[i], model.scale[i]}) {
      if (!glm::all(glm::lessThan(glm::abs(v), glm::vec3(std::numeric_limits<float>::infinity()))))
        node.fail_here("its transform, or one above it, moves Gaussians beyond the largest number");
    }
    if (!turns) continue;
    const glm::vec4& q = model.rotation[i];
    const glm::dquat turned_q = turn * glm::dquat(q.x, q.y, q.z, q.w);
    model.rotation[i] = glm::vec4(glm::dvec4(turned_q.w, turned_q.x, turned_q.y, turned_q.z));
  }
}

/// Adds the Gaussians of `part`; harmonics that one of the two does not have are 0.
void append(Model& all, Model&& part) {
  if (all.count() == 0) {
    const std::size_t left_out = all.left_out;
    all = std::move(part);
    all.left_out += left_out;
    return;
  }
  const int degree = std::max(all.degree, part.degree);
  for (Model* model : {&all, &part}) {
    if (model->degree == degree) continue;
    const std::size_t from = 3 * static_cast<std::size_t>(sh_count(model->degree));
    const std::size_t to = 3 * static_cast<std::size_t>(sh_count(degree));
    std::vector<float> wide(model->count() * to);
    for (std::size_t i = 0; i < model->count(); ++i) std::copy_n(&model->sh[i * from], from, &wide[i * to]);
    model->sh = std::move(wide);
    model->degree = degree;
  }
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(all.position, part.position);
  add(all.scale, part.scale);
  add(all.rotation, part.rotation);
  add(all.opacity, part.opacity);
  add(all.sh, part.sh);
  all.left_out += part.left_out;
  all.antialiased = all.antialiased || part.antialiased;
  if (all.perspective != part.perspective)
    log_warning("{}: its primitives are sorted or projected differently; all are drawn as the first is",
                all.name);
}

class GltfReader {
 public:
  GltfReader(const std::filesystem::path& path, std::span<const std::byte> bytes)
      : path_(path), document_(path, bytes) {}

  Model read() {
    const JsonValue& root = document_.root();
    const JsonValue nodes = root.at("nodes");
    std::vector<bool> seen(nodes.size());
    std::vector<std::pair<std::size_t, glm::dmat4>> open;
    const auto enter = [&](const JsonValue& list, const glm::dmat4& matrix) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        const std::size_t index = list.at(i).whole(most);
        if (index >= seen.size() || seen[index])
          list.at(i).fail_here("node {} is not there, or has two parents", index);
        seen[index] = true;
        open.emplace_back(index, matrix);
      }
    };
    const std::size_t scene = root.has("scene") ? root.at("scene").whole(most) : 0;
    enter(root.at("scenes").at(scene).at("nodes"), glm::dmat4(1.0));
    std::vector<Shown> shown;
    while (!open.empty()) {
      const auto [index, parent] = open.back();
      open.pop_back();
      const JsonValue node = nodes.at(index);
      const glm::dmat4 matrix = parent * transform_of(node);
      if (node.has("mesh")) {
        const std::size_t mesh = node.at("mesh").whole(most);
        shown.push_back({node, matrix, mesh});
        ++meshes_[mesh].left;
      }
      if (node.has("children")) enter(node.at("children"), matrix);
    }
    for (const Shown& node : shown) show(node);
    if (model_.count() == 0 && model_.left_out == 0) {
      fail("{} is a glTF scene without Gaussians ({}): {} meshes, {} points", path_.string(), extension,
           others_, points_);
    }
    model_.format = packed_ ? "glTF with spz" : "glTF";
    model_.axes = "LUF";
    return std::move(model_);
  }

 private:
  /// A node with a mesh.
  struct Shown {
    JsonValue node;
    glm::dmat4 matrix;  // in the world of the scene
    std::size_t mesh;
  };

  /// What any number of nodes may share is read once: nodes times primitives may be far more than the file
  /// has bytes.
  struct Mesh {
    std::size_t left = 0;  // nodes that are still to show it
    bool known = false;
    Model model;
    std::size_t others = 0, points = 0;  // primitives that are no Gaussians
  };

  void show(const Shown& shown) {
    Mesh& mesh = meshes_[shown.mesh];
    if (!mesh.known) read_mesh(shown, mesh);
    others_ += mesh.others;
    points_ += mesh.points;
    read_ += mesh.model.count() + mesh.model.left_out;
    check_copies(shown.node, read_);
    Model part = --mesh.left > 0 ? mesh.model : std::move(mesh.model);
    move(shown.node, shown.matrix, part);
    append(model_, std::move(part));
  }

  void read_mesh(const Shown& shown, Mesh& mesh) {
    const JsonValue primitives = document_.root().at("meshes").at(shown.mesh).at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const JsonValue primitive = primitives.at(i);
      const bool is_points = primitive.has("mode") && primitive.at("mode").whole(100) == 0;
      if (!primitive.has("extensions") || !primitive.at("extensions").has(extension)) {
        ++(is_points ? mesh.points : mesh.others);
        continue;
      }
      const JsonValue splatting = primitive.at("extensions").at(extension);
      check(splatting);
      const auto packed = packed_view(primitive, splatting);
      Model part = packed ? load_spz(fmt::format("{}: its spz data", path_.string()), document_.view(*packed))
                          : read_points(primitive.at("attributes"));
      part.perspective = read_perspective(splatting, {.order = ORDER_DISTANCE});  // glTF's default
      packed_ = packed_ || packed.has_value();
      check_copies(shown.node,
                   read_ + mesh.model.count() + mesh.model.left_out + part.count() + part.left_out);
      append(mesh.model, std::move(part));
    }
    mesh.known = true;
  }

  void check_copies(const JsonValue& node, std::size_t count) const {
    // Nodes may share a mesh, and meshes their numbers: a few bytes each, however many Gaussians they add.
    if (count > most_gaussians_in(document_.size())) {
      node.fail_here(
          "its mesh makes that {} Gaussians of a file of {} bytes, by showing the same ones many times{}",
          count, document_.size(), more_may_be_allowed);
    }
  }

  void check(const JsonValue& splatting) {
    if (splatting.has("kernel") && splatting.at("kernel").text() != "ellipse")
      splatting.at("kernel").fail_here("'{}' is not known; 'ellipse' is", splatting.at("kernel").text());
    if (splatting.has("colorSpace") && splatting.at("colorSpace").text().starts_with("lin")) {
      log_warning("{}: its colours are linear light, which is drawn as if it were display values: too dark",
                  path_.string());
    }
  }

  std::optional<std::size_t> packed_view(const JsonValue& primitive, const JsonValue& splatting) const {
    for (const char* name : packed_names) {
      for (const JsonValue& holder : {splatting, primitive}) {
        if (holder.has("extensions") && holder.at("extensions").has(name))
          return holder.at("extensions").at(name).at("bufferView").whole(most);
      }
    }
    return std::nullopt;
  }

  std::vector<float> attribute(const JsonValue& attributes, const std::string& name, std::size_t components,
                               std::size_t count) {
    return document_.read(attributes.at(name).whole(most), components, count);
  }

  Model read_points(const JsonValue& attributes) {
    const bool draft = !attributes.has(fmt::format("{}:ROTATION", extension)) && attributes.has("_ROTATION");
    const auto name = [&](const char* end) {
      return draft ? fmt::format("_{}", end) : fmt::format("{}:{}", extension, end);
    };
    const std::size_t n = document_.count(attributes.at("POSITION").whole(most));
    const std::vector<float> positions = attribute(attributes, "POSITION", 3, n);
    const std::vector<float> rotations = attribute(attributes, name("ROTATION"), 4, n);
    const std::vector<float> scales = attribute(attributes, name("SCALE"), 3, n);
    std::vector<float> opacities;
    std::vector<std::vector<float>> harmonics;
    Model model;
    if (draft) {
      const std::vector<float> colours = attribute(attributes, "COLOR_0", 4, n);
      std::vector<float>& dc = harmonics.emplace_back();
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
          dc.push_back(static_cast<float>((colours[4 * i + c] - 0.5) / sh_c0));
        opacities.push_back(colours[4 * i + 3]);
      }
    } else {
      opacities = attribute(attributes, name("OPACITY"), 1, n);
      const auto coefficient = [&](int degree, int m) {
        return fmt::format("{}:SH_DEGREE_{}_COEF_{}", extension, degree, m);
      };
      while (model.degree < 3 && attributes.has(coefficient(model.degree + 1, 0))) ++model.degree;
      for (int degree = 0; degree <= model.degree; ++degree) {
        for (int m = 0; m <= 2 * degree; ++m)
          harmonics.push_back(attribute(attributes, coefficient(degree, m), 3, n));
      }
    }
    model.resize(n);
    std::vector<std::uint8_t> kept(n);
    std::array<float, 3 * sh_count(3)> sh{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < harmonics.size(); ++k) std::copy_n(&harmonics[k][3 * i], 3, &sh[3 * k]);
      const float* q = &rotations[4 * i];
      kept[i] = place(model, i, glm::make_vec3(&positions[3 * i]), glm::make_vec3(&scales[3 * i]),
                      {q[3], q[0], q[1], q[2]}, opacities[i], sh.data());
    }
    keep_only(model, kept);
    return model;
  }

  const std::filesystem::path& path_;
  GltfDocument document_;
  Model model_;
  bool packed_ = false;
  std::map<std::size_t, Mesh> meshes_;
  std::size_t read_ = 0;                 // Gaussians, of all nodes
  std::size_t others_ = 0, points_ = 0;  // primitives that are no Gaussians
};

}  // namespace

bool is_gltf(const nlohmann::json& root) {
  return root.is_object() && root.contains("asset") && root.contains("buffers");
}

Model load_gltf(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return GltfReader(path, bytes).read();
}

}  // namespace binosplat
