// transforms.json of instant-ngp, nerfstudio and Blender's NeRF scenes.

#include <gtest/gtest.h>

#include "base/image.h"
#include "formats/pictures/image_file.h"
#include "support/fixtures.h"
#include "support/load.h"
#include "support/truth.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::near3;

bool agrees_in_pose(const Camera& camera, const json& truth) {
  return near3(camera.position, truth["center"], 1e-6, 1e-6) &&
         near3(camera.rotation[2], truth["forward"], 1e-6) && near3(-camera.rotation[1], truth["up"], 1e-6);
}

TEST(Transforms, MatchIndependentReader) {
  REQUIRE_FIXTURES(folder);
  const json truth = test::load_json(folder / "truth.json")["cameras"];
  for (const char* name :
       {"cameras/brush-test-transforms.json", "cameras/synthetic-nerfstudio-transforms.json"}) {
    testing::internal::CaptureStderr();
    const std::vector<Camera> cameras = load_cameras(folder / name);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(said.find("has distortion") != std::string::npos, name[8] == 's') << said;
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
      // Injected fault: the camera axes of OpenGL are not converted to ours.
      Camera faulty = camera;
      faulty.rotation = glm::dmat3(camera.rotation[0], -camera.rotation[1], -camera.rotation[2]);
      EXPECT_FALSE(agrees_in_pose(faulty, expected));
    }
  }
}

TEST(Transforms, SizesComeFromPicture) {
  REQUIRE_FIXTURES(folder);
  const test::TempFolder temporary;
  const fs::path file = temporary / "transforms_train.json";
  fs::copy(folder / "cameras/blender-lego-transforms_train.json", file);
  EXPECT_ERROR(load_cameras(file), "key 'frames[0]'", "w and h are missing, and so is the picture",
               "train/r_0");
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

TEST(Transforms, FrameOverridesFile) {
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

TEST(Transforms, FaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const json good = test::load_json(folder / "cameras/brush-test-transforms.json");
  const auto with = [&](const std::string& pointer, const json& value) {
    return test::with_value(good, pointer, value);
  };
  const std::string frame = "/frames/0/", matrix = frame + "transform_matrix";
  json mirrored = good, without_lens = good;
  for (json& row : mirrored["frames"][0]["transform_matrix"]) row[0] = -row[0].get<double>();
  for (const char* key : {"fl_x", "fl_y", "camera_angle_x", "camera_angle_y"})
    without_lens["frames"][0].erase(key);
  const std::vector<test::BrokenFile> refusals = {
      {with("/frames", json::array()), {"key 'frames'", "no cameras"}},
      {with("/frames", 1), {"key 'frames'", "expected a list"}},
      {with("/frames", json::array({1})), {"key 'frames[0]'", "expected an object"}},
      {with(matrix, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
       {"transform_matrix[0]'", "expected 4 values, found 3"}},
      {with(matrix, {{1, 0, 0, 0}, {0, 1, 0, 0}}), {"expected 3 or 4 rows"}},
      {with(matrix + "/0/0", 0.1), {"transform_matrix'", "orthogonal"}},
      {mirrored.dump(), {"transform_matrix'", "mirrors"}},
      {without_lens.dump(), {"key 'frames[0]'", "neither fl_x nor camera_angle_x"}},
      {with(frame + "w", 0), {"frame 'train/r_0.png'", "0 x 50 px"}},
      {with(frame + "h", 50.5), {"key 'frames[0].h'", "whole number"}},
      {with(frame + "fl_x", "50"), {"key 'frames[0].fl_x'", "finite number"}},
      {with(frame + "fl_x", -50), {"focal lengths of -50"}},
      {with("/camera_model", "OPENCV_FISHEYE"), {"key 'camera_model'", "only pinhole lenses"}},
      {with("/is_fisheye", true), {"key 'is_fisheye'", "only pinhole lenses"}},
      {with(frame + "file_path", nullptr), {"key 'frames[0].file_path' is missing"}},
  };
  test::expect_no_cameras("transforms.json", refusals);
}

}  // namespace
}  // namespace binosplat
