// glTF's accessors, a rule a test: where numbers lie, what they stand for, and what none may be. Pictures of
// them are real_files_test's matter.

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
  testing::AssertionResult refuses(std::initializer_list<std::string> parts) const {
    return refuses_gltf(glb.bytes(), parts);
  }
  json& view_of(const std::string& name) {
    return glb.root["bufferViews"][glb.accessor(name)["bufferView"].get<std::size_t>()];
  }
  /// Other numbers for an attribute, in a view of their own.
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

TEST_F(GltfAccessors, WithoutAViewAreZeros) {
  for (int m = 0; m < 3; ++m) glb.accessor(fmt::format("SH_DEGREE_1_COEF_{}", m)).erase("bufferView");
  const Model found = load();
  ASSERT_EQ(found.degree, 1);
  for (std::size_t i = 0; i < model.count(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(found.sh[12 * i + k], k < 3 ? model.sh[12 * i + k] : 0.0f);
  }
  glb.accessor("POSITION")["bufferView"] = nullptr;  // as good as none
  for (const glm::vec3& p : load().position) EXPECT_EQ(p, glm::vec3(0.0f));
}

// No memory is taken for zeros that no file of its size needs.
TEST_F(GltfAccessors, WithoutAViewHaveALimit) {
  for (json& accessor : glb.root["accessors"]) {
    accessor.erase("bufferView");
    accessor["count"] = 1e12;
  }
  EXPECT_TRUE(
      refuses({"key 'accessors[", ".count'", "1000000000000 elements without a bufferView", "--max-memory"}));
}

// What an extension holds instead is not taken for zeros.
TEST_F(GltfAccessors, WithoutAViewMayBeInAnExtension) {
  json& primitive = glb.root["meshes"][0]["primitives"][0];
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  EXPECT_EQ(load().position, model.position);  // all numbers are there without it
  glb.accessor("POSITION").erase("bufferView");
  EXPECT_TRUE(refuses({"attributes.POSITION'", "in the extension 'KHR_draco_mesh_compression'"}));
  primitive["extensions"].erase("KHR_draco_mesh_compression");
  primitive["extensions"][test::splatting]["extensions"]["EXT_packed_somehow"] = json::object();
  testing::internal::CaptureStderr();
  EXPECT_TRUE(refuses({"in the extension 'EXT_packed_somehow'"}));
  EXPECT_NE(testing::internal::GetCapturedStderr().find("drawn without the extension 'EXT_packed_somehow'"),
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

TEST_F(GltfSparse, ReplaceElements) {
  for (const auto type : {test::gltf_uint8, test::gltf_uint16, test::gltf_uint32}) {
    glb.accessor("POSITION")["sparse"] = sparse({2, 9}, {1, 2, 3, 4, 5, 6}, type);
    std::vector<glm::vec3> expected = model.position;
    EXPECT_NE(load().position, expected);
    expected[2] = {1, 2, 3};
    expected[9] = {4, 5, 6};
    EXPECT_EQ(load().position, expected) << type;
  }
  // From a byte of their views on.
  json& of_positions = glb.accessor("POSITION")["sparse"];
  of_positions["count"] = 1;
  of_positions["indices"]["byteOffset"] = 4;
  of_positions["values"]["byteOffset"] = 12;
  EXPECT_EQ(load().position[2], model.position[2]);
  EXPECT_EQ(load().position[9], glm::vec3(4, 5, 6));
}

TEST_F(GltfSparse, ReplaceZeros) {
  json& accessor = glb.accessor("POSITION");
  accessor.erase("bufferView");
  accessor["sparse"] = sparse({1, 4}, {1, 2, 3, 4, 5, 6});
  std::vector<glm::vec3> expected(model.count(), glm::vec3(0.0f));
  expected[1] = {1, 2, 3};
  expected[4] = {4, 5, 6};
  EXPECT_EQ(load().position, expected);
}

TEST_F(GltfSparse, AreChecked) {
  json& accessor = glb.accessor("OPACITY");
  accessor["sparse"] = sparse({3, 10}, {0.5, 0.25});
  EXPECT_TRUE(refuses({".sparse'", "element 10 is replaced, of 10"}));
  accessor["sparse"] = sparse({3, 4}, {0.5});
  EXPECT_TRUE(refuses({".sparse'", "2 elements leave their views"}));
  accessor["sparse"] = sparse({3}, {0.5});
  accessor["sparse"]["indices"]["byteOffset"] = 1;
  EXPECT_TRUE(refuses({".sparse'", "1 elements leave their views"}));
  accessor["sparse"]["indices"].erase("byteOffset");
  accessor["sparse"]["count"] = 11;
  EXPECT_TRUE(refuses({".sparse'", "11 elements are replaced, of 10"}));
  accessor["sparse"]["count"] = 1;
  accessor["sparse"]["indices"]["componentType"] = test::gltf_float;
  EXPECT_TRUE(refuses({".sparse.indices.componentType'", "no type of an index"}));
}

TEST_F(GltfAccessors, MayBeIntegers) {
  std::vector<double> bytes, shorts;
  for (int i = 0; i < 10; ++i) {
    bytes.push_back(i < 9 ? 25.0 * i : 255.0);
    shorts.push_back(i < 9 ? 7000.0 * i : 65535.0);
  }
  replace<std::uint8_t>("OPACITY", bytes, test::gltf_uint8);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(load().opacity[i], static_cast<float>(bytes[i]) / 255.0f);
  replace<std::uint16_t>("OPACITY", shorts, test::gltf_uint16);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(load().opacity[i], static_cast<float>(shorts[i]) / 65535.0f);
}

// The least number of a signed type stands for -1, as the one above it does.
TEST_F(GltfAccessors, MayBeSignedIntegers) {
  std::vector<double> numbers;
  for (int i = 0; i < 30; ++i) numbers.push_back(i % 3 == 0 ? -128 : i % 3 == 1 ? 127 : 4 * i - 60);
  const auto positions = [&](double most, bool normalized) {
    std::vector<glm::vec3> expected;
    for (std::size_t i = 0; i < 30; i += 3) {
      glm::vec3& p = expected.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
      if (normalized) p = glm::max(p / static_cast<float>(most), -1.0f);
    }
    return expected;
  };
  for (const bool normalized : {true, false}) {
    replace<std::int8_t>("POSITION", numbers, test::gltf_int8, normalized);  // KHR_mesh_quantization
    EXPECT_EQ(load().position, positions(127, normalized));
    for (double& n : numbers) n *= 256.0;
    replace<std::int16_t>("POSITION", numbers, test::gltf_int16, normalized);
    EXPECT_EQ(load().position, positions(32767, normalized));
    for (double& n : numbers) n /= 256.0;
  }
}

// Quaternions in bytes, shorts and floats of any length are the same turn.
TEST_F(GltfAccessors, OfRotationsMayBeIntegers) {
  std::vector<double> bytes, shorts;
  for (const glm::vec4& q : model.rotation) {
    for (int c = 0; c < 4; ++c) {
      bytes.push_back(std::round(127.0 * q[(c + 1) % 4]));
      shorts.push_back(std::round(32767.0 * q[(c + 1) % 4]));
    }
  }
  const auto apart = [&] {
    float most = 0.0f;
    const Model found = load();
    for (std::size_t i = 0; i < model.count(); ++i)
      most = std::max(most, glm::length(found.rotation[i] - model.rotation[i]));
    return most;
  };
  replace<std::int8_t>("ROTATION", bytes, test::gltf_int8);
  EXPECT_LT(apart(), 0.02f);
  EXPECT_GT(apart(), 1e-4f);
  replace<std::int16_t>("ROTATION", shorts, test::gltf_int16);
  EXPECT_LT(apart(), 1e-4f);
}

// Interleaved, or with an element's bytes farther apart than they need.
TEST_F(GltfAccessors, MayShareAView) {
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
  // The last element needs no room behind it.
  glb.accessor("OPACITY")["count"] = 11;
  glb.accessor("POSITION")["count"] = 11;
  EXPECT_TRUE(refuses({"11 elements of", "leave their view of 160 bytes"}));
  glb.root["bufferViews"][view]["byteStride"] = 8;
  glb.accessor("POSITION")["count"] = 10;
  EXPECT_TRUE(refuses({"10 elements of 12 bytes, 8 apart"}));
}

// Which the format does not allow, but no byte is in doubt.
TEST_F(GltfAccessors, MayBeginAnywhere) {
  std::vector<float> numbers;
  for (const float opacity : model.opacity) numbers.push_back(opacity);
  replace("OPACITY", "x" + packed<float>(numbers), test::gltf_float, false);
  glb.accessor("OPACITY")["byteOffset"] = 1;
  EXPECT_EQ(load().opacity, model.opacity);
}

TEST_F(GltfAccessors, StayInTheirViews) {
  const auto broken = [&](const auto& change, std::initializer_list<std::string> parts) {
    const Glb whole = glb;
    change();
    const auto refused = refuses(parts);
    glb = whole;
    return refused;
  };
  EXPECT_TRUE(broken([&] { glb.accessor("OPACITY")["byteOffset"] = 4; }, {"leave their view of 40 bytes"}));
  EXPECT_TRUE(
      broken([&] { glb.accessor("OPACITY")["byteOffset"] = 1e12; }, {"leave their view of 40 bytes"}));
  EXPECT_TRUE(broken([&] { glb.accessor("OPACITY")["byteOffset"] = -4; }, {".byteOffset'", "whole number"}));
  EXPECT_TRUE(broken([&] { view_of("OPACITY")["byteStride"] = 1e12; }, {"leave their view of 40 bytes"}));
  EXPECT_TRUE(broken([&] { view_of("OPACITY")["byteLength"] = 39; }, {"leave their view of 39 bytes"}));
  EXPECT_TRUE(broken([&] { view_of("OPACITY")["byteOffset"] = 1e12; }, {"leave its buffer of"}));
  EXPECT_TRUE(broken([&] { view_of("OPACITY")["buffer"] = 1; }, {"key 'buffers'", "more than 1 values"}));
  EXPECT_TRUE(broken([&] { view_of("OPACITY").erase("byteLength"); }, {"byteLength' is missing"}));
  EXPECT_TRUE(broken([&] { glb.accessor("OPACITY")["bufferView"] = 99; }, {"key 'bufferViews'"}));
}

TEST_F(GltfAccessors, AgreeInNumber) {
  glb.accessor("SCALE")["count"] = 9;
  EXPECT_TRUE(refuses({".count'", "expected 10, as the positions have"}));
  for (json& accessor : glb.root["accessors"]) accessor["count"] = 0;
  EXPECT_TRUE(refuses({"without Gaussians"}));
  // An empty primitive beside another one does no harm.
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

TEST_F(GltfAccessors, AreOfTheTypeThatIsNeeded) {
  glb.accessor("SCALE")["type"] = "VEC4";
  EXPECT_TRUE(refuses({".type'", "expected VEC3, found VEC4"}));
  glb.accessor("SCALE")["type"] = "VEC3";
  for (const int type : {5124, 5125, 5127, 5130, 0}) {
    glb.accessor("SCALE")["componentType"] = type;
    EXPECT_TRUE(refuses({".componentType'", fmt::format("{} is none that can be read", type)}));
  }
}

TEST_F(GltfAccessors, OfHarmonicsAreThereByWholeDegrees) {
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

// Drafts of the extension have logarithms, which other programs wrote.
TEST_F(GltfAccessors, OfScalesMayBeLogarithms) {
  std::vector<float> logarithms;
  for (const glm::vec3& s : model.scale) {
    for (int c = 0; c < 3; ++c) logarithms.push_back(std::log(s[c]));
  }
  replace("SCALE", packed<float>(logarithms), test::gltf_float, false);
  testing::internal::CaptureStderr();
  const Model found = load();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("taken for logarithms"), std::string::npos);
  ASSERT_EQ(found.count(), model.count());
  for (std::size_t i = 0; i < model.count(); ++i)
    EXPECT_LT(glm::length(found.scale[i] - model.scale[i]), 1e-6f);
}

TEST_F(GltfAccessors, OfIndicesAreNotPassedOver) {
  glb.root["meshes"][0]["primitives"][0]["indices"] =
      glb.add_accessor(packed<std::uint16_t>(std::vector<int>{0, 1}), 2, "SCALAR", test::gltf_uint16);
  EXPECT_TRUE(refuses({"primitives[0].indices'", "export them without"}));
}

}  // namespace
}  // namespace binosplat
