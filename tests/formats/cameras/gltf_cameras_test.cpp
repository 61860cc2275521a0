// The cameras in a glTF's scene.

#include <gtest/gtest.h>

#include <cmath>

#include "formats/cameras/dataparser.h"
#include "scene/axes.h"
#include "support/gltf.h"
#include "support/models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Glb;

struct GltfCameras : testing::Test {
  Glb glb = test::gltf_of(test::random_model(11, 20, 0));

  GltfCameras() {
    glb.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.01}}}},
                           {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}}}}};
    glb.root["nodes"].push_back({{"name", "Shot"}, {"camera", 0}});
    glb.root["scenes"][0]["nodes"].push_back(1);
  }

  std::vector<Camera> load(const std::string& name = "a.glb") const {
    return test::load_cameras_of(name == "a.gltf" ? glb.root.dump() : glb.bytes(), name);
  }
  json& perspective() { return glb.root["cameras"][0]["perspective"]; }
};

// A camera looks along -z with y up. The format's x points left in the world of cameras, and y up.
TEST_F(GltfCameras, LookAlongNegativeZ) {
  glb.node(1)["translation"] = {1, 2, 3};
  for (const char* name : {"a.glb", "a.gltf"}) {
    const std::vector<Camera> cameras = load(name);
    ASSERT_EQ(cameras.size(), 1u);
    const Camera& camera = cameras[0];
    EXPECT_EQ(camera.name, "Shot");
    EXPECT_EQ(camera.position, glm::dvec3(-1, -2, 3));
    EXPECT_EQ(camera.rotation, glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1));
    EXPECT_EQ(glm::ivec2(camera.width, camera.height), glm::ivec2(1280, 720));
    EXPECT_NEAR(camera.fx, 360 / std::tan(0.5), 1e-9);
    EXPECT_EQ(camera.fy, camera.fx);
    EXPECT_EQ(glm::dvec2(camera.cx, camera.cy), glm::dvec2(640, 360));
  }
}

// What a camera sees is independent of how its node and its parents are turned and scaled with the model.
TEST_F(GltfCameras, FollowParentNodes) {
  const double half = std::sqrt(0.5);
  glb.root["nodes"].push_back(
      {{"children", {1, 3}}, {"rotation", {0, half, 0, half}}, {"translation", {5, 0, 0}}});
  glb.root["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 1}}, {"scale", {2, 2, 2}}});
  glb.root["scenes"][0]["nodes"] = {0, 2};
  glb.node(1)["translation"] = {0, 0, -3};
  perspective()["aspectRatio"] = 0.5;
  testing::internal::CaptureStderr();
  const std::vector<Camera> cameras = load();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("rounded or scaled"), std::string::npos);
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].name, "Shot") << "in the scene's order";
  EXPECT_EQ(cameras[1].name, "camera_0");
  EXPECT_EQ(cameras[0].width, 360);
  // The parent turns -z to -x: from (5, 0, 0) by 3 towards -x in the file, which is +x in the world.
  EXPECT_LT(glm::distance(cameras[0].position, glm::dvec3(-2, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(cameras[0].rotation[2], glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(cameras[1].position, glm::dvec3(-6, 0, 0)), 1e-12);
  EXPECT_LT(orthonormality_error(cameras[1].rotation), 1e-12);
}

TEST_F(GltfCameras, BelongToModel) {
  const test::TempFolder folder;
  const fs::path file = folder / "a.glb";
  test::write_text(folder / "cameras.json", "[]");
  test::write_text(file, glb.bytes());
  EXPECT_EQ(find_cameras(file), file);
  EXPECT_EQ(find_cameras(folder.path()), file);
  test::write_text(folder / "a.gltf", glb.root.dump());
  EXPECT_EQ(find_cameras(folder / "a.gltf"), folder / "a.gltf");
  // A model's own cameras are in its world, not in that of the photos.
  test::write_text(folder / "dataparser_transforms.json",
                   R"({"transform": [[1, 0, 0, 9], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": 2})");
  for (const fs::path& own : {file, folder / "a.gltf"}) {
    std::vector<Camera> cameras = load_cameras(own);
    EXPECT_FALSE(move_into_training(folder / "dataparser_transforms.json", own, cameras));
    EXPECT_EQ(cameras[0].position, glm::dvec3(0));
  }
  glb.node(1)["camera"] = 1;
  test::write_text(file, glb.bytes());
  EXPECT_ERROR(load_cameras(file), "a.glb", "camera 'Shot' is orthographic");
  glb.node(1).erase("camera");
  test::write_text(file, glb.bytes());
  EXPECT_EQ(find_cameras(file), folder / "cameras.json");
  EXPECT_ERROR(load_cameras(file), "a.glb", "without cameras");
}

TEST_F(GltfCameras, SkipUnsupportedKinds) {
  glb.root["nodes"].push_back({{"camera", 1}});
  glb.root["nodes"].push_back(
      {{"camera", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  glb.root["scenes"][0]["nodes"] = {0, 1, 2, 3};
  testing::internal::CaptureStderr();
  const std::vector<Camera> cameras = load();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("1 of 3 cameras are skipped"), std::string::npos);
  ASSERT_EQ(cameras.size(), 2u) << "what hides a mesh does not hide a camera";
  // A file without meshes has cameras for another model.
  glb.root.erase("meshes");
  glb.root.erase("buffers");
  glb.root["accessors"] = {{{"min", "unused"}}};
  EXPECT_EQ(load("a.gltf").size(), 2u);
  const std::string text = test::replaced(glb.root.dump(), "\"unused\"", "[NaN, -Infinity]");
  EXPECT_EQ(test::load_cameras_of(text, "a.gltf").size(), 2u);
  test::expect_no_cameras("a.gltf",
                          {{test::replaced(glb.root.dump(), "1.0", "NaN"), {"yfov'", "finite number"}}});
}

TEST_F(GltfCameras, RejectInvalidCameras) {
  const auto with = [&](const std::string& pointer, const json& value) { return glb.with(pointer, value); };
  const std::string lens = "/cameras/0/perspective/";
  test::expect_no_cameras("a.glb",
                          {{with(lens + "yfov", 0), {"'cameras[0].perspective.yfov'", "above 0"}},
                           {with(lens + "yfov", 3.2), {"'cameras[0].perspective.yfov'", "below pi"}},
                           {with(lens + "yfov", nullptr), {"'cameras[0].perspective.yfov' is missing"}},
                           {with(lens + "aspectRatio", -1), {"aspectRatio'", "above 0"}},
                           {with(lens + "aspectRatio", 1e300), {"cannot be drawn"}},
                           {with("/nodes/1/camera", 7), {"'cameras'", "more than 7"}},
                           {with("/nodes/1/scale", {1, 1, -1}), {"'nodes[1]'", "mirrors"}},
                           {with("/nodes/1/scale", {0, 0, 0}), {"'nodes[1]'", "off by 1"}},
                           {with("/cameras/0/type", nullptr), {"'cameras[0].type' is missing"}}});
}

}  // namespace
}  // namespace binosplat
