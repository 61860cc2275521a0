// glTF's accessors, one rule per test: the position of their data, the meaning of their numbers, and invalid
// ones. real_files_test tests decoded files.

#include <gtest/gtest.h>

#include <cmath>

#include "support/gltf.h"
#include "support/models.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::Glb;
using test::load_gltf_bytes;
using test::packed;
using test::refuses_gltf;

struct GltfAccessors : testing::Test {
  const Model model = test::random_model(12, 10, 1);
  Glb glb = test::gltf_of(model);

  Model load() const { return load_gltf_bytes(glb.bytes()); }
  testing::AssertionResult refuses(const std::vector<std::string>& parts) const {
    return refuses_gltf(glb.bytes(), parts);
  }
  /// Replaces the data of an attribute, in a new buffer view.
  void replace(const std::string& name, const std::string& data, test::GltfType type, bool normalized) {
    json& accessor = glb.accessor(name);
    accessor["bufferView"] = glb.add_view(data);
    accessor["componentType"] = type;
    accessor["normalized"] = normalized;
  }
  template <typename T>
  void replace(const std::string& name, const std::vector<double>& values, test::GltfType type,
               bool normalized = true) {
    replace(name, packed<T>(values), type, normalized);
  }
};

TEST_F(GltfAccessors, WithoutViewAreZero) {
  for (int m = 0; m < 3; ++m) glb.accessor(fmt::format("SH_DEGREE_1_COEF_{}", m)).erase("bufferView");
  const Model found = load();
  ASSERT_EQ(found.degree, 1);
  for (std::size_t i = 0; i < model.count(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(found.sh[12 * i + k], k < 3 ? model.sh[12 * i + k] : 0.0f);
  }
  glb.accessor("POSITION")["bufferView"] = nullptr;  // the same as no view
  for (const glm::vec3& p : load().position) EXPECT_EQ(p, glm::vec3(0.0f));
}

// Accessors without a view cannot make a small file take much memory.
TEST_F(GltfAccessors, WithoutViewAreLimited) {
  for (json& accessor : glb.root["accessors"]) {
    accessor.erase("bufferView");
    accessor["count"] = 1e12;
  }
  EXPECT_TRUE(
      refuses({"key 'accessors[", ".count'", "1000000000000 elements without a bufferView", "`max_memory`"}));
}

// Data that only an extension describes is not read as zeros.
TEST_F(GltfAccessors, WithoutViewMayUseExtension) {
  json& primitive = glb.root["meshes"][0]["primitives"][0];
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  EXPECT_EQ(load().position, model.position);  // All data is there without the extension.
  glb.accessor("POSITION").erase("bufferView");
  EXPECT_TRUE(refuses({"attributes.POSITION'", "in the unknown extension 'KHR_draco_mesh_compression'"}));
  primitive["extensions"].erase("KHR_draco_mesh_compression");
  primitive["extensions"][test::splatting]["extensions"]["EXT_packed_somehow"] = json::object();
  testing::internal::CaptureStderr();
  EXPECT_TRUE(refuses({"in the unknown extension 'EXT_packed_somehow'"}));
  EXPECT_NE(
      testing::internal::GetCapturedStderr().find("drawn without the unknown extension 'EXT_packed_somehow'"),
      std::string::npos);
}

struct GltfSparse : GltfAccessors {
  json sparse(const std::vector<int>& indices, const std::vector<float>& values,
              test::GltfType type = test::gltf_uint16) {
    const std::string data = type == test::gltf_uint8    ? packed<std::uint8_t>(indices)
                             : type == test::gltf_uint16 ? packed<std::uint16_t>(indices)
                                                         : packed<std::uint32_t>(indices);
    return {{"count", indices.size()},
            {"indices", {{"bufferView", glb.add_view(data)}, {"componentType", type}}},
            {"values", {{"bufferView", glb.add_view(packed<float>(values))}}}};
  }
};

TEST_F(GltfSparse, ReplacesElements) {
  for (const auto type : {test::gltf_uint8, test::gltf_uint16, test::gltf_uint32}) {
    glb.accessor("POSITION")["sparse"] = sparse({2, 9}, {1, 2, 3, 4, 5, 6}, type);
    std::vector<glm::vec3> expected = model.position;
    EXPECT_NE(load().position, expected);
    expected[2] = {1, 2, 3};
    expected[9] = {4, 5, 6};
    EXPECT_EQ(load().position, expected) << type;
  }
  // The sparse data begins at an offset in its views.
  json& of_positions = glb.accessor("POSITION")["sparse"];
  of_positions["count"] = 1;
  of_positions["indices"]["byteOffset"] = 4;
  of_positions["values"]["byteOffset"] = 12;
  EXPECT_EQ(load().position[2], model.position[2]);
  EXPECT_EQ(load().position[9], glm::vec3(4, 5, 6));
}

TEST_F(GltfSparse, ReplacesZeros) {
  json& accessor = glb.accessor("POSITION");
  accessor.erase("bufferView");
  accessor["sparse"] = sparse({1, 4}, {1, 2, 3, 4, 5, 6});
  std::vector<glm::vec3> expected(model.count(), glm::vec3(0.0f));
  expected[1] = {1, 2, 3};
  expected[4] = {4, 5, 6};
  EXPECT_EQ(load().position, expected);
}

TEST_F(GltfSparse, IsValidated) {
  const auto with = [&](const std::vector<int>& indices, const std::string& pointer, const json& value) {
    glb = test::gltf_of(model);
    glb.accessor("OPACITY")["sparse"] = sparse(indices, {0.5});
    return glb.with("/accessors/3/sparse" + pointer, value);
  };
  const std::vector<test::BrokenFile> refusals = {
      {with({10}, "/count", 1), {".sparse'", "element 10 is replaced, but the accessor has only 10"}},
      {with({3, 4}, "/count", 2), {".sparse'", "2 elements exceed their views"}},
      {with({3}, "/indices/byteOffset", 1), {".sparse'", "1 elements exceed their views"}},
      {with({3}, "/count", 11), {".sparse'", "it replaces 11 elements of 10"}},
      {with({3}, "/indices/componentType", 5126),
       {".sparse.indices.componentType'", "not a type of an index"}},
  };
  test::expect_no_models("a.glb", refusals);
}

// The least signed number stands for -1, as the number above it does. Numbers that are not normalized, which
// KHR_mesh_quantization allows, keep their value.
TEST_F(GltfAccessors, AcceptIntegers) {
  const struct {
    test::GltfType type;
    int least, most;
  } types[] = {{test::gltf_uint8, 0, 255},
               {test::gltf_int8, -128, 127},
               {test::gltf_uint16, 0, 65535},
               {test::gltf_int16, -32768, 32767}};
  for (const auto& [type, least, most] : types) {
    std::vector<int> numbers;
    for (int i = 0; i < 30; ++i) numbers.push_back(least + (most - least) * i / 29);
    const bool bytes = type == test::gltf_uint8 || type == test::gltf_int8;
    const std::string data = bytes ? packed<std::int8_t>(numbers) : packed<std::int16_t>(numbers);
    for (const bool normalized : {true, false}) {
      replace("POSITION", data, type, normalized);
      const Model found = load();
      for (std::size_t k = 0; k < 30; ++k) {
        const auto number = static_cast<float>(numbers[k]);
        EXPECT_EQ(found.position[k / 3][static_cast<int>(k % 3)],
                  normalized ? std::max(number / static_cast<float>(most), -1.0f) : number)
            << type << " " << normalized;
      }
    }
  }
}

// Quaternions are normalized after the rounding of their components.
TEST_F(GltfAccessors, AcceptIntegerRotations) {
  std::vector<double> bytes;
  for (const glm::vec4& q : model.rotation) {
    for (int c = 0; c < 4; ++c) bytes.push_back(std::round(127.0 * q[(c + 1) % 4]));
  }
  replace<std::int8_t>("ROTATION", bytes, test::gltf_int8);
  const Model found = load();
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_LT(glm::length(found.rotation[i] - model.rotation[i]), 0.02f);
    EXPECT_NEAR(glm::length(found.rotation[i]), 1.0f, 1e-6f);
  }
}

// Attributes may be interleaved, and elements may be farther apart than their size.
TEST_F(GltfAccessors, MayBeInterleaved) {
  std::vector<float> both;
  for (std::size_t i = 0; i < model.count(); ++i) {
    for (int c = 0; c < 3; ++c) both.push_back(model.position[i][c]);
    both.push_back(model.opacity[i]);
  }
  const std::size_t view = glb.add_view(packed<float>(both));
  glb.root["bufferViews"][view]["byteStride"] = 16;
  for (const char* name : {"POSITION", "OPACITY"}) glb.accessor(name)["bufferView"] = view;
  glb.accessor("OPACITY")["byteOffset"] = 12;
  EXPECT_EQ(load().position, model.position);
  EXPECT_EQ(load().opacity, model.opacity);
  // After the last element, the stride needs no bytes.
  glb.accessor("OPACITY")["count"] = 11;
  glb.accessor("POSITION")["count"] = 11;
  EXPECT_TRUE(refuses({"11 elements of", "exceed the buffer view of 160 bytes"}));
  glb.root["bufferViews"][view]["byteStride"] = 8;
  glb.accessor("POSITION")["count"] = 10;
  EXPECT_TRUE(refuses({"10 elements of 12 bytes, stride 8"}));
}

// An unaligned offset is outside the format, but its bytes are unambiguous.
TEST_F(GltfAccessors, MayBeUnaligned) {
  std::vector<float> numbers;
  for (const float opacity : model.opacity) numbers.push_back(opacity);
  replace("OPACITY", "x" + packed<float>(numbers), test::gltf_float, false);
  glb.accessor("OPACITY")["byteOffset"] = 1;
  EXPECT_EQ(load().opacity, model.opacity);
}

TEST_F(GltfAccessors, AreValidated) {
  const std::string accessor = "/accessors/3/", view = "/bufferViews/3/";  // both of the opacities
  const std::string primitive = "/meshes/0/primitives/0/";
  std::vector<test::BrokenFile> refusals = {
      {glb.with(accessor + "byteOffset", 4), {"exceed the buffer view of 40 bytes"}},
      {glb.with(accessor + "byteOffset", 1e12), {"exceed the buffer view of 40 bytes"}},
      {glb.with(accessor + "byteOffset", -4), {".byteOffset'", "whole number"}},
      {glb.with(accessor + "bufferView", 99), {"key 'bufferViews'"}},
      {glb.with("/accessors/0/count", 1000000000), {"1000000000 elements of 12 bytes", "view of 120 bytes"}},
      {glb.with(accessor + "count", 9), {".count'", "expected 10, the count of the positions"}},
      {glb.with(accessor + "type", "VEC4"), {".type'", "expected SCALAR, found VEC4"}},
      {glb.with(view + "byteStride", 1e12), {"exceed the buffer view of 40 bytes"}},
      {glb.with(view + "byteLength", 39), {"exceed the buffer view of 39 bytes"}},
      {glb.with(view + "byteLength", 300000), {"key 'bufferViews[3]'", "exceed its buffer of"}},
      {glb.with(view + "byteLength", nullptr), {"byteLength' is missing"}},
      {glb.with(view + "byteOffset", 1e12), {"exceed its buffer of"}},
      {glb.with(view + "byteOffset", 1e15), {"key 'bufferViews[3].byteOffset'"}},
      {glb.with(view + "buffer", 1), {"key 'buffers'", "more than 1 values"}},
      {glb.with(primitive + "attributes/" + test::splatting + ":ROTATION", nullptr),
       {"ROTATION' is missing"}},
      {glb.with(primitive + "indices", 3), {"primitives[0].indices'", "export them without"}},
  };
  for (const int type : {5124, 5125, 5127, 5130, 0})
    refusals.push_back({glb.with(accessor + "componentType", type),
                        {".componentType'", std::to_string(type) + " cannot be read"}});
  test::expect_no_models("a.glb", refusals);
}

TEST_F(GltfAccessors, MayBeEmpty) {
  for (json& accessor : glb.root["accessors"]) accessor["count"] = 0;
  EXPECT_TRUE(refuses({"without visible Gaussians"}));
  // An empty primitive next to another one is skipped.
  glb = test::gltf_of(model);
  json empty = glb.root["meshes"][0]["primitives"][0];
  for (auto& [name, accessor] : empty["attributes"].items()) {
    json none = glb.root["accessors"][accessor.get<std::size_t>()];
    none["count"] = 0;
    glb.root["accessors"].push_back(none);
    accessor = glb.root["accessors"].size() - 1;
  }
  glb.root["meshes"][0]["primitives"].push_back(empty);
  EXPECT_EQ(load().position, model.position);
}

TEST_F(GltfAccessors, HarmonicsNeedWholeDegrees) {
  const std::string attribute = test::splatting + ":SH_DEGREE_1_COEF_";
  for (int m = 0; m < 3; ++m) {
    const json attributes = glb.attributes();
    glb.attributes().erase(attribute + std::to_string(m));
    EXPECT_TRUE(refuses({fmt::format("SH_DEGREE_1_COEF_{}' is missing", m)}));
    glb.attributes() = attributes;
  }
  glb.attributes()[test::splatting + ":SH_DEGREE_3_COEF_6"] = glb.attributes()[attribute + "0"];
  EXPECT_TRUE(refuses({"SH_DEGREE_2_COEF_0' is missing"}));
  for (int m = 0; m < 3; ++m) glb.attributes().erase(attribute + std::to_string(m));
  glb.attributes().erase(test::splatting + ":SH_DEGREE_3_COEF_6");
  EXPECT_EQ(load().degree, 0);
  glb.attributes().erase(test::splatting + ":SH_DEGREE_0_COEF_0");
  EXPECT_TRUE(refuses({"SH_DEGREE_0_COEF_0' is missing"}));
}

// Drafts of the extension store the logarithms of scales, and programs wrote such files.
TEST_F(GltfAccessors, AcceptLogarithmicScales) {
  std::vector<float> logarithms;
  for (const glm::vec3& s : model.scale) {
    for (int c = 0; c < 3; ++c) logarithms.push_back(std::log(s[c]));
  }
  replace("SCALE", packed<float>(logarithms), test::gltf_float, false);
  testing::internal::CaptureStderr();
  const Model found = load();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("read as logarithms"), std::string::npos);
  ASSERT_EQ(found.count(), model.count());
  for (std::size_t i = 0; i < model.count(); ++i)
    EXPECT_LT(glm::length(found.scale[i] - model.scale[i]), 1e-6f);
}

}  // namespace
}  // namespace binosplat
