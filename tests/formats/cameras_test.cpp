#include "formats/cameras_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/errors.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A camera that looks along world x, with its right along world z.
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

std::vector<Camera> load_list(const std::string& text) {
  const test::TempFolder folder;
  test::write_text(folder / "cameras.json", text);
  return load_cameras(folder / "cameras.json");
}

testing::AssertionResult refuses_list(const std::string& text, std::initializer_list<std::string> parts) {
  if (auto named = test::fails_saying([&] { load_list(text); }, {"cameras.json"}); !named) return named;
  return test::fails_saying([&] { load_list(text); }, parts);
}

/// The second of two cameras is changed by a JSON merge patch.
testing::AssertionResult refuses_with(const json& change, std::initializer_list<std::string> parts) {
  json list = json::array({one_camera(), one_camera()});
  list[1]["img_name"] = "0002";
  list[1].merge_patch(change);
  return refuses_list(list.dump(), parts);
}

TEST(Cameras, AreReadAsTheyStand) {
  const std::vector<Camera> cameras = load_list(json::array({one_camera()}).dump());
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

TEST(Cameras, ColumnsAreTheAxes) {
  // A turn about y by 90 degrees: its rows and columns differ.
  json object = one_camera();
  object["rotation"] = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  const Camera camera = load_list(json::array({object}).dump())[0];
  EXPECT_EQ(camera.rotation[2], glm::dvec3(1, 0, 0));
  EXPECT_NE(glm::transpose(camera.rotation)[2], glm::dvec3(1, 0, 0));  // the planted fault
}

TEST(Cameras, MayHavePrincipalPointTimeAndMore) {
  json object = one_camera();
  object.update({{"cx", 300.25}, {"cy", -3}, {"time", 1.5}, {"width", 640.0}, {"note", nullptr}});
  const Camera camera = load_list("\xef\xbb\xbf \n" + json::array({object}).dump())[0];
  EXPECT_EQ(camera.cx, 300.25);
  EXPECT_EQ(camera.cy, -3.0);
  EXPECT_EQ(camera.time, 1.5);
  EXPECT_EQ(camera.width, 640);
}

TEST(Cameras, RotationsAreKeptToTheDigit) {
  json object = one_camera();
  object["rotation"] = {{0, 0, 1}, {0.0003, -1.0001, 0}, {0.9999, 0, 0}};
  const Camera camera = load_list(json::array({object}).dump())[0];
  EXPECT_EQ(camera.rotation[0], glm::dvec3(0, 0.0003, 0.9999));
}

TEST(Cameras, ErrorsNameTheCameraAndTheKey) {
  EXPECT_TRUE(refuses_with({{"width", 0}}, {"camera 1 (counted from 0)", "0 x 480 px cannot be drawn"}));
  EXPECT_TRUE(refuses_with({{"width", -1}}, {"camera 1", "'width'", "a whole number", "found -1"}));
  EXPECT_TRUE(refuses_with({{"height", 480.5}}, {"'height'", "a whole number", "found 480.5"}));
  EXPECT_TRUE(refuses_with({{"height", 1e10}}, {"'height'"}));
  EXPECT_TRUE(refuses_with({{"width", 100000}, {"height", 100000}}, {"camera 1", "cannot be drawn"}));
  EXPECT_TRUE(refuses_with({{"fx", 0}}, {"'fx'", "above 0"}));
  EXPECT_TRUE(refuses_with({{"fy", -2}}, {"'fy'", "above 0"}));
  EXPECT_TRUE(refuses_with({{"fx", "500"}}, {"'fx'", "finite number"}));
  EXPECT_TRUE(refuses_with({{"cx", "x"}}, {"'cx'", "finite number"}));
  EXPECT_TRUE(refuses_with({{"time", "x"}}, {"'time'", "finite number"}));
  EXPECT_TRUE(refuses_with({{"img_name", 7}}, {"'img_name'", "in quotes"}));
  EXPECT_TRUE(refuses_with({{"position", {1, 2}}}, {"'position'", "expected 3 values"}));
  EXPECT_TRUE(refuses_with({{"position", {1, 2, true}}}, {"'position[2]'", "finite number"}));
  EXPECT_TRUE(refuses_with({{"rotation", {{1, 0, 0}, {0, 1, 0}}}}, {"'rotation'", "expected 3 values"}));
  EXPECT_TRUE(refuses_with({{"rotation", {{1, 0}, {0, 1}, {0, 0}}}}, {"'rotation[0]'", "expected 3 values"}));
  EXPECT_TRUE(
      refuses_with({{"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}}}, {"'rotation'", "off by 0.75"}));
  EXPECT_TRUE(refuses_with({{"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}}}, {"'rotation'", "mirrors"}));
  for (const char* key : {"img_name", "width", "height", "position", "rotation", "fx", "fy"}) {
    EXPECT_TRUE(refuses_with({{key, nullptr}}, {"camera 1", fmt::format("'{}' is missing", key)}));
  }
}

TEST(Cameras, ErrorsOfTheWholeFile) {
  EXPECT_TRUE(refuses_list("[]", {"holds no cameras"}));
  EXPECT_TRUE(refuses_list("[1]", {"camera 0", "expected an object"}));
  EXPECT_TRUE(refuses_list(one_camera().dump(), {"expected a list", "object"}));
  EXPECT_TRUE(refuses_list("7", {"expected a list", "number"}));
  EXPECT_TRUE(refuses_list("[\n{\"a\": 1},\n]", {"not valid JSON at line 3, byte 13"}));
  EXPECT_TRUE(refuses_list("[{", {"line 1"}));
  EXPECT_TRUE(refuses_list("", {"an empty file"}));
  EXPECT_TRUE(refuses_list("<html>", {"line 1, byte 1", "an HTML or XML page"}));
  EXPECT_TRUE(refuses_list("[1e999]", {"not valid JSON"}));
  EXPECT_TRUE(
      refuses_list("[\n" + std::string(300000, '['), {"nested more than 500 deep, at line 2, byte 502"}));
  // Neither brackets in quotes nor those that are closed again count.
  EXPECT_TRUE(refuses_list("[\"\\\"" + std::string(300, '[') + "\"]", {"camera 0", "expected an object"}));
  std::string wide = "[[]";
  for (int i = 0; i < 300; ++i) wide += ",[{}]";
  EXPECT_TRUE(refuses_list(wide + "]", {"camera 0", "expected an object"}));
  EXPECT_TRUE(
      test::fails_saying([] { load_cameras("/nowhere/cameras.json"); }, {"/nowhere", "No such file"}));
}

TEST(Cameras, AreFoundBesideTheModel) {
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
