// Cameras whose rotations are rounded or scaled, in every format, and JSON with NaN.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "formats/cameras/lens.h"
#include "support/load.h"
#include "support/models.h"
#include "support/ply.h"

namespace binosplat {
namespace {

using nlohmann::json;

const glm::dmat3 turned(glm::rotate(glm::dmat4(1.0), 0.4, glm::normalize(glm::dvec3(1, 2, 3))));

glm::dmat3 rounded_to(const glm::dmat3& of, double step) {
  glm::dmat3 result;
  for (int c = 0; c < 3; ++c) result[c] = glm::round(of[c] / step) * step;
  return result;
}

double largest(const glm::dmat3& a, const glm::dmat3& b) {
  double most = 0.0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) most = std::max(most, std::abs(a[c][r] - b[c][r]));
  return most;
}

struct Made {
  glm::dmat3 rotation;
  std::string fault, said;
};

Made made_of(const glm::dmat3& columns) {
  Made made{columns, {}, {}};
  testing::internal::CaptureStderr();
  made.fault = make_rotation("a.json", made.rotation);
  made.said = testing::internal::GetCapturedStderr();
  return made;
}

TEST(MakeRotation, FindsNearestRotation) {
  EXPECT_EQ(made_of(turned).rotation, turned) << "a rotation stays to the bit";
  const glm::dmat3 shrink = glm::dmat3(1.1, 0, 0, 0, 0.9, 0, 0, 0, 1.3);
  for (const glm::dmat3& columns :
       {2.0 * turned, 0.01 * turned, 1e6 * turned, turned * shrink, rounded_to(turned, 0.03)}) {
    const Made made = made_of(columns);
    EXPECT_EQ(made.fault, "");
    EXPECT_LT(largest(glm::transpose(made.rotation) * made.rotation, glm::dmat3(1.0)), 1e-12);
    EXPECT_LT(largest(made.rotation, turned), 0.02);
    EXPECT_NE(made.said.find("warning: a.json: a camera's axes are rounded or scaled"), std::string::npos);
  }
  // No matrix near the rounded one is nearer than the result, as the first axis kept (Gram-Schmidt) would be.
  const glm::dmat3 given = rounded_to(turned, 0.03), nearest = made_of(given).rotation;
  const auto apart = [&](const glm::dmat3& of) {
    const glm::dmat3 d = of - given;
    return glm::dot(d[0], d[0]) + glm::dot(d[1], d[1]) + glm::dot(d[2], d[2]);
  };
  const glm::dvec3 x = glm::normalize(given[0]), z = glm::normalize(glm::cross(x, given[1]));
  EXPECT_GT(apart(glm::dmat3(x, glm::cross(z, x), z)), 1.05 * apart(nearest));
  const Made fine = made_of(rounded_to(turned, 0.005));
  EXPECT_NE(fine.rotation, rounded_to(turned, 0.005));
  EXPECT_EQ(fine.said, "") << "half a hundredth is no warning";
}

TEST(MakeRotation, RejectsNonRotations) {
  const auto with_first = [](const glm::dvec3& x) { return glm::dmat3(x, turned[1], turned[2]); };
  EXPECT_NE(made_of(with_first(-turned[0])).fault.find("mirrors"), std::string::npos);
  EXPECT_NE(made_of(-3.0 * turned).fault.find("mirrors"), std::string::npos);
  EXPECT_NE(made_of(with_first({0, 0, 0})).fault.find("off by 1"), std::string::npos);
  EXPECT_NE(made_of(glm::dmat3(0.0)).fault.find("off by 1"), std::string::npos);
  EXPECT_NE(made_of(with_first(turned[0] + 0.2 * turned[1])).fault.find("orthogonal"), std::string::npos);
  EXPECT_NE(made_of(with_first(0.5 * turned[0])).fault.find("off by 0.75"), std::string::npos);
  EXPECT_NE(made_of(with_first({NAN, 0, 0})).fault.find("finite"), std::string::npos);
  EXPECT_EQ(made_of(with_first(turned[0] + 0.05 * turned[1])).fault, "");
  EXPECT_EQ(made_of(-3.0 * turned).said, "") << "an error is no warning";
}

json rows_of(const glm::dmat3& columns) {
  json rows;
  for (int r = 0; r < 3; ++r) rows.push_back({columns[0][r], columns[1][r], columns[2][r]});
  return rows;
}

json pose_of(const glm::dmat3& columns) {
  json rows = rows_of(columns);
  for (int r = 0; r < 3; ++r) rows[static_cast<std::size_t>(r)].push_back(r + 1.0);
  rows.push_back({0, 0, 0, 1});
  return rows;
}

/// The files of each format with a camera that has these axes, of OpenGL or not, at (1, 2, 3).
std::vector<std::pair<std::string, std::string>> files_with(const glm::dmat3& axes) {
  const glm::dmat3 opengl(axes[0], -axes[1], -axes[2]);
  json sixteen, rows = pose_of(opengl);
  rows.erase(3);
  for (const json& row : pose_of(opengl))
    for (const json& number : row) sixteen.push_back(number);
  const json frame = {{"file_path", "a"}, {"transform_matrix", pose_of(opengl)}};
  return {{"cameras.json", json::array({{{"img_name", "a"},
                                         {"width", 64},
                                         {"height", 48},
                                         {"fx", 50},
                                         {"fy", 50},
                                         {"position", {1, 2, 3}},
                                         {"rotation", rows_of(axes)}}})
                               .dump()},
          {"transforms.json", json{{"w", 64}, {"h", 48}, {"fl_x", 50}, {"frames", {frame, frame}}}.dump()},
          {"path.json", json{{"render_width", 64},
                             {"render_height", 48},
                             {"camera_path", {{{"camera_to_world", sixteen}, {"fov", 60}}}}}
                            .dump()},
          {"poses.json", json::array({{{"file_path", "a"}, {"transform", rows}}}).dump()}};
}

TEST(RoundedRotations, AreReadFromEveryFormat) {
  for (const glm::dmat3& axes : {rounded_to(turned, 0.03), 2.0 * turned}) {
    for (const auto& [name, text] : files_with(axes)) {
      testing::internal::CaptureStderr();
      const std::vector<Camera> cameras = test::load_cameras_of(text, name);
      const std::string said = testing::internal::GetCapturedStderr();
      EXPECT_EQ(cameras[0].position, glm::dvec3(1, 2, 3)) << name;
      EXPECT_LT(largest(cameras[0].rotation, turned), 0.02) << name;
      EXPECT_EQ(rotation_fault(cameras[0].rotation), "") << name;
      const std::size_t at = said.find("rounded or scaled");
      EXPECT_NE(at, std::string::npos) << name << said;
      EXPECT_EQ(said.find("rounded or scaled", at + 1), std::string::npos) << "once for a file: " << said;
    }
  }
  for (const auto& [name, text] : files_with(glm::dmat3(0.0)))
    test::expect_no_cameras(name, {{text, {"off by 1"}}});
}

/// A SHARP ply stores world-to-camera, so that a scale moves the camera's position unless it is undone.
TEST(RoundedRotations, KeepPositionInPly) {
  const auto load = [](const glm::dmat3& axes, const glm::dvec3& shift) {
    test::PlyFile file = test::inria_file(0, 5);
    const auto add = [&](const std::string& name, const std::vector<double>& numbers) {
      file.header_after += fmt::format("element {0} {1}\nproperty double {0}\n", name, numbers.size());
      for (const double number : numbers)
        test::append_value(file.data_after, "binary_little_endian", "double", number);
    };
    std::vector<double> numbers;
    for (int r = 0; r < 3; ++r) numbers.insert(numbers.end(), {axes[r].x, axes[r].y, axes[r].z, shift[r]});
    numbers.insert(numbers.end(), {0, 0, 0, 1});
    add("extrinsic", numbers);
    add("intrinsic", {50, 50, 64, 48});
    return test::load_cameras_of(to_bytes(file), "a.ply")[0];
  };
  const glm::dvec3 shift = glm::transpose(turned) * -glm::dvec3(1, 2, 3);
  for (const double scale : {1.0, 2.0}) {
    const Camera camera = load(scale * turned, scale * shift);
    EXPECT_LT(glm::distance(camera.position, glm::dvec3(1, 2, 3)), 1e-9) << scale;
    EXPECT_LT(largest(camera.rotation, turned), 1e-9) << scale;
  }
}

TEST(JsonNaN, AffectsOnlyUsedKeys) {
  const auto files = files_with(turned);
  for (const char* word : {"NaN", "Infinity", "-Infinity", "nan", "-nan", "inf", "-inf"}) {
    for (const auto& [name, text] : files) {
      const std::size_t object = text.find('{') + 1;
      const std::string unused = fmt::format("\"no{}t \\\" e\": [{}, {{\"b\": {}}}],", word, word, word);
      const std::vector<Camera> cameras =
          test::load_cameras_of(std::string(text).insert(object, unused), name);
      EXPECT_LT(largest(cameras[0].rotation, turned), 1e-9) << name;
    }
    const std::string key = fmt::format("\"cx\": {},", word), list = files[0].second,
                      frames = files[1].second;
    test::expect_no_cameras("cameras.json",
                            {{std::string(list).insert(2, key), {"camera 0", "'cx'", "a finite number"}}});
    test::expect_no_cameras("transforms.json",
                            {{std::string(frames).insert(1, key), {"'cx'", "a finite number"}}});
  }
  // In quotes a word is text, and faults behind it keep their place.
  EXPECT_EQ(
      test::load_cameras_of(test::replaced(files[1].second, "\"a\"", "\"NaN inf\""), "transforms.json")[0]
          .name,
      "NaN inf");
  test::expect_no_cameras("cameras.json", {{"[\n{\"a\": NaN, \"b\": -Infinity},\n]", {"line 3, byte 31"}},
                                           {"[{\"a\": NaNa}]", {"line 1, byte 11"}},
                                           {"[{\"a\": undefined}]", {"line 1, byte 8"}}});
}

}  // namespace
}  // namespace binosplat
