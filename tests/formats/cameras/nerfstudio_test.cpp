// nerfstudio's camera paths and exported poses.

#include "formats/cameras/nerfstudio.h"

#include <gtest/gtest.h>

#include "formats/cameras/dataparser.h"
#include "formats/pictures/image_file.h"
#include "scene/key_path.h"
#include "support/load.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TempFolder;
using test::write_text;

/// An OpenGL camera at (1, 2, 3) that looks along world x, with world z up and -y to its right.
const json pose_rows = {0, 0, -1, 1, -1, 0, 0, 2, 0, 1, 0, 3, 0, 0, 0, 1};
const json pose_columns = {0, -1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 1, 2, 3, 1};

bool has_expected_view(const Camera& c) {
  return c.position == glm::dvec3(1, 2, 3) && c.rotation[0] == glm::dvec3(0, -1, 0) &&
         c.rotation[1] == glm::dvec3(0, 0, -1) && c.rotation[2] == glm::dvec3(1, 0, 0);
}

json path_of(int frames) {
  json path = {{"camera_type", "perspective"},
               {"render_height", 120},
               {"render_width", 160},
               {"fps", 24},
               {"seconds", 2},
               {"is_cycle", false},
               {"smoothness_value", 0.5},
               {"keyframes", json::array()}};
  for (int i = 0; i < frames; ++i)
    path["camera_path"].push_back({{"camera_to_world", pose_rows}, {"fov", 90}, {"aspect", 1.0}});
  return path;
}

std::vector<Camera> load_path(const json& root) { return test::load_cameras_of(root.dump(), "path.json"); }

TEST(CameraPath, FramesAreViews) {
  json path = path_of(4);
  path["camera_path"][1]["fov"] = 2 * 180 / M_PI * std::atan(0.5);
  const std::vector<Camera> cameras = load_path(path);
  ASSERT_EQ(cameras.size(), 4u);
  EXPECT_EQ(cameras[0].name, "00000");
  EXPECT_EQ(cameras[3].name, "00003");
  for (const Camera& camera : cameras) {
    EXPECT_TRUE(has_expected_view(camera));
    EXPECT_EQ(glm::ivec2(camera.width, camera.height), glm::ivec2(160, 120));
    EXPECT_EQ(glm::dvec2(camera.cx, camera.cy), glm::dvec2(80, 60));
    EXPECT_EQ(camera.fx, camera.fy);
  }
  // The angle is the vertical field of view, whatever `aspect` says.
  EXPECT_NEAR(cameras[0].fx, 60, 1e-9);
  EXPECT_NEAR(cameras[1].fx, 120, 1e-9);
  EXPECT_EQ(cameras[3].time, 1.5);
  // Injected fault: the matrix is read column by column.
  Camera faulty = cameras[0];
  faulty.rotation = glm::transpose(faulty.rotation);
  EXPECT_FALSE(has_expected_view(faulty));

  path.erase("seconds");
  EXPECT_EQ(load_path(path)[3].time, 3.0 / 24);
  EXPECT_FALSE(are_keys(load_path(path)));
  path.erase("fps");
  EXPECT_EQ(load_path(path)[3].time, std::nullopt);
}

TEST(CameraPath, FallsBackToKeyframes) {
  json path = path_of(0);
  path["camera_path"] = json::array();
  path["default_transition_sec"] = 0.5;
  const json list = {{"matrix", pose_rows}, {"fov", 90}, {"aspect", 1.5}};
  json by_columns = list, in_quotes = list, slow = list;
  by_columns["matrix"] = pose_columns;
  in_quotes["matrix"] = pose_columns.dump();
  slow.update({{"override_transition_enabled", true}, {"override_transition_sec", 2}});
  path["keyframes"] = {list, by_columns, in_quotes, slow};
  const std::vector<Camera> cameras = load_path(path);
  ASSERT_EQ(cameras.size(), 4u);
  for (const Camera& camera : cameras) EXPECT_TRUE(has_expected_view(camera)) << camera.name;
  EXPECT_EQ(cameras[3].name, "key_003");
  EXPECT_EQ(cameras[0].time, 0.0);
  EXPECT_EQ(cameras[2].time, 1.0);
  EXPECT_EQ(cameras[3].time, 3.0);
  EXPECT_TRUE(are_keys(cameras));
  // With the camera at the origin, the last row is the same in both orders. A matrix in quotes is stored by
  // columns.
  json turned = pose_rows, turned_in_quotes = pose_columns;
  for (const int i : {3, 7, 11}) turned[i] = 0;
  for (const int i : {12, 13, 14}) turned_in_quotes[i] = 0;
  path["keyframes"] = {list, list};
  path["keyframes"][0]["matrix"] = turned;
  path["keyframes"][1]["matrix"] = turned_in_quotes.dump();
  path.erase("camera_path");
  path.erase("default_transition_sec");
  for (const Camera& camera : load_path(path)) {
    EXPECT_EQ(camera.rotation[2], glm::dvec3(1, 0, 0)) << camera.name;
    EXPECT_EQ(camera.time, std::nullopt);
  }
}

TEST(CameraPath, ErrorsNameKeyAndExpectation) {
  const json path = path_of(2);
  const auto with = [&](const std::string& pointer, const json& value) {
    return test::with_value(path, pointer, value);
  };
  const std::string frame = "/camera_path/1/", matrix = frame + "camera_to_world";
  json keys = path;
  keys.erase("camera_path");
  const json in_quotes = {{{"matrix", "[1, 2]"}, {"fov", 50}}};
  std::vector<test::BrokenFile> refusals = {
      {with("/camera_path", json::array()), {"'keyframes'", "no cameras"}},
      {with("/camera_path", 3), {"'camera_path'", "expected a list"}},
      {with(matrix, nullptr), {"'camera_path[1].camera_to_world' is missing"}},
      {with(matrix + "/0", nullptr), {"camera_path[1].camera_to_world", "expected 16 values, found 15"}},
      {with(matrix + "/5", "x"), {"camera_path[1].camera_to_world[5]", "finite number"}},
      {with(matrix, pose_columns), {"camera_to_world", "row by row, the last of which is 0 0 0 1"}},
      {with(matrix + "/2", -2), {"camera_path[1].camera_to_world", "orthogonal"}},
      {with(matrix + "/2", 1), {"camera_to_world", "mirrors"}},
      {with(frame + "fov", nullptr), {"'camera_path[1].fov' is missing"}},
      {with(frame + "fov", "50"), {"camera_path[1].fov", "finite number"}},
      {with("/seconds", 0), {"'seconds'", "above 0"}},
      {test::with_value(keys, "/keyframes", in_quotes), {"'keyframes[0].matrix'", "a list of 16 numbers"}},
  };
  for (const std::string key : {"render_width", "render_height"}) {
    refusals.push_back({with("/" + key, nullptr), {"'" + key + "' is missing"}});
    refusals.push_back({with("/" + key, 0.5), {key, "expected a whole number"}});
    refusals.push_back({with("/" + key, 0), {"from 1 px"}});
  }
  for (const int fov : {0, 180, -5})
    refusals.push_back({with(frame + "fov", fov), {"'camera_path[1].fov'", "degrees between 0 and 180"}});
  for (const std::string type : {"fisheye", "equirectangular", "omnidirectional", "VR180"})
    refusals.push_back(
        {with("/camera_type", type), {"key 'camera_type'", type, "only pinhole lenses can be drawn"}});
  test::expect_no_cameras("path.json", refusals);
}

json poses() {
  json list;
  for (const char* name : {"images/a.png", "images/b.png"})
    list.push_back({{"file_path", name}, {"transform", {{0, 0, -1, 1}, {-1, 0, 0, 2}, {0, 1, 0, 3}}}});
  return list;
}

TEST(Poses, UseRequestedLens) {
  const TempFolder folder;
  write_text(folder / "transforms_train.json", poses().dump());
  fs::create_directories(folder / "images");
  save_png(folder / "images/b.png", Image(80, 60, 3));
  EXPECT_EQ(find_cameras(folder / "model.ply"), folder / "transforms_train.json");
  EXPECT_TRUE(lacks_lenses(folder.path()));
  const std::vector<Camera> cameras = load_cameras(folder.path());
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].name, "images/a.png");
  for (const Camera& camera : cameras) EXPECT_TRUE(has_expected_view(camera));
  EXPECT_EQ(glm::ivec2(cameras[0].width, cameras[0].height), glm::ivec2(pose_width, pose_height));
  EXPECT_NEAR(cameras[0].fy, 0.5 * pose_height * std::sqrt(3.0), 1e-9) << "60 degrees";
  EXPECT_EQ(glm::ivec2(cameras[1].width, cameras[1].height), glm::ivec2(80, 60)) << "as its photo";
  EXPECT_NEAR(load_cameras(folder.path(), 90.0)[1].fx, 30, 1e-9);
  EXPECT_FALSE(lacks_lenses((write_text(folder / "p.json", path_of(1).dump()), folder / "p.json")));
}

TEST(Poses, ErrorsNameKeyAndExpectation) {
  const auto with = [](const std::string& pointer, const json& value) {
    return test::with_value(poses(), "/1/" + pointer, value);
  };
  const std::vector<test::BrokenFile> refusals = {
      {with("file_path", nullptr), {"'[1].file_path' is missing"}},
      {with("transform", nullptr), {"'[1].transform' is missing"}},
      {with("transform/0", nullptr), {"'[1].transform'", "3 or 4 rows"}},
      {with("transform/0/2", 1), {"'[1].transform'", "mirrors"}},
  };
  test::expect_no_cameras("poses.json", refusals);
}

TEST(Poses, AreInModelWorld) {
  const TempFolder folder;
  write_text(folder / "dataparser_transforms.json",
             R"({"transform": [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": 2})");
  for (const json& root : {poses(), path_of(1)}) {
    write_text(folder / "c.json", root.dump());
    std::vector<Camera> cameras = load_cameras(folder / "c.json");
    EXPECT_FALSE(move_into_training(folder / "dataparser_transforms.json", folder / "c.json", cameras));
    EXPECT_TRUE(has_expected_view(cameras[0]));
  }
}

}  // namespace
}  // namespace binosplat
