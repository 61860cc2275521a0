// glTF's nodes: how they transform Gaussians, which of them are hidden, and how often a mesh is drawn.

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "support/compare_moved.h"
#include "support/gltf.h"
#include "support/models.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::apart;
using test::follows;
using test::Glb;
using test::load_gltf_bytes;
using test::refuses_gltf;

json list_of_matrix(const glm::dmat4& matrix) {
  return std::vector<double>(glm::value_ptr(matrix), glm::value_ptr(matrix) + 16);
}

struct GltfNodes : testing::Test {
  const Model model = test::random_model(11, 20, 3);
  Glb glb = test::gltf_of(model);

  Model load() const { return load_gltf_bytes(glb.bytes()); }
  /// Whether the Gaussians from `first` on are those of the model, transformed by `map`.
  bool follows_at(const Model& found, std::size_t first, const glm::dmat4& map,
                  const glm::dmat3& turn) const {
    return found.count() >= first + model.count() && follows(apart(model, found, map, turn, first));
  }
};

// Rotates by 90 degrees around z.
const glm::dmat3 quarter(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));

TEST_F(GltfNodes, RotateGaussians) {
  const double half = std::sqrt(0.5);
  glb.node()["rotation"] = {0, 0, half, half};
  glb.node()["translation"] = {1, 2, 3};
  glb.node()["scale"] = {2, 2, 2};
  glm::dmat4 map(2.0 * quarter);
  map[3] = glm::dvec4(1, 2, 3, 1);
  const Model found = load();
  EXPECT_EQ(found.axes.letters, "LUF");
  EXPECT_TRUE(follows_at(found, 0, map, quarter));
  // Injected faults: the inverse rotation, and no rotation.
  EXPECT_FALSE(follows_at(found, 0, map, glm::transpose(quarter)));
  EXPECT_FALSE(follows_at(found, 0, map, glm::dmat3(1.0)));
  glb.node() = {{"mesh", 0}, {"matrix", list_of_matrix(map)}};
  EXPECT_TRUE(follows_at(load(), 0, map, quarter));
}

TEST_F(GltfNodes, KeepPrecisionFarFromOrigin) {
  const glm::dvec3 far(4120000.25, 680000.5, 4800000.125);
  const auto worst = [&] {
    const Model found = load();
    double worst_of = 0.0;
    for (std::size_t i = 0; i < found.count(); ++i) {
      worst_of = std::max(worst_of, glm::distance(found.axes.origin + glm::dvec3(found.position[i]),
                                                  far + glm::dvec3(model.position[i % model.count()])));
    }
    return worst_of;
  };
  glb.node()["translation"] = {far.x, far.y, far.z};
  EXPECT_LT(worst(), 1e-5);
  glb.root["nodes"].push_back(glb.node());  // the same with several nodes
  glb.root["scenes"][0]["nodes"] = {0, 1};
  EXPECT_LT(worst(), 1e-5);
  glb.node()["translation"][2] = static_cast<float>(far.z);  // injected fault
  EXPECT_GT(worst(), 0.1);
}

// In the draft of August 2025, COLOR_0 holds the colour and the opacity, as for points.
TEST_F(GltfNodes, AcceptDraftWithColours) {
  Glb draft = test::gltf_of(test::random_model(11, 20, 0));
  std::vector<float> colours;
  for (int i = 0; i < 20; ++i) colours.insert(colours.end(), {0.25f, 0.5f, 1.0f, 0.75f});
  json& attributes = draft.attributes();
  attributes["COLOR_0"] = draft.add_accessor(test::packed<float>(colours), 20, "VEC4");
  const auto opacity = attributes[test::splatting + ":OPACITY"];
  const Model now = load_gltf_bytes(draft.bytes());
  EXPECT_NE(now.opacity[0], 0.75f) << "of the format as it is COLOR_0 is for others";
  attributes.erase(test::splatting + ":OPACITY");
  attributes.erase(test::splatting + ":SH_DEGREE_0_COEF_0");
  const Model found = load_gltf_bytes(draft.bytes());
  EXPECT_EQ(found.opacity, std::vector<float>(20, 0.75f));
  EXPECT_NEAR(0.5 + sh_c0 * found.sh[0], 0.25, 1e-6);
  EXPECT_EQ(found.scale, now.scale);
  attributes[test::splatting + ":OPACITY"] = opacity;  // neither the draft nor the final format
  EXPECT_TRUE(refuses_gltf(draft.bytes(), {"SH_DEGREE_0_COEF_0"}));
}

// A node scales first, then rotates, then translates. A parent's transform applies after its child's.
TEST_F(GltfNodes, ApplyTransformsInOrder) {
  const double half = std::sqrt(0.5);
  glb.node() = {{"children", {1}}, {"rotation", {0, 0, half, half}}, {"translation", {0, 0, 5}}};
  glb.root["nodes"].push_back({{"mesh", 0}, {"scale", {1, 2, 3}}, {"translation", {1, 0, 0}}});
  glm::dmat4 parent(quarter), child(1.0);
  parent[3] = glm::dvec4(0, 0, 5, 1);
  for (int c = 0; c < 3; ++c) child[c] *= c + 1.0;
  child[3] = glm::dvec4(1, 0, 0, 1);
  const Model found = load();
  EXPECT_TRUE(follows_at(found, 0, parent * child, quarter));
  EXPECT_FALSE(follows_at(found, 0, child * parent, quarter));  // injected fault
}

TEST_F(GltfNodes, ZeroScaleHidesContent) {
  glb.root["scenes"][0]["nodes"] = {0, 1};
  glb.root["nodes"].push_back({{"scale", {0, 0, 0}}, {"children", {2}}});
  glb.root["nodes"].push_back({{"mesh", 0}, {"translation", {1, 0, 0}}});
  EXPECT_EQ(load().count(), model.count());
  glb.root["scenes"][0]["nodes"] = {1};
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"without visible Gaussians"}));
  glb.root["nodes"][1]["scale"] = {1, 0, 1};  // flat, but visible
  EXPECT_EQ(load().count(), model.count());
}

TEST_F(GltfNodes, OnlySceneNodesAreShown) {
  glb.root["nodes"].push_back({{"mesh", 0}, {"translation", {9, 0, 0}}});  // in no scene
  EXPECT_EQ(load().count(), model.count());
  glb.root["scenes"].push_back({{"nodes", {1}}});
  EXPECT_EQ(load().position, model.position);  // the first scene if `scene` names none
  glb.root["scene"] = 1;
  EXPECT_EQ(load().position[3], model.position[3] + glm::vec3(9, 0, 0));
  glb.root["scenes"].push_back(json::object());
  glb.root["scene"] = 2;
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"without visible Gaussians"}));
  glb.root["scene"] = 9;
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'scenes'", "more than 9 values"}));
  glb.root.erase("scene");
  glb.root.erase("scenes");
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"'scenes' is missing"}));
}

TEST_F(GltfNodes, MustFormTree) {
  const auto with = [&](const json& nodes, const json& roots = {0}) {
    Glb other = glb;
    other.root["nodes"] = nodes;
    other.root["scenes"][0]["nodes"] = roots;
    return other.bytes();
  };
  const json none = json::object();
  const auto child = [](std::initializer_list<int> children) {
    return json{{"mesh", 0}, {"children", std::vector<int>(children)}};
  };
  json hidden = child({1, 1});
  hidden["extensions"]["KHR_node_visibility"]["visible"] = false;
  const std::vector<test::BrokenFile> refusals = {
      {with(json::array({child({0})})),
       {"key 'nodes[0].children[0]'", "node 0 is missing, or has two parents"}},
      {with({child({1}), child({0})}), {"key 'nodes[1].children[0]'", "two parents"}},
      {with({child({1}), none}, {0, 1}), {"node 1 is missing, or has two parents"}},
      {with({child({1}), none}, {0, 0}), {"node 0 is missing, or has two parents"}},
      {with({child({1}), none}, json::array({7})), {"node 7 is missing"}},
      // Hidden nodes are checked as well.
      {with({hidden, none}), {"node 1 is missing, or has two parents"}},
  };
  test::expect_no_models("a.glb", refusals);
}

TEST_F(GltfNodes, RejectInvalidTransforms) {
  glm::dmat4 projective(1.0);
  projective[2][3] = 0.5;
  const auto with = [&](const char* key, const json& value) {
    return glb.with(std::string("/nodes/0/") + key, value);
  };
  const std::vector<test::BrokenFile> refusals = {
      {with("rotation", {0, 0, 0, 0}), {"key 'nodes[0]'", "quaternion of length 0"}},
      {with("rotation", {0, 0, 1}), {"key 'nodes[0].rotation'", "expected 4 values, found 3"}},
      {with("scale", {1, 1, "x"}), {"key 'nodes[0].scale[2]'", "finite number"}},
      {with("matrix", list_of_matrix(projective)), {"key 'nodes[0].matrix'", "last row is not 0 0 0 1"}},
      {with("scale", {1e90, 1, 1}), {"key 'nodes[0]'", "beyond the range of floats"}},
      {with("mesh", 4), {"key 'meshes'", "more than 4 values"}},
      {with("skin", 0), {"key 'nodes[0].skin'", "joints"}},
  };
  test::expect_no_models("a.glb", refusals);
}

TEST_F(GltfNodes, RejectActiveMorphTargets) {
  glb.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  EXPECT_EQ(load().position, model.position);
  glb.root["meshes"][0]["weights"] = {0.5};
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'meshes[0].weights[0]'", "morph targets"}));
  glb.node()["weights"] = {0.0};  // overrides the weights of the mesh
  EXPECT_EQ(load().position, model.position);
}

// KHR_node_visibility: false hides a node and all below it.
TEST_F(GltfNodes, FollowVisibility) {
  glb.root["scenes"][0]["nodes"] = {0, 1};
  glb.root["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 7}}, {"children", {2}}});
  glb.root["nodes"].push_back({{"mesh", 0}, {"translation", {1, 0, 0}}});
  const std::size_t n = model.count();
  EXPECT_EQ(load().count(), 3 * n);
  const auto visible = [&](std::size_t node, const json& is) {
    glb.node(node)["extensions"]["KHR_node_visibility"] = {{"visible", is}};
  };
  visible(1, false);
  EXPECT_EQ(load().position, model.position);
  visible(2, true);  // no effect below a hidden node
  EXPECT_EQ(load().position, model.position);
  visible(1, true);
  EXPECT_EQ(load().count(), 3 * n);
  visible(2, false);
  EXPECT_EQ(load().count(), 2 * n);
  visible(2, nullptr);
  EXPECT_EQ(load().count(), 3 * n);  // visible by default
  visible(2, 0);
  EXPECT_TRUE(
      refuses_gltf(glb.bytes(), {"key 'nodes[2].extensions.KHR_node_visibility.visible'", "true or false"}));
  visible(2, false);
  visible(1, false);
  visible(0, false);
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"without visible Gaussians"}));
  glb.root["extensionsRequired"] = {"KHR_node_visibility"};
  visible(0, true);
  EXPECT_EQ(load().position, model.position);
}

struct GltfInstances : GltfNodes {
  json& attributes() { return glb.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]; }
  void add(const char* name, const char* type, const std::vector<float>& values) {
    const std::size_t n = values.size() / (type == std::string("VEC4") ? 4 : 3);
    attributes()[name] = glb.add_accessor(test::packed<float>(values), n, type);
  }
};

// EXT_mesh_gpu_instancing: the node's own transform applies after each instance's.
TEST_F(GltfInstances, ReplaceMesh) {
  glb.node()["scale"] = {2, 2, 2};
  add("TRANSLATION", "VEC3", {0, 0, 0, 1, 0, 0, 0, 2, 0});
  const Model found = load();
  ASSERT_EQ(found.count(), 3 * model.count());
  const glm::dvec3 at[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  for (std::size_t i = 0; i < 3; ++i) {
    glm::dmat4 map(glm::dmat3(2.0));
    map[3] = glm::dvec4(2.0 * at[i], 1.0);
    EXPECT_TRUE(follows_at(found, i * model.count(), map, glm::dmat3(1.0))) << i;
    map[3] = glm::dvec4(at[i], 1.0);  // injected fault: not scaled by the node
    EXPECT_EQ(follows_at(found, i * model.count(), map, glm::dmat3(1.0)), i == 0) << i;
  }
  // A child of the node is drawn once.
  glb.root["nodes"].push_back({{"mesh", 0}});
  glb.node()["children"] = {1};
  EXPECT_EQ(load().count(), 4 * model.count());
  glb.node()["extensions"]["KHR_node_visibility"]["visible"] = false;
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"visible Gaussians"}));
}

TEST_F(GltfInstances, ApplyRotationAndScale) {
  const float half = std::sqrt(0.5f);
  add("TRANSLATION", "VEC3", {1, 2, 3, 0, 0, 0});
  add("ROTATION", "VEC4", {0, 0, half, half, 0, 0, 0, 1});
  add("SCALE", "VEC3", {1, 2, 4, 0.5, 0.5, 0.5});
  const Model found = load();
  glm::dmat4 map(quarter);
  for (int c = 0; c < 3; ++c) map[c] *= std::exp2(c);
  map[3] = glm::dvec4(1, 2, 3, 1);
  EXPECT_TRUE(follows_at(found, 0, map, quarter));
  EXPECT_TRUE(follows_at(found, model.count(), glm::dmat4(glm::dmat3(0.5)), glm::dmat3(1.0)));
  EXPECT_FALSE(follows_at(found, 0, map, glm::dmat3(1.0)));  // injected fault
  // Quaternions of rounded integers are normalized.
  attributes().erase("TRANSLATION");
  attributes().erase("SCALE");
  attributes()["ROTATION"] =
      glb.add_accessor(test::packed<std::int8_t>(std::vector<int>{0, 0, 90, 90, 0, 0, 0, 127}), 2, "VEC4",
                       test::gltf_int8, {{"normalized", true}});
  EXPECT_TRUE(follows_at(load(), 0, glm::dmat4(quarter), quarter));
}

TEST_F(GltfInstances, AcceptAnyAttributes) {
  attributes()["_ID"] = glb.add_accessor(test::packed<float>(std::vector<float>{1, 2}), 2, "SCALAR");
  EXPECT_EQ(load().count(), 2 * model.count());  // two instances at the same place
  // An accessor without a view moves nothing.
  glb.root["accessors"].push_back({{"count", 2}, {"type", "VEC3"}, {"componentType", 5126}});
  attributes()["TRANSLATION"] = glb.root["accessors"].size() - 1;
  EXPECT_EQ(load().position[model.count() + 3], model.position[3]);
  add("SCALE", "VEC3", {1, 1, 1, 0, 0, 0});  // hides one instance
  EXPECT_EQ(load().count(), model.count());
  // On a node without a mesh, the extension has no effect.
  glb.root["nodes"].push_back({{"children", {0}}, {"extensions", glb.node()["extensions"]}});
  glb.root["scenes"][0]["nodes"] = {1};
  EXPECT_EQ(load().count(), model.count());
}

TEST_F(GltfInstances, AreValidated) {
  add("TRANSLATION", "VEC3", {0, 0, 0, 1, 0, 0});
  const json two = attributes()["TRANSLATION"];
  add("TRANSLATION", "VEC3", {INFINITY, 0, 0, 0, 0, 0});
  const json infinite = attributes()["TRANSLATION"];
  add("ROTATION", "VEC4", {0, 0, 0, 0, 0, 0, 0, 1});
  const json zero = attributes()["ROTATION"];
  add("SCALE", "VEC3", {1, 1, 1});
  const json one = attributes()["SCALE"];
  const auto with = [&](const json& value) {
    return glb.with("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", value);
  };
  const std::string key = "EXT_mesh_gpu_instancing.attributes";
  const std::vector<test::BrokenFile> refusals = {
      {with(json::object()), {key + "'", "expected TRANSLATION, ROTATION or SCALE"}},
      {with({{"TRANSLATION", two}, {"SCALE", one}}),
       {key + ".TRANSLATION'", "2 values", "another attribute"}},
      {with({{"ROTATION", zero}}), {key + "'", "quaternion of length 0"}},
      {with({{"ROTATION", two}}), {".type'", "expected VEC4, found VEC3"}},
      {with({{"TRANSLATION", infinite}}), {"key 'nodes[0]'", "beyond the range of floats"}},
      {with({{"TRANSLATION", 99}}), {"key 'accessors'", "more than 99 values"}},
      {with(nullptr), {key + "' is missing"}},
  };
  test::expect_no_models("a.glb", refusals);
}

// A few bytes can ask for any number of instances. Their number is checked before any is made.
TEST_F(GltfInstances, AreLimited) {
  const std::clock_t start = std::clock();
  for (const double count : {60000.0, 1e6, 1e9, 1e12}) {
    glb.root["accessors"].push_back({{"count", count}, {"type", "VEC3"}, {"componentType", 5126}});
    attributes() = {{"_ID", glb.root["accessors"].size() - 1}};
    EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'nodes[0]'", "repeat the same Gaussians"})) << count;
    attributes() = {{"TRANSLATION", glb.root["accessors"].size() - 1}};
    EXPECT_TRUE(refuses_gltf(glb.bytes(), {"`max_memory` MB allows more"})) << count;
  }
  EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);
}

// The limit also holds for nodes that share a mesh.
TEST_F(GltfNodes, SharedMeshesAreLimited) {
  glb = test::gltf_of(test::random_model(14, 1000, 0));
  const auto copies = [&](std::size_t n) {
    glb.root["nodes"] = json(n, json{{"mesh", 0}});
    json& nodes = glb.root["scenes"][0]["nodes"] = json::array();
    for (std::size_t i = 0; i < n; ++i) nodes.push_back(i);
    return glb.bytes();
  };
  EXPECT_EQ(load_gltf_bytes(copies(50)).count(), 50000u);
  EXPECT_TRUE(refuses_gltf(copies(2000), {"key 'nodes[", "repeat the same Gaussians"}));
}

TEST(GltfMeshes, AreSharedInLinearTime) {
  constexpr std::size_t n = 20000;
  json root = {{"asset", {{"version", "2.0"}}}, {"buffers", json::array()}, {"scenes", {{{"nodes", {}}}}}};
  for (std::size_t i = 0; i < n; ++i) root["scenes"][0]["nodes"].push_back(i);
  root["nodes"] = json(n, json{{"mesh", 0}});
  root["meshes"] = {{{"primitives", json(n, json::object())}}};
  const std::clock_t start = std::clock();
  EXPECT_ERROR(test::load_model_of(root.dump(), "a.gltf"), "a.gltf", "without visible Gaussians",
               "400000000 meshes, 0 points");
  // It takes 0.2 s. A visit of each primitive for each node took minutes.
  EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);
}

}  // namespace
}  // namespace binosplat
