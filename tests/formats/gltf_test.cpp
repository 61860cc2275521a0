// glTF with Gaussians: nodes, accessors, and broken files. That values are decoded right is real_files_test's
// matter.

#include <gtest/gtest.h>

#include <ctime>

#include "formats/model_file.h"
#include "support/broken.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::little;
using test::patched;

constexpr const char* extension = "KHR_gaussian_splatting";

/// A .glb taken apart, and put together again.
struct Glb {
  json root;
  std::string binary;

  explicit Glb(const std::string& bytes) {
    const auto number = [&](std::size_t at) {
      std::uint32_t n = 0;
      std::memcpy(&n, &bytes[at], 4);
      return n;
    };
    const std::size_t length = number(12);
    root = json::parse(bytes.substr(20, length));
    binary = bytes.substr(28 + length, number(20 + length));
  }

  std::string bytes() const {
    std::string text = root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto size = [](const std::string& s) { return little(static_cast<std::uint32_t>(s.size())); };
    const std::string chunks = size(text) + "JSON" + text + size(binary) + std::string("BIN\0", 4) + binary;
    return "glTF" + little(2u) + little(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
  }

  json& attributes() { return root["meshes"][0]["primitives"][0]["attributes"]; }
  json& accessor(const std::string& name) {
    return root["accessors"][attributes()[name == "POSITION" ? name : std::string(extension) + ":" + name]
                                 .get<std::size_t>()];
  }
};

Model load(const std::string& bytes, const std::string& name = "a.glb") {
  const test::TempFolder folder;
  test::write_text(folder / name, bytes);
  return load_model(folder / name);
}

struct Gltf : testing::Test {
  std::string good;
  fs::path folder = test::fixtures_folder();

  void SetUp() override {
    REQUIRE_FIXTURES(fixtures);
    good = test::read_text(fixtures / "gltf/st-train-sh3.glb");
  }

  Glb without_harmonics() const {
    Glb glb(good);
    for (int band = 1; band <= 3; ++band) {
      for (int m = 0; m <= 2 * band; ++m)
        glb.attributes().erase(fmt::format("{}:SH_DEGREE_{}_COEF_{}", extension, band, m));
    }
    return glb;
  }

  /// Whether the good file, changed, ends in an error that names it and says `parts`.
  template <typename Change>
  testing::AssertionResult refuses(const Change& change, std::initializer_list<std::string> parts) const {
    Glb glb(good);
    change(glb);
    if (auto named = test::fails_saying([&] { load(glb.bytes()); }, {"a.glb"}); !named) return named;
    return test::fails_saying([&] { load(glb.bytes()); }, parts);
  }
  testing::AssertionResult refuses_bytes(const std::string& bytes,
                                         std::initializer_list<std::string> parts) const {
    return test::fails_saying([&] { load(bytes); }, parts);
  }
};

TEST_F(Gltf, NodesMoveWhatIsInThem) {
  const Model plain = load(good);
  EXPECT_EQ(plain.axes, "LUF");
  Glb glb(good);
  glb.root["nodes"] = {
      {{"translation", {1, 2, 3}}, {"children", {1, 2}}}, {{"mesh", 0}, {"scale", {2, 2, 2}}}, {{"mesh", 0}}};
  const Model two = load(glb.bytes());
  ASSERT_EQ(two.count(), 2000u);
  // The last child comes first.
  EXPECT_EQ(two.position[7], plain.position[7] + glm::vec3(1, 2, 3));
  EXPECT_LT(glm::length(two.position[1007] - (2.0f * plain.position[7] + glm::vec3(1, 2, 3))), 1e-5f);
  EXPECT_LT(glm::length(two.scale[1007] - 2.0f * plain.scale[7]), 1e-6f);
  EXPECT_EQ(two.rotation[1007], plain.rotation[7]);
  EXPECT_EQ(two.sh[1007 * 48 + 47], plain.sh[7 * 48 + 47]);
}

TEST_F(Gltf, TurnedGaussiansKeepQuaternionsOfLengthOne) {
  Glb glb = without_harmonics();
  // A quarter turn, uneven by as much as is let pass.
  glb.root["nodes"][0]["matrix"] = {0, 1.00006, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const Model turned = load(glb.bytes());
  EXPECT_EQ(turned.degree, 0);
  for (const glm::vec4& q : turned.rotation) ASSERT_NEAR(glm::length(q), 1.0f, 1e-6f);
  // Not the quaternions that were there.
  EXPECT_GT(glm::length(turned.rotation[7] - load(good).rotation[7]), 0.1f);
}

TEST_F(Gltf, SaysHowItIsSeen) {
  const auto seen = [&](const json& words) {
    Glb glb(good);
    glb.root["meshes"][0]["primitives"][0]["extensions"][extension].update(words);
    return load(glb.bytes()).perspective;
  };
  const Perspective by_distance{.order = ORDER_DISTANCE};
  EXPECT_EQ(seen({{"sortingMethod", "cameraDistance"}}), by_distance);
  EXPECT_EQ(seen({{"sortingMethod", "zDepth"}, {"projection", "perspective"}}), Perspective{});
  EXPECT_EQ(seen({{"sortingMethod", "zDepth"}, {"projection", "tangential"}}),
            (Perspective{.projection = PROJECTION_TANGENT}));
  EXPECT_EQ(seen({{"sortingMethod", "byColour"}}), by_distance);  // with a warning
  EXPECT_THROW(seen({{"projection", 3}}), Error);
  Glb silent(good);
  silent.root["meshes"][0]["primitives"][0]["extensions"][extension].erase("sortingMethod");
  EXPECT_EQ(load(silent.bytes()).perspective, by_distance);  // glTF's default
}

TEST_F(Gltf, CopiesHaveALimit) {
  Glb glb = without_harmonics();
  const auto copies = [&](int n) {
    glb.root["nodes"] = json(static_cast<std::size_t>(n), json{{"mesh", 0}});
    json& nodes = glb.root["scenes"][0]["nodes"] = json::array();
    for (int i = 0; i < n; ++i) nodes.push_back(i);
    return glb.bytes();
  };
  EXPECT_EQ(load(copies(50)).count(), 50000u);
  EXPECT_TRUE(refuses_bytes(copies(2000), {"a.glb, key 'nodes[", "showing the same ones many times"}));
}

TEST(GltfNodes, ShareMeshesInLinearTime) {
  constexpr std::size_t n = 20000;
  json root = {{"asset", {{"version", "2.0"}}}, {"buffers", json::array()}, {"scenes", {{{"nodes", {}}}}}};
  for (std::size_t i = 0; i < n; ++i) root["scenes"][0]["nodes"].push_back(i);
  root["nodes"] = json(n, json{{"mesh", 0}});
  root["meshes"] = {{{"primitives", json(n, json::object())}}};
  const std::clock_t start = std::clock();
  EXPECT_TRUE(test::fails_saying([&] { load(root.dump(), "a.gltf"); },
                                 {"a.gltf", "without Gaussians", "400000000 meshes, 0 points"}));
  EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);  // 0.2 s; each primitive of each node took minutes
}

TEST_F(Gltf, BuffersMayLieBeside) {
  const test::TempFolder temporary;
  Glb glb(good);
  glb.root["buffers"][0]["uri"] = "data.bin";
  test::write_text(temporary / "a.gltf", glb.root.dump());
  test::write_text(temporary / "data.bin", glb.binary);
  EXPECT_EQ(load_model(temporary / "a.gltf").position, load(good).position);
  fs::remove(temporary / "data.bin");
  EXPECT_TRUE(test::fails_saying([&] { load_model(temporary / "a.gltf"); },
                                 {"a.gltf, key 'buffers[0].uri'", "data.bin is missing"}));
}

TEST_F(Gltf, BuffersMayShareAFile) {
  const test::TempFolder temporary;
  Glb glb(good);
  glb.root["buffers"][0]["uri"] = "data.bin";
  glb.root["buffers"].push_back(glb.root["buffers"][0]);
  glb.root["buffers"][1]["uri"] = "./data.bin";
  glb.root["bufferViews"][glb.accessor("POSITION")["bufferView"].get<std::size_t>()]["buffer"] = 1;
  test::write_text(temporary / "a.gltf", glb.root.dump());
  test::write_text(temporary / "data.bin", glb.binary);
  EXPECT_EQ(load_model(temporary / "a.gltf").position, load(good).position);
}

TEST_F(Gltf, NumbersMayBeIntegersAndSparse) {
  Glb glb(good);
  // Opacities as bytes, every fourth of the floats' own bytes, and one of them replaced.
  json& accessor = glb.accessor("OPACITY");
  accessor["componentType"] = 5121;
  accessor["normalized"] = true;
  glb.root["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteStride"] = 4;
  const std::size_t at = glb.binary.size();
  glb.binary += little(std::uint16_t{5}) + std::string("\x33\0", 2);
  const std::size_t view = glb.root["bufferViews"].size();
  glb.root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", 2}});
  glb.root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at + 2}, {"byteLength", 1}});
  accessor["sparse"] = {{"count", 1},
                        {"indices", {{"bufferView", view}, {"componentType", 5123}}},
                        {"values", {{"bufferView", view + 1}}}};
  const Model model = load(glb.bytes());
  const std::size_t first = glb.root["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"];
  EXPECT_EQ(model.opacity[4],
            static_cast<float>(static_cast<unsigned char>(glb.binary[first + 16])) / 255.0f);
  EXPECT_EQ(model.opacity[5], 0.2f);
  accessor["sparse"]["count"] = 1001;
  EXPECT_TRUE(refuses_bytes(glb.bytes(), {"sparse'", "1001 elements are replaced, of 1000"}));
  accessor["sparse"]["count"] = 1;
  accessor["sparse"]["indices"]["componentType"] = 5126;
  EXPECT_TRUE(refuses_bytes(glb.bytes(), {"sparse.indices.componentType'", "no type of an index"}));
  accessor["sparse"]["indices"]["componentType"] = 5123;
  glb.binary[at + 1] = '\x7f';
  EXPECT_TRUE(refuses_bytes(glb.bytes(), {"sparse'", "is replaced, of 1000"}));
}

TEST_F(Gltf, BrokenContainers) {
  EXPECT_TRUE(refuses_bytes(patched(good, 8, little(static_cast<std::uint32_t>(good.size() + 1))),
                            {"a.glb is cut short: its header says 244577 bytes"}));
  EXPECT_TRUE(refuses_bytes(patched(good, 4, little(1u)), {"glTF of version 1"}));
  EXPECT_TRUE(refuses_bytes(patched(good, 12, little(4545u)), {"the first chunk, 4545 bytes"}));
  EXPECT_TRUE(refuses_bytes(patched(good, 12, little(0x7ffffffcu)), {"the first chunk"}));
  EXPECT_TRUE(refuses_bytes(patched(good, 16, "NOSJ"), {"is no JSON that fits"}));
  for (const std::size_t size : {5u, 19u, 24u, 3000u, 240000u})
    EXPECT_TRUE(refuses_bytes(good.substr(0, size), {"a.glb", "cut short"})) << size;
  std::uint32_t length = 0;
  std::memcpy(&length, &good[12], 4);
  EXPECT_TRUE(refuses_bytes(patched(good, 20 + length, little(0x7fffffffu)),
                            {"its binary chunk has 2147483647 bytes"}));
  EXPECT_TRUE(refuses_bytes(patched(good, 30, "{{{{"), {"not valid JSON"}));
}

TEST_F(Gltf, BrokenAccessors) {
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("POSITION")["count"] = 1000000000; },
                      {"1000000000 elements of 12 bytes", "leave their view of 12000 bytes"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("SCALE")["count"] = 999; },
                      {".count'", "expected 1000, as the positions have"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("SCALE")["componentType"] = 5125; },
                      {".componentType'", "5125 is none that can be read"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("ROTATION")["type"] = "VEC3"; },
                      {".type'", "expected VEC4, found VEC3"}));
  EXPECT_TRUE(
      refuses([](Glb& g) { g.accessor("OPACITY")["byteOffset"] = 1; }, {"leave their view of 4000 bytes"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("OPACITY").erase("bufferView"); }, {"bufferView' is missing"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["bufferViews"][0]["byteLength"] = 300000; },
                      {"key 'bufferViews[0]'", "leave its buffer of 240000"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["bufferViews"][0]["byteOffset"] = 1e15; },
                      {"key 'bufferViews[0].byteOffset'"}));
  EXPECT_TRUE(refuses(
      [](Glb& g) { g.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = json::object(); },
      {"compressed with meshopt"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["buffers"][0]["uri"] = "../secret.bin"; },
                      {"key 'buffers[0].uri'", "must lie beside"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["buffers"][0]["uri"] = "data:;base64,AA?A"; },
                      {"key 'buffers[0].uri'", "'?' is no digit of base64"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.attributes().erase(std::string(extension) + ":ROTATION"); },
                      {"ROTATION' is missing"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.attributes().erase(std::string(extension) + ":SH_DEGREE_1_COEF_1"); },
                      {"SH_DEGREE_1_COEF_1' is missing"}));
}

TEST_F(Gltf, BrokenScenes) {
  const auto node = [](Glb& g) -> json& { return g.root["nodes"][0]; };
  EXPECT_TRUE(refuses([&](Glb& g) { node(g)["scale"] = {1, 1, -1}; }, {"key 'nodes[0]'", "mirrors"}));
  EXPECT_TRUE(refuses([&](Glb& g) { node(g)["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}; },
                      {"key 'nodes[0]'", "mirrors"}));
  for (const char* key : {"scale", "translation"}) {
    EXPECT_TRUE(refuses(
        [&](Glb& g) {
          node(g)[key] = {1e90, 1e90, 1e90};
        },
        {"key 'nodes[0]'", "beyond the largest number"}));
  }
  EXPECT_TRUE(refuses([&](Glb& g) { node(g)["scale"] = {1, 1, 2}; }, {"scales its axes differently"}));
  EXPECT_TRUE(refuses([&](Glb& g) { node(g)["rotation"] = {0, 1, 0, 1}; }, {"turns harmonics of degree 3"}));
  EXPECT_TRUE(
      refuses([&](Glb& g) { node(g)["children"] = {0}; }, {"node 0 is not there, or has two parents"}));
  EXPECT_TRUE(refuses([&](Glb& g) { node(g)["mesh"] = 4; }, {"key 'meshes'", "more than 4 values"}));
  EXPECT_TRUE(refuses([&](Glb& g) { g.root["scene"] = 9; }, {"key 'scenes'", "more than 9 values"}));
  const auto primitive = [](Glb& g) -> json& { return g.root["meshes"][0]["primitives"][0]; };
  EXPECT_TRUE(refuses([&](Glb& g) { primitive(g)["extensions"][extension]["kernel"] = "box"; },
                      {"'box' is not known"}));
  EXPECT_TRUE(refuses([&](Glb& g) { primitive(g).erase("extensions"); },
                      {"a glTF scene without Gaussians", "0 meshes, 1 points"}));
  EXPECT_TRUE(refuses(
      [&](Glb& g) {
        primitive(g).erase("extensions");
        primitive(g)["mode"] = 4;
      },
      {"1 meshes, 0 points"}));
  Glb linear(good);
  primitive(linear)["extensions"][extension]["colorSpace"] = "lin_rec709_display";
  testing::internal::CaptureStderr();
  load(linear.bytes());
  EXPECT_NE(testing::internal::GetCapturedStderr().find("linear light"), std::string::npos);
  const std::string packed = test::read_text(folder / "gltf/synthetic-spz2-train-sh3.glb");
  Glb spz(packed);
  spz.root["bufferViews"][0]["byteLength"] = 20000;
  EXPECT_TRUE(refuses_bytes(spz.bytes(), {"a.glb: its spz data is cut short"}));
}

}  // namespace
}  // namespace binosplat
