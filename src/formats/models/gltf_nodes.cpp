#include "formats/models/gltf_nodes.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <string_view>

namespace binosplat {

namespace {

/// Composes translation, rotation (x y z w) and scale in glTF's order: scale first.
glm::dmat4 composed(const JsonValue& where, const glm::dvec3& translation, const glm::dvec4& rotation,
                    const glm::dvec3& scale) {
  if (!(glm::length(rotation) > 0.0)) where.fail_here("a rotation is a quaternion of length 0");
  const glm::dvec4 q = glm::normalize(rotation);
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  for (int c = 0; c < 3; ++c) matrix[c] *= scale[c];
  matrix[3] = glm::dvec4(translation, 1.0);
  return matrix;
}

bool is_visible(const JsonValue& node) {
  const auto visibility = extension_of(node, "KHR_node_visibility");
  if (!visibility || !visibility->has("visible")) return true;
  const JsonValue visible = visibility->at("visible");
  if (!visible.value().is_boolean()) visible.fail_here("expected true or false");
  return visible.value().get<bool>();
}

}  // namespace

glm::dmat4 node_transform(const JsonValue& node) {
  const auto numbers = [&](const char* key, std::size_t n, double* to) {
    if (node.has(key)) std::ranges::copy(node.at(key).numbers(n), to);
  };
  if (node.has("matrix")) {
    glm::dmat4 matrix(1.0);
    numbers("matrix", 16, glm::value_ptr(matrix));
    if (glm::transpose(matrix)[3] != glm::dvec4(0, 0, 0, 1))
      node.at("matrix").fail_here("its last row is not 0 0 0 1, so it is not a node's transform");
    return matrix;
  }
  glm::dvec3 translation(0.0), scale(1.0);
  glm::dvec4 rotation(0, 0, 0, 1);
  numbers("translation", 3, &translation.x);
  numbers("rotation", 4, &rotation.x);
  numbers("scale", 3, &scale.x);
  return composed(node, translation, rotation, scale);
}

std::vector<GltfNode> nodes_with(const char* key, const JsonValue& root) {
  struct Open {
    std::size_t node;
    glm::dmat4 parent;
    bool visible;
  };
  std::vector<bool> seen(root.has("nodes") ? root.at("nodes").size() : 0);
  std::vector<Open> open;
  const auto enter = [&](const JsonValue& list, const glm::dmat4& matrix, bool visible) {
    for (const JsonValue& one : list.items()) {
      const std::size_t index = one.whole(max_gltf_number);
      if (index >= seen.size() || seen[index]) one.fail_here("node {} is missing, or has two parents", index);
      seen[index] = true;
      open.push_back({index, matrix, visible});
    }
  };
  const std::size_t number = root.has("scene") ? root.at("scene").whole(max_gltf_number) : 0;
  const JsonValue scene = root.at("scenes").at(number);
  if (scene.has("nodes")) enter(scene.at("nodes"), glm::dmat4(1.0), true);
  std::vector<GltfNode> shown;
  while (!open.empty()) {
    const Open next = open.back();
    open.pop_back();
    const JsonValue node = root.at("nodes").at(next.node);
    const glm::dmat4 matrix = next.parent * node_transform(node);
    const bool visible = next.visible && (std::string_view(key) == "camera" || is_visible(node));
    if (visible && node.has(key)) shown.push_back({node, matrix, node.at(key).whole(max_gltf_number)});
    if (node.has("children")) enter(node.at("children"), matrix, visible);
  }
  return shown;
}

MeshInstances::MeshInstances(GltfDocument& document, const JsonValue& node) : attributes_(node) {
  const auto instancing = extension_of(node, "EXT_mesh_gpu_instancing");
  if (!instancing) return;
  attributes_ = instancing->at("attributes");
  std::optional<std::size_t> count;
  for (const auto& [name, value] : attributes_.value().items()) {
    const JsonValue accessor = attributes_.at(name);
    const std::size_t of_this = document.count(accessor.whole(max_gltf_number));
    if (count && of_this != *count)
      accessor.fail_here("it has {} values, and another attribute of these copies {}", of_this, *count);
    count = of_this;
  }
  if (!count) attributes_.fail_here("expected TRANSLATION, ROTATION or SCALE, which count the copies");
  count_ = *count;
  const auto read = [&](const char* name, std::size_t components) {
    if (!attributes_.has(name)) return std::vector<float>();
    return document.read(attributes_.at(name).whole(max_gltf_number), components, count_,
                         "the other attributes");
  };
  translations_ = read("TRANSLATION", 3);
  rotations_ = read("ROTATION", 4);
  scales_ = read("SCALE", 3);
}

glm::dmat4 MeshInstances::at(std::size_t i) const {
  glm::dvec3 translation(0.0), scale(1.0);
  glm::dvec4 rotation(0, 0, 0, 1);
  if (!translations_.empty()) translation = glm::make_vec3(&translations_[3 * i]);
  if (!rotations_.empty()) rotation = glm::make_vec4(&rotations_[4 * i]);
  if (!scales_.empty()) scale = glm::make_vec3(&scales_[3 * i]);
  return composed(attributes_, translation, rotation, scale);
}

}  // namespace binosplat
