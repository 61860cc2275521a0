#include "formats/cameras/cameras_file.h"

#include <gtest/gtest.h>

#include "support/load.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Returns a camera that looks along world x, with world z to its right.
json one_camera() {
  return {{"id", 0},
          {"img_name", "0001"},
          {"width", 640},
          {"height", 480},
          {"position", {1.0, 2.0, 3.0}},
          {"rotation", {{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}},
          {"fy", 500.5},
          {"fx", 501.5}};
}

std::vector<Camera> load_list(const json& list) { return test::load_cameras_of(list.dump(), "cameras.json"); }

TEST(Cameras, ReadAllFields) {
  const std::vector<Camera> cameras = load_list(json::array({one_camera()}));
  ASSERT_EQ(cameras.size(), 1u);
  const Camera& camera = cameras[0];
  EXPECT_EQ(camera.name, "0001");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 501.5);
  EXPECT_EQ(camera.fy, 500.5);
  EXPECT_EQ(camera.cx, 320.0);
  EXPECT_EQ(camera.cy, 240.0);
  EXPECT_EQ(camera.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(camera.rotation[0], glm::dvec3(0, 0, 1));
  EXPECT_EQ(camera.rotation[1], glm::dvec3(0, -1, 0));
  EXPECT_EQ(camera.rotation[2], glm::dvec3(1, 0, 0));
  EXPECT_FALSE(camera.time.has_value());
}

TEST(Cameras, AcceptOptionalKeys) {
  json object = one_camera();
  object.update({{"cx", 300.25}, {"cy", -3}, {"time", 1.5}, {"width", 640.0}, {"note", nullptr}});
  const std::string text = "\xef\xbb\xbf \n" + json::array({object}).dump();
  const Camera camera = test::load_cameras_of(text, "cameras.json")[0];
  EXPECT_EQ(camera.cx, 300.25);
  EXPECT_EQ(camera.cy, -3.0);
  EXPECT_EQ(camera.time, 1.5);
  EXPECT_EQ(camera.width, 640);
}

TEST(Cameras, NamesMayBeNumbers) {
  json list = {one_camera(), one_camera()};
  list[0]["img_name"] = 0;
  list[1]["img_name"] = 117;
  const std::vector<Camera> cameras = load_list(list);
  EXPECT_EQ(cameras[0].name, "0");
  EXPECT_EQ(cameras[1].name, "117");
}

TEST(Cameras, KeepRotationDigits) {
  json object = one_camera();
  object["rotation"] = {{0, 0, 1}, {0.0003, -1.0001, 0}, {0.9999, 0, 0}};
  const Camera camera = load_list(json::array({object}))[0];
  EXPECT_EQ(camera.rotation[0], glm::dvec3(0, 0.0003, 0.9999));
}

TEST(Cameras, ErrorsNameCameraAndKey) {
  json list = {one_camera(), one_camera()};
  list[1]["img_name"] = "0002";
  const auto with = [&](const std::string& key, const json& value) {
    return test::with_value(list, "/1/" + key, value);
  };
  json large = list;
  large[1].update({{"width", 100000}, {"height", 100000}});
  std::vector<test::BrokenFile> refusals = {
      {with("width", 0), {"camera 1 (counted from 0)", "0 x 480 px cannot be drawn"}},
      {with("width", -1), {"camera 1", "'width'", "a whole number", "found -1"}},
      {with("height", 480.5), {"'height'", "a whole number", "found 480.5"}},
      {with("height", 1e10), {"'height'"}},
      {large.dump(), {"camera 1", "cannot be drawn"}},
      {with("fx", 0), {"'fx'", "above 0"}},
      {with("fy", -2), {"'fy'", "above 0"}},
      {with("fx", "500"), {"'fx'", "finite number"}},
      {with("cx", "x"), {"'cx'", "finite number"}},
      {with("time", "x"), {"'time'", "finite number"}},
      {with("img_name", 7.5), {"'img_name'", "in quotes"}},
      {with("img_name", true), {"'img_name'", "in quotes"}},
      {with("position", {1, 2}), {"'position'", "expected 3 values"}},
      {with("position", {1, 2, true}), {"'position[2]'", "finite number"}},
      {with("rotation", {{1, 0, 0}, {0, 1, 0}}), {"'rotation'", "expected 3 values"}},
      {with("rotation", {{1, 0}, {0, 1}, {0, 0}}), {"'rotation[0]'", "expected 3 values"}},
      {with("rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}), {"'rotation'", "off by 0.75"}},
      {with("rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}), {"'rotation'", "mirrors"}},
  };
  for (const std::string key : {"img_name", "width", "height", "position", "rotation", "fx", "fy"})
    refusals.push_back({with(key, nullptr), {"camera 1", "'" + key + "' is missing"}});
  test::expect_no_cameras("cameras.json", refusals);
}

TEST(Cameras, RejectInvalidFiles) {
  std::string wide = "[[]";
  for (int i = 0; i < 300; ++i) wide += ",[{}]";
  const std::vector<test::BrokenFile> refusals = {
      {"[]", {"holds no cameras"}},
      {"[1]", {"camera 0", "expected an object"}},
      {one_camera().dump(), {"expected a list", "object"}},
      {"7", {"expected a list", "number"}},
      {"[\n{\"a\": 1},\n]", {"not valid JSON at line 3, byte 13"}},
      {"[{", {"line 1"}},
      {"", {"an empty file"}},
      {"<html>", {"line 1, byte 1", "an HTML or XML page"}},
      {"[1e999]", {"not valid JSON"}},
      {"[\n" + std::string(300000, '['), {"nested more than 500 deep, at line 2, byte 502"}},
      // Brackets in quotes and brackets that are closed again do not count.
      {"[\"\\\"" + std::string(300, '[') + "\"]", {"camera 0", "expected an object"}},
      {wide + "]", {"camera 0", "expected an object"}},
  };
  test::expect_no_cameras("cameras.json", refusals);
  EXPECT_ERROR(load_cameras("/nowhere/cameras.json"), "/nowhere", "No such file");
}

TEST(Cameras, AreFoundNearModel) {
  const test::TempFolder folder;
  const fs::path inria = folder / "garden/point_cloud/iteration_30000";
  fs::create_directories(inria);
  EXPECT_FALSE(find_cameras(inria / "point_cloud.ply").has_value());
  test::write_text(folder / "garden/cameras.json", "[]");
  EXPECT_EQ(find_cameras(inria / "point_cloud.ply"), folder / "garden/cameras.json");
  EXPECT_EQ(find_cameras(folder / "garden/model.ply"), folder / "garden/cameras.json");
  test::write_text(inria / "cameras.json", "[]");
  EXPECT_EQ(find_cameras(inria / "point_cloud.ply"), inria / "cameras.json");
  fs::create_directories(folder / "garden/a/b");
  EXPECT_FALSE(find_cameras(folder / "garden/a/b/model.ply").has_value());
}

}  // namespace
}  // namespace binosplat
