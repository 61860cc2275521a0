#pragma once
// Builds glTF files with Gaussians in memory.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/load.h"

namespace binosplat::test {

inline const std::string splatting = "KHR_gaussian_splatting";

enum GltfType { gltf_int8 = 5120, gltf_uint8, gltf_int16, gltf_uint16, gltf_uint32 = 5125, gltf_float };

/// Returns the bytes of values, in a file's order.
template <typename T, typename Values>
std::string packed(const Values& values) {
  std::string bytes;
  for (const auto value : values) bytes += little(static_cast<T>(value));
  return bytes;
}

/// A .glb file, split into parts for changes.
struct Glb {
  nlohmann::json root;
  std::string binary;  // its first buffer

  Glb() = default;
  explicit Glb(const std::string& bytes) {
    const auto number = [&](std::size_t at) {
      std::uint32_t n = 0;
      std::memcpy(&n, &bytes[at], 4);
      return n;
    };
    const std::size_t length = number(12);
    root = nlohmann::json::parse(bytes.substr(20, length));
    binary = bytes.substr(28 + length, number(20 + length));
  }

  static std::string chunk(const std::string& type, std::string data, char filler) {
    data.resize((data.size() + 3) / 4 * 4, filler);
    return little(static_cast<std::uint32_t>(data.size())) + type + data;
  }
  static std::string whole(const std::string& chunks) {
    return "glTF" + little(2u) + little(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
  }
  std::string json_chunk() const { return chunk("JSON", root.dump(), ' '); }
  std::string binary_chunk() const { return chunk(std::string("BIN\0", 4), binary, '\0'); }
  std::string bytes() const { return whole(json_chunk() + binary_chunk()); }
  /// Returns the file with one value replaced (with_value()).
  std::string with(const std::string& pointer, const nlohmann::json& value) const {
    Glb other = *this;
    other.root = nlohmann::json::parse(with_value(root, pointer, value));
    return other.bytes();
  }

  nlohmann::json& attributes() { return root["meshes"][0]["primitives"][0]["attributes"]; }
  nlohmann::json& accessor(const std::string& name) {
    return root["accessors"]
               [attributes()[name == "POSITION" ? name : splatting + ":" + name].get<std::size_t>()];
  }
  nlohmann::json& node(std::size_t i = 0) { return root["nodes"][i]; }

  /// add_view and add_accessor append to the first buffer, at a multiple of 4 bytes, and return the new
  /// index.
  std::size_t add_view(const std::string& data) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", data.size()}});
    binary += data;
    root["buffers"][0]["byteLength"] = binary.size();
    return root["bufferViews"].size() - 1;
  }
  std::size_t add_accessor(const std::string& data, std::size_t count, const std::string& type,
                           GltfType component = gltf_float, const nlohmann::json& more = {}) {
    nlohmann::json accessor = {
        {"bufferView", add_view(data)}, {"count", count}, {"type", type}, {"componentType", component}};
    if (!more.is_null()) accessor.update(more);
    root["accessors"].push_back(accessor);
    return root["accessors"].size() - 1;
  }
};

/// Returns a file of one node that shows a model.
inline Glb gltf_of(const Model& model) {
  Glb glb;
  glb.root = {{"asset", {{"version", "2.0"}}},
              {"extensionsUsed", {splatting}},
              {"scenes", {{{"nodes", {0}}}}},
              {"nodes", {{{"mesh", 0}}}},
              {"buffers", {{{"byteLength", 0}}}},
              {"meshes", {{{"primitives", {{{"mode", 0}, {"attributes", {}}}}}}}}};
  glb.root["meshes"][0]["primitives"][0]["extensions"][splatting] = {{"kernel", "ellipse"},
                                                                     {"colorSpace", "srgb_rec709_display"}};
  const std::size_t n = model.count(), values = static_cast<std::size_t>(sh_count(model.degree));
  const auto add = [&](const std::string& name, const char* type, std::size_t components, const auto& of) {
    std::vector<float> numbers;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < components; ++c) numbers.push_back(of(i, static_cast<int>(c)));
    }
    glb.attributes()[name] = glb.add_accessor(packed<float>(numbers), n, type);
  };
  add("POSITION", "VEC3", 3, [&](std::size_t i, int c) { return model.position[i][c]; });
  add(splatting + ":ROTATION", "VEC4", 4,
      [&](std::size_t i, int c) { return model.rotation[i][(c + 1) % 4]; });
  add(splatting + ":SCALE", "VEC3", 3, [&](std::size_t i, int c) { return model.scale[i][c]; });
  add(splatting + ":OPACITY", "SCALAR", 1, [&](std::size_t i, int) { return model.opacity[i]; });
  std::size_t k = 0;
  for (int degree = 0; degree <= model.degree; ++degree) {
    for (int m = 0; m <= 2 * degree; ++m, ++k) {
      add(fmt::format("{}:SH_DEGREE_{}_COEF_{}", splatting, degree, m), "VEC3", 3,
          [&](std::size_t i, int c) { return model.sh[(i * values + k) * 3 + static_cast<std::size_t>(c)]; });
    }
  }
  return glb;
}

inline Model load_gltf_bytes(const std::string& bytes) { return load_model_of(bytes, "a.glb"); }

/// Returns whether reading a file fails with an error that contains its name and `parts`.
inline testing::AssertionResult refuses_gltf(const std::string& bytes, std::vector<std::string> parts) {
  parts.emplace_back("a.glb");
  return fails_saying([&] { load_gltf_bytes(bytes); }, parts);
}

}  // namespace binosplat::test
