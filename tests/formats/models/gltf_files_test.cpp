// glTF files: containers, buffers and their URIs, versions and extensions, one rule per test. real_files_test
// tests that values are decoded right.

#include <gtest/gtest.h>

#include "base/text.h"
#include "support/fixtures.h"
#include "support/gltf.h"
#include "support/models.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::Glb;
using test::little;
using test::load_gltf_bytes;
using test::refuses_gltf;

struct GltfFiles : testing::Test {
  const Model model = test::random_model(13, 10, 0);
  Glb glb = test::gltf_of(model);
  const test::TempFolder folder;

  json& buffer(std::size_t i = 0) { return glb.root["buffers"][i]; }
  /// Loads the model as a .gltf, with the files that a test put next to it.
  Model load() const {
    test::write_text(folder / "a.gltf", glb.root.dump());
    return load_model(folder / "a.gltf");
  }
  bool is_right(const Model& found) const { return found.position == model.position && found.sh == model.sh; }
  testing::AssertionResult refuses(const std::vector<std::string>& parts) const {
    return test::fails_saying([&] { load(); }, parts);
  }
};

TEST_F(GltfFiles, UnknownChunksAreSkipped) {
  const std::string other = Glb::chunk("MORE", "of another kind", 'x');
  const std::string json = glb.json_chunk(), binary = glb.binary_chunk();
  for (const std::string& chunks :
       {json + binary, json + binary + other, json + other + binary, json + other + other + binary + other})
    EXPECT_TRUE(is_right(load_gltf_bytes(Glb::whole(chunks))));
}

TEST_F(GltfFiles, ChunksMayBePadded) {
  std::string text = glb.root.dump();
  text += std::string(4 - text.size() % 4, '\0');
  EXPECT_TRUE(is_right(load_gltf_bytes(Glb::whole(Glb::chunk("JSON", text, ' ') + glb.binary_chunk()))));
  // Bytes after the length in the header do not belong to the file.
  EXPECT_TRUE(is_right(load_gltf_bytes(glb.bytes() + "more")));
}

TEST_F(GltfFiles, BrokenContainersAreRejected) {
  const std::string good = glb.bytes(), text = glb.json_chunk(), binary = glb.binary_chunk();
  const std::string other = Glb::chunk("MORE", "of another kind", 'x');
  const auto length = static_cast<std::uint32_t>(good.size());
  const auto with = [&](std::size_t at, std::uint32_t number) {
    return test::patched(good, at, little(number));
  };
  std::vector<test::BrokenFile> refusals = {
      {Glb::whole(text + other), {"key 'buffers[0]'", "no binary chunk"}},
      {Glb::whole(other + text + binary), {"the first chunk", "not JSON"}},
      {Glb::whole(binary + text), {"the first chunk", "not JSON"}},
      {Glb::whole(text + other.substr(0, 12) + "cut"),
       {"cut short: its chunk has 16 bytes, and 7 are there"}},
      {with(8, 12), {"its header (byte 8) says 12 bytes"}},
      {with(8, length - 400), {"cut short: its binary chunk"}},
      {with(8, length + 1),
       {"a.glb is cut short: its header (byte 8) says " + std::to_string(length + 1) + " bytes"}},
      {with(4, 1), {"unknown glTF version 1"}},
      {with(12, 4545), {"its length (4545, at byte 12)"}},
      {with(12, 0x7ffffffc), {"the first chunk"}},
      {with(12 + text.size(), 0x7fffffff), {"its binary chunk has 2147483647 bytes"}},
      {test::patched(good, 16, "NOSJ"), {"is not JSON, or exceeds"}},
      {test::patched(good, 30, "{{{{"), {"not valid JSON"}},
  };
  for (const std::size_t size : {std::size_t{5}, std::size_t{19}, std::size_t{24}, good.size() / 2})
    refusals.push_back({good.substr(0, size), {"cut short"}});
  test::expect_no_models("a.glb", refusals);
}

// A chunk may have up to 3 bytes more than its buffer, but no fewer.
TEST_F(GltfFiles, BufferLengthsAreChecked) {
  const std::size_t length = glb.binary.size();
  for (const std::size_t more : {1u, 3u, 40u}) {
    Glb longer = glb;
    longer.binary += std::string(more, '\0');
    EXPECT_TRUE(is_right(load_gltf_bytes(longer.bytes()))) << more;
  }
  buffer()["byteLength"] = length + 40;
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'buffers[0]'", "cut short", "byteLength is"}));
  buffer()["uri"] = "b.bin";
  test::write_text(folder / "b.bin", glb.binary);
  EXPECT_TRUE(refuses({"key 'buffers[0]'", "cut short"}));
  test::write_text(folder / "b.bin", glb.binary + std::string(40, 'x'));
  EXPECT_TRUE(is_right(load()));
  test::write_text(folder / "b.bin", "");
  EXPECT_TRUE(refuses({"key 'buffers[0]'", "cut short", "0 bytes are there"}));
}

TEST_F(GltfFiles, BuffersMayBeSeveral) {
  // Buffers are the binary chunk, another file, and data in the JSON.
  const std::vector<json> views = glb.root["bufferViews"];
  const auto bytes_of = [&](std::size_t i) {
    return glb.binary.substr(views[i]["byteOffset"], views[i]["byteLength"]);
  };
  for (const std::size_t i : {1u, 2u, 3u}) {
    glb.root["bufferViews"][i]["byteOffset"] = 0;
    glb.root["bufferViews"][i]["buffer"] = i;
  }
  glb.root["buffers"].push_back({{"byteLength", bytes_of(1).size()}, {"uri", "b.bin"}});
  glb.root["buffers"].push_back({{"byteLength", bytes_of(2).size()},
                                 {"uri", "data:application/octet-stream;base64," + base64(bytes_of(2))}});
  // The same file by another name. This buffer's view begins after the bytes of the first one.
  glb.root["buffers"].push_back(
      {{"byteLength", bytes_of(1).size() + bytes_of(3).size()}, {"uri", "./b.bin"}});
  glb.root["bufferViews"][3]["byteOffset"] = bytes_of(1).size();
  test::write_text(folder / "b.bin", bytes_of(1) + bytes_of(3));
  test::write_text(folder / "a.glb", glb.bytes());
  EXPECT_TRUE(is_right(load_model(folder / "a.glb")));
  buffer(1).erase("uri");
  EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'buffers[1]'", "no uri"}));
}

TEST_F(GltfFiles, BuffersMayBeInDataUris) {
  std::string percents, some;
  for (const char c : glb.binary) {
    const std::string encoded = fmt::format("%{:02X}", static_cast<unsigned char>(c));
    percents += encoded;
    some += c >= 'a' && c <= 'z' ? std::string(1, c) : encoded;
  }
  std::string coded = base64(glb.binary), escaped;
  for (const char c : coded) escaped += c == '+' ? "%2B" : c == '/' ? "%2f" : std::string(1, c);
  for (const std::string& uri :
       {"data:application/octet-stream;base64," + coded, "data:application/gltf-buffer;base64," + coded,
        "data:;base64," + coded, "data:text/plain;charset=utf-8;base64," + coded, "DATA:;BASE64," + coded,
        "data:;base64," + escaped, "data:," + percents, "data:application/octet-stream," + some}) {
    buffer()["uri"] = uri;
    EXPECT_TRUE(is_right(load())) << uri.substr(0, 60);
  }
  while (coded.ends_with('=')) coded.pop_back();
  buffer()["uri"] = "data:;base64," + coded;
  EXPECT_TRUE(is_right(load()));
  buffer()["uri"] = "data:;base64," + coded.substr(0, 40);
  EXPECT_TRUE(refuses({"key 'buffers[0]'", "cut short"}));
  buffer()["uri"] = "data:;base64,AA?A";
  EXPECT_TRUE(refuses({"key 'buffers[0].uri'", "'?' is not a digit of base64"}));
  buffer()["uri"] = "data:;base64";
  EXPECT_TRUE(refuses({"key 'buffers[0].uri'", "a comma"}));
}

TEST_F(GltfFiles, UrisArePercentDecoded) {
  const std::string umlaut =
      "m\xc3\xb6"
      "del.bin";
  const std::pair<std::string, std::string> cases[] = {
      {"b.bin", "b.bin"},
      {"my%20model.bin", "my model.bin"},
      {"my model.bin", "my model.bin"},
      {"m%C3%B6del.bin", umlaut},
      {"m%c3%b6del.bin", umlaut},
      {umlaut, umlaut},
      {"a%23b%3Fc%25d.bin", "a#b?c%d.bin"},
      {"%E7%AB%8B.bin", "\xe7\xab\x8b.bin"},
      {"sub/b.bin", "sub/b.bin"},
      {"./sub/./b.bin", "sub/b.bin"},
      {"sub%2Fb.bin", "sub/b.bin"},
      // Names with characters that other programs do not encode.
      {"100% done.bin", "100% done.bin"},
      {"a%2.bin", "a%2.bin"},
      {"my%20model.bin", "my%20model.bin"},
      {"a#b.bin", "a#b.bin"},
  };
  for (const auto& [uri, file] : cases) {
    const test::TempFolder other;
    std::filesystem::create_directories((other / file).parent_path());
    test::write_text(other / file, glb.binary);
    buffer()["uri"] = uri;
    test::write_text(other / "a.gltf", glb.root.dump());
    EXPECT_TRUE(is_right(load_model(other / "a.gltf"))) << uri << " " << file;
  }
  // The decoded name has precedence.
  test::write_text(folder / "my model.bin", glb.binary);
  test::write_text(folder / "my%20model.bin", std::string(glb.binary.size(), 'x'));
  buffer()["uri"] = "my%20model.bin";
  EXPECT_TRUE(is_right(load()));
}

TEST_F(GltfFiles, UrisMustNameAdjacentFiles) {
  const auto refuses_uri = [&](const char* uri, const char* part) {
    buffer()["uri"] = uri;
    return refuses({"a.gltf, key 'buffers[0].uri'", part});
  };
  EXPECT_TRUE(refuses_uri("missing.bin", "missing.bin is missing; fetch or export it again"));
  EXPECT_TRUE(refuses_uri("miss%20ing.bin", "miss ing.bin is missing"));
  for (const char* elsewhere : {"../b.bin", "%2E%2E/b.bin", "sub/%2e%2e/%2e%2e/b.bin", "/etc/passwd",
                                "%2Fetc%2Fpasswd", "b%00.bin", "..%5Cb.bin", ""})
    EXPECT_TRUE(refuses_uri(elsewhere, "must lie beside")) << elsewhere;
  for (const char* far : {"https://example.org/b.bin", "file:///tmp/b.bin"})
    EXPECT_TRUE(refuses_uri(far, "not a file beside this one")) << far;
  buffer()["uri"] = 7;
  EXPECT_TRUE(refuses({"key 'buffers[0].uri'", "text in quotes"}));
}

TEST_F(GltfFiles, VersionsAreChecked) {
  const auto with = [&](const json& asset) { return glb.with("/asset", asset); };
  for (const json& asset :
       {json{{"version", "2.0"}}, json{{"version", "2.1"}}, json{{"version", "2.1"}, {"minVersion", "2.0"}}})
    EXPECT_TRUE(is_right(load_gltf_bytes(with(asset))));
  const std::vector<test::BrokenFile> refusals = {
      {with({{"version", "1.0"}}), {"key 'asset.version'", "unknown glTF version 1.0"}},
      {with({{"version", "3.0"}}), {"key 'asset.version'", "unknown glTF version 3.0"}},
      {with({{"version", "2.1"}, {"minVersion", "2.1"}}),
       {"key 'asset.minVersion'", "unknown glTF version 2.1: expected 2.0"}},
      {with({{"version", "two"}}), {"key 'asset.version'", "as in 2.0, found 'two'"}},
      {with(json::object()), {"asset.version' is missing"}},
  };
  test::expect_no_models("a.glb", refusals);
}

TEST_F(GltfFiles, UnknownRequiredExtensionsAreRejected) {
  const auto with = [&](const json& names) { return glb.with("/extensionsRequired", names); };
  EXPECT_TRUE(is_right(load_gltf_bytes(with(json::array()))));
  EXPECT_TRUE(is_right(load_gltf_bytes(with({"KHR_gaussian_splatting", "KHR_node_visibility",
                                             "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"}))));
  std::vector<test::BrokenFile> refusals = {
      {with(json::array({7})), {"key 'extensionsRequired[0]'", "text in quotes"}},
      {with("KHR_gaussian_splatting"), {"key 'extensionsRequired'", "expected a list"}}};
  for (const std::string name : {"VENDOR_unknown", "KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                 "KHR_meshopt_compression", "KHR_materials_unlit"}) {
    refusals.push_back({with({"KHR_gaussian_splatting", name}),
                        {"key 'extensionsRequired[1]'", "unknown extension '" + name + "'"}});
    // An unknown extension is ignored if it is used but not required.
    EXPECT_TRUE(is_right(load_gltf_bytes(glb.with("/extensionsUsed", {"KHR_gaussian_splatting", name}))));
  }
  test::expect_no_models("a.glb", refusals);
}

// If a view has compressed and plain bytes, the plain ones are read. Without plain bytes it is an error.
TEST_F(GltfFiles, MeshoptViewsNeedPlainBytes) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    glb = test::gltf_of(model);
    json& view = glb.root["bufferViews"][1];
    view["extensions"][name] = {{"buffer", 0}, {"byteLength", 4}, {"byteStride", 16}, {"count", 10}};
    EXPECT_TRUE(is_right(load_gltf_bytes(glb.bytes())));
    view["buffer"] = 1;
    view["byteOffset"] = 0;
    glb.root["buffers"].push_back({{"byteLength", 160}, {"extensions", {{name, {{"fallback", true}}}}}});
    EXPECT_TRUE(refuses_gltf(glb.bytes(), {"key 'buffers[1]'", "compressed with meshopt"}));
  }
}

TEST_F(GltfFiles, ForeignJsonIsRejected) {
  const json tiles = {{"asset", {{"version", "1.0"}}}, {"root", json::object()}, {"geometricError", 1}};
  // Without buffers all numbers are 0, so no quaternion is valid.
  glb.root.erase("buffers");
  for (json& accessor : glb.root["accessors"]) accessor.erase("bufferView");
  test::expect_no_models("a.gltf",
                         {{tiles.dump(), {"neither a glTF"}}, {glb.root.dump(), {"zero quaternions"}}});
}

TEST_F(GltfFiles, CamerasAreNoModel) {
  for (const char* text : {"[]", R"({"frames": []})", R"({"camera_path": []})"})
    test::expect_no_models("a.json", {{text, {"neither a glTF", "If it has cameras, `cameras` takes it"}}});
}

TEST_F(GltfFiles, OrderProjectionAndColourSpaceAreRead) {
  bool linear = false;
  const auto seen = [&](const json& words) {
    Glb other = glb;
    other.root["meshes"][0]["primitives"][0]["extensions"][test::splatting].update(words);
    const Model model = load_gltf_bytes(other.bytes());
    linear = model.linear;
    return model.perspective;
  };
  const Perspective by_distance{.order = Order::distance};
  EXPECT_EQ(seen({{"sortingMethod", "cameraDistance"}}), by_distance);
  EXPECT_EQ(seen({{"sortingMethod", "zDepth"}, {"projection", "perspective"}}), Perspective{});
  EXPECT_EQ(seen({{"sortingMethod", "zDepth"}, {"projection", "tangential"}}),
            (Perspective{.projection = Projection::tangent}));
  EXPECT_EQ(seen({{"sortingMethod", "byColour"}}), by_distance);  // with a warning
  EXPECT_EQ(seen(json::object()), by_distance);                   // glTF's default
  EXPECT_THROW(seen({{"projection", 3}}), Error);
  EXPECT_FALSE(linear);
  seen({{"colorSpace", "lin_rec709_display"}});
  EXPECT_TRUE(linear);
  seen({{"colorSpace", "srgb_rec709_display"}});
  EXPECT_FALSE(linear);
}

// Drafts of the extension have other words, of which those of other primaries cannot be drawn right.
TEST_F(GltfFiles, DraftsOfColourSpaceAreReadOrNamed) {
  const auto is_linear = [&](const char* word, std::string& said) {
    Glb other = glb;
    other.root["meshes"][0]["primitives"][0]["extensions"][test::splatting]["colorSpace"] = word;
    testing::internal::CaptureStderr();
    const bool linear = load_gltf_bytes(other.bytes()).linear;
    said = testing::internal::GetCapturedStderr();
    return linear;
  };
  std::string said;
  EXPECT_TRUE(is_linear("BT.709-linear", said));
  EXPECT_EQ(said, "");
  for (const char* display : {"srgb_rec709_display", "BT.709", "BT.709-sRGB"}) {
    EXPECT_FALSE(is_linear(display, said)) << display;
    EXPECT_EQ(said, "") << display;
  }
  for (const char* unknown : {"BT.2020-linear", "Display-P3"}) {
    EXPECT_FALSE(is_linear(unknown, said)) << unknown;
    EXPECT_NE(said.find(unknown), std::string::npos) << said;
  }
}

// splat-transform wrote logarithms before version 2.7.0. In a large model none of them may be below 0.
TEST_F(GltfFiles, OldSplatTransformStoresLogarithms) {
  const auto largest = [&](const char* generator) {
    Glb other = glb;
    other.root["asset"]["generator"] = generator;
    return load_gltf_bytes(other.bytes()).scale[0].x;
  };
  const float plain = largest("splat-transform v2.7.0");
  for (const char* newer : {"splat-transform v3.0.1", "splat-transform v10.1.0", "other v2.5.1",
                            "splat-transform v", "splat-transform 2.7.0", "splat-transform 3.2.0"})
    EXPECT_EQ(largest(newer), plain) << newer;
  for (const char* older :
       {"splat-transform v2.5.1", "splat-transform v1.9.0", "splat-transform 2.6.0", "splat-transform 1.8.3"})
    EXPECT_FLOAT_EQ(largest(older), std::exp(plain)) << older;
}

TEST_F(GltfFiles, EqualWarningsAreMerged) {
  json& primitives = glb.root["meshes"][0]["primitives"];
  primitives[0]["extensions"][test::splatting]["sortingMethod"] = "byColour";
  primitives.push_back(primitives[0]);
  primitives.push_back(primitives[0]);
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_gltf_bytes(glb.bytes()).count(), 30u);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.find("'byColour'"), said.rfind("'byColour'")) << said;
  EXPECT_NE(said.find("(3 times)"), std::string::npos) << said;
}

TEST_F(GltfFiles, FilesWithoutGaussiansAreRejected) {
  const std::string primitive = "/meshes/0/primitives/0/";
  Glb mesh = glb;
  mesh.root["meshes"][0]["primitives"][0]["mode"] = 4;
  const std::vector<test::BrokenFile> refusals = {
      {glb.with(primitive + "extensions/KHR_gaussian_splatting/kernel", "box"), {"unknown 'box'"}},
      {glb.with(primitive + "extensions", nullptr),
       {"a glTF scene without visible Gaussians", "0 meshes, 1 points"}},
      {mesh.with(primitive + "extensions", nullptr), {"1 meshes, 0 points"}},
  };
  test::expect_no_models("a.glb", refusals);
}

TEST(GltfSpz, TruncationIsReported) {
  REQUIRE_FIXTURES(folder);
  const Glb spz(test::read_text(folder / "gltf/synthetic-spz2-train-sh3.glb"));
  EXPECT_TRUE(refuses_gltf(spz.with("/bufferViews/0/byteLength", 20000), {"its spz data is cut short"}));
}

// A message counts the meshes and points that are not drawn.
TEST_F(GltfFiles, IgnoredPrimitivesAreReported) {
  json& primitives = glb.root["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", json::object()}});
  primitives.push_back({{"attributes", json::object()}, {"mode", 0}});
  testing::internal::CaptureStderr();
  EXPECT_TRUE(is_right(load_gltf_bytes(glb.bytes())));
  EXPECT_NE(testing::internal::GetCapturedStderr().find("1 meshes and 1 sets of points are ignored"),
            std::string::npos);
}

}  // namespace
}  // namespace binosplat
