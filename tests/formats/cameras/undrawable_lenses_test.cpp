// Lenses with distortion: every camera file format follows the same rule.

#include "formats/cameras/distortion.h"

#include <gtest/gtest.h>

#include "formats/cameras/cameras_file.h"
#include "support/broken.h"
#include "support/program.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::TempFolder;
using test::write_text;

/// Cameras of a file, and the messages while it is read. Of an error, `said` is the text after "error: ".
struct Read {
  std::vector<Camera> cameras;
  std::string said;
};

Read read(const TempFolder& folder) {
  Read read;
  testing::internal::CaptureStderr();
  try {
    read.cameras = load_cameras(folder.path());
    read.said = testing::internal::GetCapturedStderr();
  } catch (const Error& error) {
    read.said = testing::internal::GetCapturedStderr() + "error: " + error.what();
  }
  return read;
}

/// Returns a COLMAP camera of 200 x 100 px with the principal point in the middle and a focal length of 100
/// px.
Read read_colmap(const std::string& model, const std::string& parameters) {
  const TempFolder folder;
  write_text(folder / "cameras.txt", "1 " + model + " 200 100 " + parameters + "\n");
  write_text(folder / "images.txt", "1 1 0 0 0 0 0 0 1 a.jpg\n\n");
  return read(folder);
}

const char* const distorted = "has distortion: compare with undistorted photos";
const std::string one = "100 100 50", two = "100 100 100 50";

TEST(Distortion, ZeroIsPinhole) {
  for (const auto& [model, parameters] :
       std::map<std::string, std::string>{{"SIMPLE_PINHOLE", one},
                                          {"PINHOLE", two},
                                          {"SIMPLE_RADIAL", one + " 0"},
                                          {"RADIAL", one + " 0 0"},
                                          {"OPENCV", two + " 0 0 0 -0.0"},
                                          {"FULL_OPENCV", two + " 0 0 0 0 0 0 0 0"},
                                          {"FOV", two + " 0"},
                                          {"SIMPLE_DIVISION", one + " 0"},
                                          {"DIVISION", two + " 0"}}) {
    const Read found = read_colmap(model, parameters);
    ASSERT_EQ(found.cameras.size(), 1u) << model << found.said;
    EXPECT_EQ(found.said, "") << model;
    const Camera& c = found.cameras[0];
    EXPECT_EQ(glm::dvec4(c.fx, c.fy, c.cx, c.cy), glm::dvec4(100, 100, 100, 50)) << model;
  }
}

TEST(Distortion, CausesWarning) {
  for (const auto& [model, parameters] : {std::pair<const char*, std::string>{"SIMPLE_RADIAL", one + " 0.1"},
                                          {"RADIAL", one + " 0 -0.02"},
                                          {"OPENCV", two + " 0 0 0.01 0"},
                                          {"FULL_OPENCV", two + " 0 0 0 0 0 0 0 0.1"},
                                          {"FOV", two + " 0.9"},
                                          {"EUCM", two + " 0.5 1"},
                                          {"DIVISION", two + " -0.2"},
                                          {"SIMPLE_DIVISION", one + " -0.2"}}) {
    const Read found = read_colmap(model, parameters);
    ASSERT_EQ(found.cameras.size(), 1u) << model << found.said;
    EXPECT_NE(found.said.find("cameras.txt: " + std::string(distorted)), std::string::npos) << found.said;
  }
}

TEST(Distortion, RejectsFisheyesAndPanoramas) {
  for (const auto& [model, parameters] :
       std::map<std::string, std::string>{{"OPENCV_FISHEYE", two + " 0 0 0 0"},
                                          {"SIMPLE_RADIAL_FISHEYE", one + " 0"},
                                          {"RADIAL_FISHEYE", one + " 0 0"},
                                          {"THIN_PRISM_FISHEYE", two + " 0 0 0 0 0 0 0 0"},
                                          {"RAD_TAN_THIN_PRISM_FISHEYE", two + " 0 0 0 0 0 0 0 0 0 0 0 0"},
                                          {"SIMPLE_FISHEYE", one},
                                          {"FISHEYE", two},
                                          {"EQUIRECTANGULAR", "200 100"}}) {
    const Read found = read_colmap(model, parameters);
    EXPECT_TRUE(found.cameras.empty());
    EXPECT_NE(found.said.find("error: "), std::string::npos) << model;
    EXPECT_NE(found.said.find("lens of the model " + model + ", which is not a pinhole"), std::string::npos)
        << found.said;
  }
}

/// Reads the same lens from a transforms.json that has it per file, one that has it per frame, and a
/// cameras.json.
std::vector<Read> read_json(const json& lens) {
  const json rows = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  json root = {
      {"w", 200}, {"h", 100}, {"fl_x", 100}, {"frames", {{{"file_path", "a"}, {"transform_matrix", rows}}}}};
  json of_frame = root;
  root.update(lens);
  of_frame["frames"][0].update(lens);
  json list = {{{"img_name", "a"},
                {"width", 200},
                {"height", 100},
                {"fx", 100},
                {"fy", 100},
                {"position", {0, 0, 0}},
                {"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}};
  list[0].update(lens);
  std::vector<Read> found;
  for (const auto& [name, file] : {std::pair{"transforms.json", root}, std::pair{"transforms.json", of_frame},
                                   std::pair{"cameras.json", list}}) {
    const TempFolder folder;
    write_text(folder / name, file.dump());
    found.push_back(read(folder));
  }
  return found;
}

TEST(Distortion, JsonFollowsSameRule) {
  for (const json& zero : {json{{"k1", 0}, {"k2", 0.0}, {"p1", 0}}, json{{"camera_model", "OPENCV"}},
                           json{{"is_fisheye", false}}, json{{"distortion_params", {0, 0, 0, 0, 0, 0}}}}) {
    for (const Read& found : read_json(zero)) {
      EXPECT_EQ(found.cameras.size(), 1u) << zero;
      EXPECT_EQ(found.said, "") << zero;
    }
  }
  for (const json& lens :
       {json{{"k1", 0.1}}, json{{"k4", 0}, {"k6", 0.1}}, json{{"camera_model", "OPENCV"}, {"p2", 0.01}},
        json{{"distortion_params", {0, 0, 0, 0, 0.01, 0}}}}) {
    for (const Read& found : read_json(lens)) {
      EXPECT_EQ(found.cameras.size(), 1u) << lens << found.said;
      EXPECT_NE(found.said.find(distorted), std::string::npos) << lens << found.said;
    }
  }
  for (const json& other :
       {json{{"camera_model", "OPENCV_FISHEYE"}, {"k1", 0}}, json{{"camera_model", "FISHEYE624"}},
        json{{"camera_model", "EQUIRECTANGULAR"}}, json{{"camera_model", "VR180_L"}},
        json{{"camera_model", "OMNIDIRECTIONALSTEREO_R"}}, json{{"camera_model", "ORTHOPHOTO"}},
        json{{"camera_model", "DOUBLE_SPHERE"}}, json{{"camera_type", "unheard of"}},
        json{{"is_fisheye", true}}, json{{"ftheta_p0", 0.1}}}) {
    for (const Read& found : read_json(other)) {
      EXPECT_TRUE(found.cameras.empty());
      EXPECT_NE(found.said.find("error: "), std::string::npos) << other << found.said;
      EXPECT_NE(found.said.find("only pinhole lenses can be drawn"), std::string::npos) << found.said;
    }
  }
}

TEST(Distortion, SkipsUnsupportedCameras) {
  const TempFolder folder;
  write_text(folder / "cameras.txt", "1 OPENCV_FISHEYE 200 100 " + two + " 0 0 0 0\n2 PINHOLE 200 100 " +
                                         two + "\n3 PINHOLE 200 100 nan 100 100 50\n");
  write_text(folder / "images.txt",
             "1 1 0 0 0 0 0 0 1 a.jpg\n\n2 1 0 0 0 0 0 0 2 b.jpg\n\n3 1 0 0 0 0 0 0 3 c.jpg\n\n");
  const Read found = read(folder);
  ASSERT_EQ(found.cameras.size(), 1u);
  EXPECT_EQ(found.cameras[0].name, "b.jpg");
  EXPECT_NE(found.said.find("2 of 3 cameras are skipped"), std::string::npos) << found.said;
}

}  // namespace
}  // namespace binosplat
