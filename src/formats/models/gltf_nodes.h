#pragma once
// The nodes of a glTF's scene, with their meshes or cameras, and transforms.

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "formats/models/gltf_document.h"

namespace binosplat {

struct GltfNode {
  JsonValue node;
  glm::dmat4 matrix;   // from the node to the scene's world
  std::size_t number;  // of its mesh or camera
};

/// Returns a node's own transform: a matrix, or translation, rotation and scale. If the node has none,
/// returns the identity. Throws Error naming the key if it is invalid.
glm::dmat4 node_transform(const JsonValue& node);

/// Returns the nodes that have `key` ("mesh" or "camera") in the default scene, or in the first scene if
/// there is no default. Omits hidden nodes with a mesh and the nodes below them (KHR_node_visibility). Throws
/// Error naming the key for missing nodes, nodes with two parents, and invalid transforms.
std::vector<GltfNode> nodes_with(const char* key, const JsonValue& root);

/// The transforms of a mesh's copies within a node: those of EXT_mesh_gpu_instancing, or one identity.
class MeshInstances {
 public:
  /// Throws Error naming the key if the attributes differ in their number of elements.
  MeshInstances(GltfDocument& document, const JsonValue& node);

  /// Number of copies, checked against the file's size only if an attribute moves, rotates or scales copies.
  std::size_t count() const { return count_; }

  /// Throws Error naming the key for a rotation of length 0.
  glm::dmat4 at(std::size_t i) const;

 private:
  JsonValue attributes_;
  std::size_t count_ = 1;
  std::vector<float> translations_, rotations_, scales_;  // empty if they change nothing
};

}  // namespace binosplat
