// transforms.json of instant-ngp, nerfstudio and Blender's NeRF scenes.

#include <gtest/gtest.h>

#include "base/image.h"
#include "formats/cameras_file.h"
#include "formats/image_file.h"
#include "support/broken.h"
#include "support/fixtures.h"
#include "support/truth.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Copy;
using test::near3;

bool agrees_in_pose(const Camera& camera, const json& truth) {
  return near3(camera.position, truth["center"], 1e-6, 1e-6) &&
         near3(camera.rotation[2], truth["forward"], 1e-6) && near3(-camera.rotation[1], truth["up"], 1e-6);
}

TEST(Transforms, AgreeWithAnIndependentReader) {
  REQUIRE_FIXTURES(folder);
  const json truth = test::load_json(folder / "truth.json")["cameras"];
  for (const char* name :
       {"cameras/brush-test-transforms.json", "cameras/synthetic-nerfstudio-transforms.json"}) {
    const std::vector<Camera> cameras = load_cameras(folder / name);
    ASSERT_EQ(cameras.size(), truth[name]["count"].get<std::size_t>()) << name;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const json& expected = truth[name]["cameras"][i];
      const Camera& camera = cameras[i];
      EXPECT_EQ(camera.name, expected["name"].get<std::string>());
      EXPECT_TRUE(agrees_in_pose(camera, expected)) << camera.name;
      for (const auto& [key, value] : std::map<std::string, double>{{"fx", camera.fx},
                                                                    {"fy", camera.fy},
                                                                    {"cx", camera.cx},
                                                                    {"cy", camera.cy},
                                                                    {"width", camera.width},
                                                                    {"height", camera.height}})
        EXPECT_EQ(value, expected[key].get<double>()) << name << " " << key;
      // Planted fault: OpenGL's axes taken for ours.
      Camera faulty = camera;
      faulty.rotation = glm::dmat3(camera.rotation[0], -camera.rotation[1], -camera.rotation[2]);
      EXPECT_FALSE(agrees_in_pose(faulty, expected));
    }
  }
}

TEST(Transforms, SizesComeFromThePictureBeside) {
  REQUIRE_FIXTURES(folder);
  const test::TempFolder temporary;
  const fs::path file = temporary / "transforms_train.json";
  fs::copy(folder / "cameras/blender-lego-transforms_train.json", file);
  EXPECT_TRUE(test::fails_saying([&] { load_cameras(file); },
                                 {"key 'frames[0]'", "no w and h, and no picture", "train/r_0"}));
  save_png((fs::create_directories(temporary / "train"), temporary / "train/r_0.png"), Image(80, 60, 3));
  const Camera camera = load_cameras(file)[0];
  EXPECT_EQ(camera.width, 80);
  EXPECT_EQ(camera.height, 60);
  EXPECT_NEAR(camera.fx, 40 / std::tan(0.5 * 0.6911112070083618), 1e-9);
  EXPECT_EQ(camera.fy, camera.fx);
  EXPECT_EQ(camera.cx, 40.0);
  const json truth =
      test::load_json(folder / "truth.json")["cameras"]["cameras/blender-lego-transforms_train.json"];
  EXPECT_TRUE(agrees_in_pose(camera, truth["cameras"][0]));
  EXPECT_EQ(find_cameras(temporary / "model.ply"), file);
  EXPECT_EQ(find_photos(file), temporary.path());
}

TEST(Transforms, OfTheFileOrOfTheFrame) {
  const test::TempFolder folder;
  const json matrix = {{1, 0, 0, 5}, {0, 1, 0, 6}, {0, 0, 1, 7}, {0, 0, 0, 1}};
  json root = {{"w", 100.0},
               {"h", 50},
               {"x_fov", 90.0},
               {"cx", 48.5},
               {"frames",
                {{{"file_path", "a"}, {"transform_matrix", matrix}},
                 {{"file_path", "b"},
                  {"w", 200},
                  {"fl_x", 77},
                  {"camera_angle_y", 1.0},
                  {"transform_matrix", matrix}}}}};
  test::write_text(folder / "t.json", root.dump());
  const std::vector<Camera> cameras = load_cameras(folder / "t.json");
  EXPECT_EQ(cameras[0].width, 100);
  EXPECT_NEAR(cameras[0].fx, 50.0, 1e-12);
  EXPECT_NEAR(cameras[0].fy, 50.0, 1e-12);
  EXPECT_EQ(cameras[0].cx, 48.5);
  EXPECT_EQ(cameras[0].cy, 25.0);
  EXPECT_EQ(cameras[1].width, 200);
  EXPECT_EQ(cameras[1].fx, 77.0);
  EXPECT_EQ(cameras[1].fy, 77.0);
  EXPECT_EQ(cameras[1].position, glm::dvec3(5, 6, 7));
}

TEST(Transforms, Errors) {
  REQUIRE_FIXTURES(folder);
  const auto edited = [&](auto edit, std::initializer_list<std::string> parts) {
    const Copy copy(folder / "cameras/brush-test-transforms.json");
    copy.edit("", edit);
    if (auto named = test::fails_saying([&] { load_cameras(copy.path()); }, {"brush-test-transforms.json"});
        !named)
      return named;
    return test::fails_saying([&] { load_cameras(copy.path()); }, parts);
  };
  const auto frame = [](json& root) -> json& { return root["frames"][0]; };
  EXPECT_TRUE(edited([&](json& r) { r["frames"] = json::array(); }, {"key 'frames'", "no cameras"}));
  EXPECT_TRUE(edited([&](json& r) { r["frames"] = 1; }, {"key 'frames'", "expected a list"}));
  EXPECT_TRUE(edited([&](json& r) { r["frames"] = {1}; }, {"key 'frames[0]'", "expected an object"}));
  EXPECT_TRUE(edited(
      [&](json& r) {
        frame(r)["transform_matrix"] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      },
      {"key 'frames[0].transform_matrix[0]'", "expected 4 values, found 3"}));
  EXPECT_TRUE(edited(
      [&](json& r) {
        frame(r)["transform_matrix"].erase(0);
        frame(r)["transform_matrix"].erase(0);
      },
      {"expected 3 or 4 rows"}));
  EXPECT_TRUE(edited([&](json& r) { frame(r)["transform_matrix"][0][0] = 0.1; },
                     {"transform_matrix'", "orthogonal"}));
  EXPECT_TRUE(edited(
      [&](json& r) {
        for (int i = 0; i < 3; ++i)
          frame(r)["transform_matrix"][i][0] = -frame(r)["transform_matrix"][i][0].get<double>();
      },
      {"transform_matrix'", "mirrors"}));
  EXPECT_TRUE(edited(
      [&](json& r) {
        for (const char* k : {"fl_x", "fl_y", "camera_angle_x", "camera_angle_y"}) frame(r).erase(k);
      },
      {"key 'frames[0]'", "neither fl_x nor camera_angle_x"}));
  EXPECT_TRUE(edited([&](json& r) { frame(r)["w"] = 0; }, {"frame 'train/r_0.png'", "0 x 50 px"}));
  EXPECT_TRUE(edited([&](json& r) { frame(r)["h"] = 50.5; }, {"key 'frames[0].h'", "whole number"}));
  EXPECT_TRUE(edited([&](json& r) { frame(r)["fl_x"] = "50"; }, {"key 'frames[0].fl_x'", "finite number"}));
  EXPECT_TRUE(edited([&](json& r) { frame(r)["fl_x"] = -50; }, {"focal lengths of -50"}));
  EXPECT_TRUE(edited([&](json& r) { r["camera_model"] = "OPENCV_FISHEYE"; },
                     {"key 'camera_model'", "only pinhole lenses"}));
  EXPECT_TRUE(edited([&](json& r) { r["is_fisheye"] = true; }, {"key 'is_fisheye'", "only pinhole lenses"}));
  EXPECT_TRUE(
      edited([&](json& r) { frame(r).erase("file_path"); }, {"key 'frames[0].file_path' is missing"}));
}

TEST(Transforms, WarnOfDistortion) {
  REQUIRE_FIXTURES(folder);
  const auto said = [&](const char* name) {
    testing::internal::CaptureStderr();
    load_cameras(folder / "cameras" / name);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_NE(said("synthetic-nerfstudio-transforms.json").find("lenses are distorted"), std::string::npos);
  EXPECT_EQ(said("brush-test-transforms.json"), "");
}

}  // namespace
}  // namespace binosplat
