// Files of other programs, compared with the results of independent programs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/image.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "support/fixtures.h"
#include "support/truth.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using test::near;

/// Returns the index in our model of a Gaussian in truth.json. Row 5 of one file has a zero quaternion and is
/// skipped.
std::size_t index_of(const std::string& name, const json& gaussian) {
  const std::size_t index = gaussian["index"].get<std::size_t>();
  return name == "ply/var-unnormalised-quats.ply" && index > 5 ? index - 1 : index;
}

void compare(const std::string& name, const Model& model, const json& truth) {
  EXPECT_EQ(model.degree, std::min(truth["sh_degree"].get<int>(), 3)) << name;
  EXPECT_EQ(model.count() + model.left_out, truth["count"].get<std::size_t>()) << name;
  if (model.left_out == 0) {
    EXPECT_EQ(test::difference_of_all(model, truth), "") << name;
  }
  const test::TruthBounds bounds{.last = truth["sh_degree"] < 4};
  for (const json& gaussian : truth["gaussians"]) {
    const std::size_t index = index_of(name, gaussian);
    EXPECT_EQ(test::difference(model, index, gaussian, bounds), "") << name << ", Gaussian " << index;
  }
}

/// Expects that difference() reports small errors in each attribute of a Gaussian, and the next Gaussian in
/// its place.
void expect_faults_detected(const Model& model, const json& gaussian) {
  const std::size_t index = gaussian["index"].get<std::size_t>(), values = model.sh.size() / model.count();
  EXPECT_NE(test::difference(model, index + 1, gaussian), "");
  const auto caught = [&](const char* attribute, const auto& spoil) {
    Model faulty = model;
    spoil(faulty);
    EXPECT_EQ(test::difference(faulty, index, gaussian), attribute);
  };
  caught("position", [&](Model& m) { m.position[index].z += 1e-4f * (1 + std::abs(m.position[index].z)); });
  caught("scale", [&](Model& m) { m.scale[index].y *= 1.0001f; });
  caught("rotation", [&](Model& m) { m.rotation[index].w += 1e-3f; });
  caught("opacity", [&](Model& m) { m.opacity[index] += 1e-5f; });
  caught("dc", [&](Model& m) { m.sh[index * values + 1] += 1e-4f; });
  caught("sh", [&](Model& m) { m.sh[index * values + 3] += 1e-4f; });
  caught("sh_last", [&](Model& m) { m.sh[(index + 1) * values - 1] += 1e-4f; });
}

/// Undoes the transform of the file's one node: a rotation by 90 degrees around x, then a translation.
void undo_node(Model& model) {
  const glm::vec3 translation(2, 12, -7);
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::vec3 p = model.position[i] - translation;
    model.position[i] = {p.x, -p.z, p.y};
    const glm::vec4 q = model.rotation[i];
    model.rotation[i] =
        static_cast<float>(std::sqrt(0.5)) * glm::vec4(q[0] - q[1], q[1] + q[0], q[2] - q[3], q[3] + q[2]);
  }
}

TEST(RealFiles, ModelsMatchIndependentDecoder) {
  REQUIRE_FIXTURES(folder);
  const json models = test::load_json(folder / "truth.json")["models"];
  int files = 0;
  for (const auto& [name, truth] : models.items()) {
    Model model = load_model(folder / name);
    if (name == "gltf/cesium-draft-synthetic.gltf") undo_node(model);
    compare(name, model, truth);
    ++files;
  }
  EXPECT_EQ(files, 51);
  const json& gaussian = models["spz/st-train-v3-sh3.spz"]["gaussians"][0];
  expect_faults_detected(load_model(folder / "spz/st-train-v3-sh3.spz"), gaussian);
}

TEST(RealFiles, CamerasMatchIndependentReader) {
  REQUIRE_FIXTURES(folder);
  const std::vector<Camera> cameras = load_cameras(folder / "cameras/inria-cameras.json");
  const json truth = test::load_json(folder / "truth.json")["cameras"]["cameras/inria-cameras.json"];
  EXPECT_EQ(cameras.size(), truth["count"].get<std::size_t>());
  const auto agrees = [](const glm::dvec3& a, const json& b) {
    return near(a.x, b[0], 1e-7) && near(a.y, b[1], 1e-7) && near(a.z, b[2], 1e-7);
  };
  for (const json& expected : truth["cameras"]) {
    const Camera& camera = cameras[expected["id"].get<std::size_t>()];
    EXPECT_EQ(camera.name, expected["name"].get<std::string>());
    EXPECT_EQ(camera.width, expected["width"].get<int>());
    EXPECT_EQ(camera.height, expected["height"].get<int>());
    EXPECT_EQ(camera.fx, expected["fx"].get<double>());
    EXPECT_EQ(camera.fy, expected["fy"].get<double>());
    EXPECT_EQ(camera.cx, expected["cx"].get<double>());
    EXPECT_EQ(camera.cy, expected["cy"].get<double>());
    EXPECT_TRUE(agrees(camera.position, expected["center"]));
    EXPECT_TRUE(agrees(camera.rotation[2], expected["forward"]));
    EXPECT_TRUE(agrees(-camera.rotation[1], expected["up"]));
    // Injected fault: the transposed rotation.
    EXPECT_FALSE(agrees(glm::transpose(camera.rotation)[2], expected["forward"]));
  }
}

double psnr(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(double{a.data[i]} - b.data[i], 2);
  return -10 * std::log10(sum / static_cast<double>(a.data.size()));
}

// This tests both image readers: PNG renders against JPEG photos must give the figures that other programs
// measured.
TEST(ImageReaders, OthersRendersGivePublishedPsnr) {
  for (const char* name : {"fox", "garden"}) {
    REQUIRE_SCENE(name, folder);
    const json published = test::load_json(folder / "psnr.json");
    int views = 0;
    for (const auto& render : fs::directory_iterator(folder / "inria")) {
      const std::string view = render.path().stem().string();
      const Image ours = load_image(render.path());
      const Image photo = load_image(folder / "photos" / (view + ".jpg"));
      ASSERT_EQ(ours.width, photo.width);
      ASSERT_EQ(ours.height, photo.height);
      ASSERT_EQ(ours.channels, 3);
      ASSERT_EQ(photo.channels, 3);
      EXPECT_NEAR(psnr(ours, photo), published[view].get<double>(), 0.001) << view;
      Image faulty = photo;  // injected fault: the channels in another order
      for (std::size_t i = 0; i < faulty.data.size(); i += 3) std::swap(faulty.data[i], faulty.data[i + 1]);
      EXPECT_GT(std::abs(psnr(ours, faulty) - published[view].get<double>()), 0.001) << view;
      ++views;
    }
    EXPECT_GE(views, 3);
  }
}

}  // namespace
}  // namespace binosplat
