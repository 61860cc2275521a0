// Reconstructions of COLMAP, real and broken ones.

#include <gtest/gtest.h>

#include "formats/cameras/cameras_file.h"
#include "formats/cameras/colmap_records.h"
#include "support/broken.h"
#include "support/fixtures.h"
#include "support/truth.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Copy;
using test::little;
using test::near3;
using test::patched;

bool agrees_in_pose_and_lens(const Camera& camera, const json& truth) {
  return near3(camera.position, truth["center"], 1e-6, 1e-6) &&
         near3(camera.rotation[2], truth["forward"], 1e-6) && near3(-camera.rotation[1], truth["up"], 1e-6) &&
         camera.fx == truth["fx"] && camera.fy == truth["fy"] && camera.cx == truth["cx"] &&
         camera.cy == truth["cy"] && camera.width == truth["width"] && camera.height == truth["height"];
}

const Camera& named(const std::vector<Camera>& cameras, std::string_view name) {
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.name == name; });
  if (found == cameras.end()) throw std::out_of_range(std::string(name));
  return *found;
}

TEST(Colmap, PosesMatchIndependentReader) {
  REQUIRE_FIXTURES(folder);
  const json truth = test::load_json(folder / "truth.json")["cameras"]["cameras/colmap-real"];
  const fs::path real = folder / "cameras/colmap-real";
  for (const fs::path& path : {real / "txt", real / "bin", real / "bin/images.bin"}) {
    testing::internal::CaptureStderr();
    const std::vector<Camera> cameras = load_cameras(path);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("has distortion"), std::string::npos);
    ASSERT_EQ(cameras.size(), truth["count"].get<std::size_t>());
    for (const json& expected : truth["cameras"]) {
      const Camera& camera = named(cameras, expected["name"].get_ref<const std::string&>());
      EXPECT_TRUE(agrees_in_pose_and_lens(camera, expected)) << camera.name;
      // Injected faults: the transposed rotation, and COLMAP's translation as the position.
      Camera faulty = camera;
      faulty.rotation = glm::transpose(camera.rotation);
      EXPECT_FALSE(agrees_in_pose_and_lens(faulty, expected));
      faulty = camera;
      faulty.position = -(glm::transpose(camera.rotation) * camera.position);
      EXPECT_FALSE(agrees_in_pose_and_lens(faulty, expected));
    }
    EXPECT_TRUE(
        std::is_sorted(cameras.begin(), cameras.end(), [](auto& a, auto& b) { return a.name < b.name; }));
  }
}

TEST(Colmap, LensesMatchIndependentReader) {
  REQUIRE_FIXTURES(folder);
  const json truth = test::load_json(folder / "truth.json")["cameras"]["cameras/colmap-models"];
  const auto is_fisheye = [](int model) { return model == 5 || model >= 8; };
  // Each image alone.
  for (const json& expected : truth["cameras"]) {
    const Copy copy(folder / "cameras/colmap-models/txt");
    const std::string id = expected["image_id"].dump() + " ";
    const std::string images = copy.read("images.txt");
    const std::size_t at = images.find("\n" + id) + 1;
    copy.write(images.substr(at, images.find('\n', at) + 1 - at) + "\n", "images.txt");
    const int model = expected["model_id"];
    if (is_fisheye(model)) {
      EXPECT_ERROR(load_cameras(copy.path()), "cameras.txt: camera", "is not a pinhole",
                   "colmap image_undistorter");
      continue;
    }
    testing::internal::CaptureStderr();
    const std::vector<Camera> cameras = load_cameras(copy.path());
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(said.find("cameras.txt: has distortion") != std::string::npos, model >= 2) << said;
    ASSERT_EQ(cameras.size(), 1u);
    EXPECT_EQ(cameras[0].name, expected["name"].get<std::string>());
    EXPECT_TRUE(agrees_in_pose_and_lens(cameras[0], expected)) << model;
  }
  // All images together: those with fisheye lenses are skipped.
  for (const char* kind : {"cameras/colmap-models/txt", "cameras/colmap-models/bin"}) {
    testing::internal::CaptureStderr();
    const std::vector<Camera> cameras = load_cameras(folder / kind);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(cameras.size(), 7u);
    EXPECT_NE(said.find("4 of 11 cameras are skipped"), std::string::npos) << said;
    EXPECT_NE(said.find("FISHEYE, which is not a pinhole"), std::string::npos) << said;
  }
}

TEST(Colmap, IsFoundNearModel) {
  REQUIRE_FIXTURES(folder);
  const test::TempFolder temporary;
  fs::create_directories(temporary / "scene/sparse/0");
  fs::create_directories(temporary / "scene/images");
  EXPECT_FALSE(find_cameras(temporary / "scene/model.ply").has_value());
  EXPECT_ERROR(load_cameras(temporary / "scene"), "is a folder without cameras.json");
  for (const char* name : {"cameras.bin", "images.bin"})
    fs::copy(folder / "cameras/colmap-real/bin" / name, temporary / "scene/sparse/0");
  EXPECT_EQ(find_cameras(temporary / "scene/model.ply"), temporary / "scene/sparse/0");
  EXPECT_EQ(find_cameras(temporary / "scene"), temporary / "scene/sparse/0");  // a model that is a folder
  EXPECT_EQ(find_photos(temporary / "scene/sparse/0"), temporary / "scene/images");
  EXPECT_FALSE(find_photos(temporary / "model.ply").has_value());
  test::write_text(temporary / "scene/cameras.json", "[]");
  EXPECT_EQ(find_cameras(temporary / "scene/model.ply"), temporary / "scene/cameras.json");
}

TEST(ColmapErrors, BinaryFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "cameras/colmap-real/bin");
  const auto refuses = [&](const std::string& file, const std::vector<test::BrokenFile>& refusals) {
    const std::string good = copy.read(file);
    test::expect_refusals(file, refusals, [&](const std::string& bytes) {
      copy.write(bytes, file);
      load_cameras(copy.path());
    });
    copy.write(good, file);
  };
  const std::string images = copy.read("images.bin"), cameras = copy.read("cameras.bin");
  const std::size_t name = 8 + 4 + 56 + 4, points = images.find('\0', name) + 1;
  std::vector<test::BrokenFile> of_images = {
      {images.substr(0, 1000), {"images.bin is cut short or damaged: image 0 of 8", "1000 bytes"}},
      {images.substr(0, name) + std::string(500, 'x'), {"image 0 of 8", "name that runs to the end"}},
      {patched(images, points, little(std::uint64_t{1} << 60)), {"image 0 of 8", "exceeds the file's"}},
      {patched(images, name - 4, little(99u)), {"image 5 refers to camera 99", "cameras.bin does not have"}},
      {patched(images, 12, std::string(32, '\0')), {"image 0 of 8", "not a quaternion"}},
      {patched(images, 44, little(std::nan(""))), {"translation is not finite"}},
      {patched(images, 0, little(std::uint64_t{1} << 62)), {"image 8 of 4611686018427387904"}},
      {little(std::uint64_t{0}), {"images.bin holds no images"}},
      {"1234", {"the number of records exceeds"}},
  };
  // Truncation at every byte of the first and of the last record.
  for (std::size_t end = 0; end < points + 8; ++end) of_images.push_back({images.substr(0, end), {}});
  for (std::size_t end = images.size() - 100; end < images.size(); ++end)
    of_images.push_back({images.substr(0, end), {"images.bin is cut short", "image 7 of 8"}});
  refuses("images.bin", of_images);

  std::vector<test::BrokenFile> of_cameras = {
      {patched(cameras, 12, little(42)), {"cameras.bin: camera 1 has the unknown model 42"}},
      {patched(cameras, 12, little(-1)), {"has the unknown model -1"}},
      {patched(cameras, 16, little(std::uint64_t{1} << 40)), {"camera 1", "a picture of 2147483647 x"}},
      {patched(cameras, 32, little(-1.0)), {"camera 1: focal lengths of -1 and -1 px"}},
      {patched(cameras, 56, little(std::nan(""))), {"camera 1", "must be finite"}},
      {patched(cameras, 0, little(std::uint64_t{2})) + cameras.substr(8), {"there is a camera 1 already"}},
  };
  for (std::size_t end = 0; end < cameras.size(); ++end)
    of_cameras.push_back({cameras.substr(0, end), {"cameras.bin is cut short"}});
  refuses("cameras.bin", of_cameras);
}

TEST(Colmap, FindsLargestReconstruction) {
  const test::TempFolder scene;
  const auto add = [&](const char* name, int images) {
    fs::create_directories(scene / name);
    test::write_text(scene / name / "cameras.txt", "1 PINHOLE 200 100 100 100 100 50\n");
    std::string text;
    for (int k = 1; k <= images; ++k) text += fmt::format("{0} 1 0 0 0 0 0 0 1 {0}.png\n\n", k);
    test::write_text(scene / name / "images.txt", text);
  };
  add("sparse/1", 3);
  EXPECT_EQ(find_cameras(scene / "model.ply"), scene / "sparse/1");
  add("sparse/0", 3);
  EXPECT_EQ(find_cameras(scene / "model.ply"), scene / "sparse/0") << "of equal ones the first";
  add("sparse/2", 5);
  EXPECT_EQ(find_cameras(scene / "model.ply"), scene / "sparse/2");
  EXPECT_EQ(resolve_cameras(scene / "sparse"), scene / "sparse/2") << "named without its number";
  EXPECT_EQ(load_cameras(scene / "sparse").size(), 5u);
}

TEST(Colmap, NormalisesQuaternions) {
  // The squares of all lengths but the first overflow, underflow or are close to it.
  for (const char* size : {"1", "5e-162", "1e200", "1e-300"}) {
    const test::TempFolder folder;
    test::write_text(folder / "images.txt", fmt::format("1 {0} -{0} {0} {0} 0 0 0 1 a.png\n\n", size));
    const glm::dvec4 rotation = colmap_images_text(folder / "images.txt").at(0).rotation;
    EXPECT_LT(glm::length(rotation - glm::dvec4(0.5, -0.5, 0.5, 0.5)), 1e-15) << size;
  }
}

TEST(ColmapErrors, TextFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const struct {
    const char *file, *from, *to;
    std::vector<std::string> said;
  } faults[] = {
      {"images.txt",
       "img_000.png\n\n",
       "img_000.png\n1.5 2.5\n",
       {"line 6", "seen in image 100", "empty line"}},
      {"images.txt", "100 -0.5 0.5", "100 -0.5 O.5", {"images.txt, line 5", "'O.5' is not a number"}},
      {"images.txt", " 4 sub/img_001.png", "", {"images.txt, line 7", "expected IMAGE_ID QW"}},
      {"images.txt", "100 -0.5 0.5 0.5 0.5", "100 0 0 0 0", {"line 5", "not a quaternion"}},
      {"images.txt", "0 0 0 1 sub", "0 0 0 99 sub", {"image 100 refers to camera 99"}},
      {"cameras.txt",
       "1 SIMPLE_PINHOLE",
       "1 SIMPLE",
       {"cameras.txt, line 4", "'SIMPLE' is not a COLMAP camera model"}},
      {"cameras.txt",
       "480 500 320 240\n",
       "480 500 320\n",
       {"line 4", "2 parameters", "SIMPLE_PINHOLE has 3"}},
      {"cameras.txt", "1 SIMPLE_PINHOLE 640", "1 SIMPLE_PINHOLE -640", {"'-640' is not a number of pixels"}},
      {"cameras.txt", "4 PINHOLE", "1 PINHOLE", {"line 5", "there is a camera 1 already"}},
      {"cameras.txt", "PINHOLE 640 480 500 320 240", "PINHOLE", {"line 4", "expected CAMERA_ID"}},
  };
  for (const auto& [file, from, to, said] : faults) {
    const Copy copy(folder / "cameras/colmap-models/txt");
    copy.write(test::replaced(copy.read(file), from, to), file);
    EXPECT_TRUE(test::fails_saying([&] { load_cameras(copy.path()); }, said)) << to;
  }
}

}  // namespace
}  // namespace binosplat
