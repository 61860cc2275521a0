#pragma once
// The nodes of a glTF's scene: which meshes they show, and where.

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "formats/gltf_document.h"

namespace binosplat {

/// A node that shows a mesh.
struct GltfNode {
  JsonValue node;
  glm::dmat4 matrix;  // in the world of the scene
  std::size_t mesh;
};

/// Those of the scene that is shown, the first where none is named, without those that are hidden
/// (KHR_node_visibility), themselves or by one above them. Throws Error naming the key for nodes that are not
/// there or have two parents, and for transforms that are none.
std::vector<GltfNode> nodes_shown(const JsonValue& root);

/// Where a node has its mesh, in the node: where EXT_mesh_gpu_instancing says, or once, where the node is.
class MeshPlaces {
 public:
  /// Throws Error naming the key for attributes that differ in number.
  MeshPlaces(GltfDocument& document, const JsonValue& node);

  /// Not checked against the bytes where no attribute moves anything.
  std::size_t count() const { return count_; }

  /// Throws Error naming the key for a rotation of length 0.
  glm::dmat4 at(std::size_t i) const;

 private:
  JsonValue attributes_;
  std::size_t count_ = 1;
  std::vector<float> translations_, rotations_, scales_;  // empty where they change nothing
};

}  // namespace binosplat
