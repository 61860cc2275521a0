// Cameras in ply files of SHARP.

#include "formats/cameras/ply_camera.h"

#include <gtest/gtest.h>

#include "formats/cameras/dataparser.h"
#include "formats/models/ply.h"
#include "support/load.h"
#include "support/ply.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::PlyFile;
using test::TempFolder;
using test::write_text;
using Numbers = std::vector<double>;

struct Element {
  std::string name, type;
  Numbers numbers;
};

/// Returns a model with further elements behind its vertices, with one number per row.
PlyFile with_elements(const std::vector<Element>& elements,
                      const std::string& format = "binary_little_endian") {
  PlyFile file = test::inria_file(0, 5);
  file.format = format;
  for (const Element& e : elements) {
    file.header_after +=
        fmt::format("element {} {}\nproperty {} {}\n", e.name, e.numbers.size(), e.type, e.name);
    for (const double number : e.numbers) {
      if (e.type == "uint" && format != "ascii")
        test::append_bytes(file.data_after, static_cast<std::uint32_t>(number),
                           format == "binary_big_endian");
      else
        test::append_value(file.data_after, format, e.type == "uint" ? "double" : e.type, number);
      if (format == "ascii") file.data_after += "\n";
    }
  }
  return file;
}

const Numbers intrinsic = {500, 0, 320.5, 0, 510, 200.25, 0, 0, 1};
/// World to camera, row by row. The camera is at (1, 2, 3), with right along -y, down along -z, and forward
/// along x.
const Numbers extrinsic = {0, -1, 0, 2, 0, 0, -1, 3, 1, 0, 0, -1, 0, 0, 0, 1};

/// Returns the elements as SHARP 1.5 writes them.
std::vector<Element> sharp() {
  return {{"extrinsic", "float", extrinsic},  {"intrinsic", "float", intrinsic},
          {"image_size", "uint", {640, 400}}, {"frame", "int", {}},
          {"disparity", "float", {0.1, 0.9}}, {"color_space", "uchar", {0}},
          {"version", "uchar", {1, 5, 0}}};
}

bool has_expected_pose(const Camera& c) {
  return c.position == glm::dvec3(1, 2, 3) && c.rotation[0] == glm::dvec3(0, -1, 0) &&
         c.rotation[1] == glm::dvec3(0, 0, -1) && c.rotation[2] == glm::dvec3(1, 0, 0);
}

struct PlyCamera : testing::Test {
  TempFolder folder;
  const fs::path model = folder / "photo of mine.ply";

  Camera load(const std::vector<Element>& elements,
              const std::string& format = "binary_little_endian") const {
    write_text(model, to_bytes(with_elements(elements, format)));
    return load_cameras(model).at(0);
  }
  /// Returns the file with one element replaced by another of the same name.
  static std::string with(const Element& element) {
    std::vector<Element> elements = sharp();
    for (Element& one : elements) {
      if (one.name == element.name) one = element;
    }
    return to_bytes(with_elements(elements));
  }
};

TEST_F(PlyCamera, ReadsSharpCamera) {
  std::vector<Element> halves = sharp();  // Cameras may have every type that models may have.
  for (Element& element : halves)
    if (element.type == "float") element.type = "half";
  for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
    const Camera camera = load(sharp(), format);
    EXPECT_TRUE(has_expected_pose(camera)) << format;
    const Camera of_halves = load(halves, format);
    EXPECT_TRUE(has_expected_pose(of_halves)) << format;
    EXPECT_EQ(glm::dvec4(of_halves.fx, of_halves.fy, of_halves.cx, of_halves.cy),
              glm::dvec4(500, 510, 320.5, 200.25));
    EXPECT_EQ(glm::ivec2(camera.width, camera.height), glm::ivec2(640, 400)) << format;
    EXPECT_EQ(glm::dvec4(camera.fx, camera.fy, camera.cx, camera.cy), glm::dvec4(500, 510, 320.5, 200.25));
    EXPECT_EQ(load_ply(OpenedFile(model)).count(), 5u) << format;
    // Injected fault: the matrix is read as camera-to-world.
    Camera faulty = camera;
    faulty.rotation = glm::transpose(camera.rotation);
    EXPECT_FALSE(has_expected_pose(faulty));
  }
  // The camera in the ply has precedence over other files.
  write_text(folder / "cameras.json", "[]");
  EXPECT_EQ(find_cameras(model), model);
  EXPECT_EQ(find_cameras(folder.path()), model);
  write_text(model, to_bytes(test::inria_file(0, 5)));
  EXPECT_EQ(find_cameras(model), folder / "cameras.json");
}

TEST_F(PlyCamera, ReadsFirstVersion) {
  const Numbers transposed = {0, 0, 1, 2, -1, 0, 0, 3, 0, -1, 0, -1};
  const Camera camera =
      load({{"extrinsic", "float", transposed}, {"intrinsic", "float", {500, 510, 640, 400}}});
  EXPECT_TRUE(has_expected_pose(camera));
  EXPECT_EQ(glm::dvec4(camera.fx, camera.fy, camera.cx, camera.cy), glm::dvec4(500, 510, 320, 200));
  // Without an extrinsic matrix, the camera is at the origin.
  const Camera there = load({{"intrinsic", "float", {500, 510, 640, 400}}});
  EXPECT_EQ(there.position, glm::dvec3(0));
  EXPECT_EQ(there.rotation, glm::dmat3(1.0));
}

TEST_F(PlyCamera, IgnoresDataparser) {
  load(sharp());
  write_text(folder / "dataparser_transforms.json",
             R"({"transform": [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": 2})");
  std::vector<Camera> cameras = load_cameras(model);
  EXPECT_FALSE(move_into_training(folder / "dataparser_transforms.json", model, cameras));
}

TEST_F(PlyCamera, ErrorsNameElementAndExpectation) {
  std::vector<test::BrokenFile> refusals = {
      {with({"intrinsic", "float", {500, 510, 640, 400}}), {"'intrinsic'", "4 numbers; expected the 9"}},
      {with({"intrinsic", "float", {-500, 0, 320, 0, 510, 200, 0, 0, 1}}), {"'intrinsic'", "above 0"}},
      {with({"intrinsic", "float", {NAN, 0, 320, 0, 510, 200, 0, 0, 1}}), {"'intrinsic'", "finite"}},
      {with({"intrinsic", "float", Numbers(17, 1.0)}), {"'intrinsic'", "at most 16 rows"}},
      {with({"image_size", "uint", {640}}), {"'image_size'", "1 numbers; expected width and height"}},
      {with({"image_size", "uint", {640, 0}}), {"'image_size'", "0 is not a number of pixels"}},
      {with({"extrinsic", "float", {1, 2, 3}}), {"'extrinsic'", "3 numbers; expected the 16"}},
      {with({"extrinsic", "float", Numbers(16, 1.0)}), {"'extrinsic'", "orthogonal"}},
      {to_bytes(with_elements({{"intrinsic", "float", intrinsic}})), {"9 numbers; expected 4"}},
      {to_bytes(test::inria_file(0, 5)), {"without a camera", "'intrinsic'"}},
  };
  // Truncation at every byte after the vertices.
  const std::string whole = to_bytes(with_elements({sharp()[0], sharp()[1], sharp()[2]}));
  for (std::size_t end = whole.size() - std::size_t{4} * (16 + 9 + 2); end < whole.size(); ++end)
    refusals.push_back({whole.substr(0, end), {"cut short"}});
  test::expect_no_cameras("photo of mine.ply", refusals);
}

}  // namespace
}  // namespace binosplat
