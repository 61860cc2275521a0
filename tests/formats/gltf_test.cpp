// glTF with Gaussians: a file of another program, and damage to it. That values are decoded right is
// real_files_test's matter; the format's rules are gltf_nodes_test's, gltf_accessors_test's and
// gltf_files_test's.

#include <gtest/gtest.h>

#include <ctime>

#include "formats/model_file.h"
#include "support/fixtures.h"
#include "support/gltf.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::little;
using test::patched;

using test::Glb;
using test::load_gltf_bytes;
const std::string& extension = test::splatting;

struct Gltf : testing::Test {
  std::string good;
  fs::path folder = test::fixtures_folder();

  void SetUp() override {
    REQUIRE_FIXTURES(fixtures);
    good = test::read_text(fixtures / "gltf/st-train-sh3.glb");
  }

  /// Whether the good file, changed, ends in an error that names it and says `parts`.
  template <typename Change>
  testing::AssertionResult refuses(const Change& change, std::initializer_list<std::string> parts) const {
    Glb glb(good);
    change(glb);
    return test::refuses_gltf(glb.bytes(), parts);
  }
  testing::AssertionResult refuses_bytes(const std::string& bytes,
                                         std::initializer_list<std::string> parts) const {
    return test::refuses_gltf(bytes, parts);
  }
};

TEST_F(Gltf, SaysHowItIsSeen) {
  const auto seen = [&](const json& words) {
    Glb glb(good);
    glb.root["meshes"][0]["primitives"][0]["extensions"][extension].update(words);
    return load_gltf_bytes(glb.bytes()).perspective;
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
  EXPECT_EQ(load_gltf_bytes(silent.bytes()).perspective, by_distance);  // glTF's default
}

TEST(GltfMeshes, AreSharedInLinearTime) {
  constexpr std::size_t n = 20000;
  json root = {{"asset", {{"version", "2.0"}}}, {"buffers", json::array()}, {"scenes", {{{"nodes", {}}}}}};
  for (std::size_t i = 0; i < n; ++i) root["scenes"][0]["nodes"].push_back(i);
  root["nodes"] = json(n, json{{"mesh", 0}});
  root["meshes"] = {{{"primitives", json(n, json::object())}}};
  const std::clock_t start = std::clock();
  EXPECT_TRUE(test::fails_saying([&] { load_gltf_bytes(root.dump(), "a.gltf"); },
                                 {"a.gltf", "without Gaussians", "400000000 meshes, 0 points"}));
  EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);  // 0.2 s; each primitive of each node took minutes
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
  EXPECT_EQ(load_model(temporary / "a.gltf").position, load_gltf_bytes(good).position);
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

// The rest of what accessors may not be is gltf_accessors_test's.
TEST_F(Gltf, BrokenAccessors) {
  EXPECT_TRUE(refuses([](Glb& g) { g.accessor("POSITION")["count"] = 1000000000; },
                      {"1000000000 elements of 12 bytes", "leave their view of 12000 bytes"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["bufferViews"][0]["byteLength"] = 300000; },
                      {"key 'bufferViews[0]'", "leave its buffer of 240000"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.root["bufferViews"][0]["byteOffset"] = 1e15; },
                      {"key 'bufferViews[0].byteOffset'"}));
  EXPECT_TRUE(refuses([](Glb& g) { g.attributes().erase(std::string(extension) + ":ROTATION"); },
                      {"ROTATION' is missing"}));
}

TEST_F(Gltf, BrokenScenes) {
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
  load_gltf_bytes(linear.bytes());
  EXPECT_NE(testing::internal::GetCapturedStderr().find("linear light"), std::string::npos);
  const std::string packed = test::read_text(folder / "gltf/synthetic-spz2-train-sh3.glb");
  Glb spz(packed);
  spz.root["bufferViews"][0]["byteLength"] = 20000;
  EXPECT_TRUE(refuses_bytes(spz.bytes(), {"a.glb: its spz data is cut short"}));
}

}  // namespace
}  // namespace binosplat
