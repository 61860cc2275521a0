// Training folders: which file is the model, and how nerfstudio's cameras are moved into the training's
// world.

#include "formats/cameras/dataparser.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/models/streamed_sog.h"
#include "support/broken.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TempFolder;
using test::write_text;

json rows_of_pose(const glm::dmat3& rotation, const glm::dvec3& shift) {
  json all;
  for (int r = 0; r < 3; ++r) all.push_back({rotation[0][r], rotation[1][r], rotation[2][r], shift[r]});
  return all;
}

glm::dmat3 turn(double degrees, const glm::dvec3& axis) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(degrees), axis));
}

// An INRIA cameras.json with one camera.
const json list_of_one = {{{"img_name", "a"},
                           {"width", 64},
                           {"height", 48},
                           {"position", {1, 2, 3}},
                           {"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                           {"fx", 50},
                           {"fy", 50}}};

struct Dataparser : testing::Test {
  TempFolder folder;
  // `pose` and `place` are a camera in COLMAP's world. ns-process-data moves the camera by `applied`, and the
  // training moves it by `trained` and `scale`.
  const glm::dmat3 pose = turn(40, {1, 2, 3});
  const glm::dvec3 place{1, -2, 5};
  const glm::dmat3 applied = turn(-90, {1, 0, 0}), trained = turn(70, {0, 1, 1});
  const glm::dvec3 applied_shift{0.5, 0, -1}, trained_shift{3, -4, 0.25};
  const double scale = 0.3;

  Dataparser() {
    const json transforms = {{"transform", rows_of_pose(trained, trained_shift)}, {"scale", scale}};
    write_text(folder / "dataparser_transforms.json", transforms.dump());
  }

  json transforms() const {
    const glm::dmat3 world = applied * pose;
    json file = {
        {"w", 64}, {"h", 48}, {"fl_x", 50}, {"applied_transform", rows_of_pose(applied, applied_shift)}};
    file["frames"] = {{{"file_path", "a.png"},
                       {"transform_matrix", rows_of_pose(glm::dmat3(world[0], -world[1], -world[2]),
                                                         applied * place + applied_shift)}}};
    return file;
  }

  std::vector<Camera> moved(const fs::path& cameras_file, bool is_moved = true) const {
    std::vector<Camera> cameras = load_cameras(cameras_file);
    EXPECT_EQ(move_into_training(folder / "dataparser_transforms.json", cameras_file, cameras), is_moved);
    return cameras;
  }

  bool is_trained(const Camera& camera) const {
    return glm::distance(camera.position, scale * (trained * place + trained_shift)) < 1e-9 &&
           glm::distance(camera.rotation[2], trained * pose[2]) < 1e-9 &&
           glm::distance(camera.rotation[0], trained * pose[0]) < 1e-9;
  }
};

TEST_F(Dataparser, MovesCamerasOfTransforms) {
  write_text(folder / "transforms.json", transforms().dump());
  EXPECT_TRUE(is_trained(moved(folder / "transforms.json")[0]));
  // Injected fault: the applied transform is not undone.
  write_text(folder / "transforms.json", test::with_value(transforms(), "/applied_transform", nullptr));
  EXPECT_FALSE(is_trained(moved(folder / "transforms.json")[0]));
}

TEST_F(Dataparser, MovesCamerasOfColmap) {
  const glm::dmat3 to_camera = glm::transpose(pose);
  const glm::dquat q = glm::quat_cast(to_camera);
  const glm::dvec3 t = -(to_camera * place);
  write_text(folder / "cameras.txt", "1 PINHOLE 64 48 50 50 32 24\n");
  write_text(folder / "images.txt",
             fmt::format("1 {} {} {} {} {} {} {} 1 a.png\n\n", q.w, q.x, q.y, q.z, t.x, t.y, t.z));
  write_text(folder / "points3D.txt", "");
  EXPECT_TRUE(is_trained(moved(folder.path())[0]));
}

TEST_F(Dataparser, IgnoresNeighbouringCameraFiles) {
  fs::create_directories(folder / "data");
  write_text(folder / "data/transforms.json", transforms().dump());
  EXPECT_TRUE(is_trained(moved(folder / "data")[0])) << "the folder stands for its transforms.json";
  // A COLMAP reconstruction in the same folder does not change how transforms.json is read.
  for (const char* name : {"cameras.bin", "images.bin"}) write_text(folder / "data" / name, "");
  EXPECT_TRUE(is_trained(moved(folder / "data/transforms.json")[0]));
  // INRIA's cameras are in the model's world already.
  write_text(folder / "data/cameras.json", list_of_one.dump());
  EXPECT_EQ(moved(folder / "data/cameras.json", false)[0].position, glm::dvec3(1, 2, 3));
}

TEST_F(Dataparser, IsFoundAboveExport) {
  fs::create_directories(folder / "exports/splat");
  write_text(folder / "exports/splat/splat.ply", "ply");
  EXPECT_EQ(find_dataparser(folder / "exports/splat/splat.ply"), folder / "dataparser_transforms.json");
  EXPECT_EQ(find_dataparser(folder.path()), folder / "dataparser_transforms.json");
  EXPECT_FALSE(find_dataparser("/no/such/model.ply"));
  write_text(folder / "transforms.json", transforms().dump());
  const std::string identity = R"("transform": [[1,0,0,0],[0,1,0,0],[0,0,1,0]])";
  const std::vector<test::BrokenFile> refusals = {
      {"{}", {"transform"}},
      {"{" + identity + "}", {"scale"}},
      {"{" + identity + ", \"scale\": 0}", {"above 0"}},
      {R"({"transform": [[2,0,0,0],[0,1,0,0],[0,0,1,0]], "scale": 1})", {"key 'transform'"}},
  };
  test::expect_refusals("dataparser_transforms.json", refusals, [&](const std::string& text) {
    write_text(folder / "dataparser_transforms.json", text);
    moved(folder / "transforms.json");
  });
}

TEST(ModelsIn, FindsTrainedModel) {
  const TempFolder folder;
  const auto add = [&](const std::string& name) {
    fs::create_directories((folder / name).parent_path());
    write_text(folder / name, "ply");
  };
  using Paths = std::vector<fs::path>;
  EXPECT_EQ(models_in(folder.path()), Paths{});
  add("exports/splat/splat.ply");
  EXPECT_EQ(models_in(folder.path()), Paths{folder / "exports/splat/splat.ply"});
  add("points3D.ply");
  add("input.ply");
  add("Garden.PLY");
  EXPECT_EQ(models_in(folder.path()), Paths{folder / "Garden.PLY"});
  add("other.spz");
  EXPECT_EQ(models_in(folder.path()), (Paths{folder / "Garden.PLY", folder / "other.spz"}));
  EXPECT_ERROR(load_model(folder.path()), "2 models", "Garden.PLY", "other.spz");
  add("ply/point_cloud_6999.ply");
  add("ply/point_cloud_90000.json");
  add("ply/point_cloud_80000.ply.part");
  fs::create_directories(folder / "ply/point_cloud_70000.ply");
  add("ply/point_cloud_29999.ply");
  EXPECT_EQ(models_in(folder.path()), Paths{folder / "ply/point_cloud_29999.ply"});
  add("point_cloud/iteration_30000/point_cloud.ply");
  EXPECT_EQ(models_in(folder.path()), Paths{folder / "point_cloud/iteration_30000/point_cloud.ply"});
}

TEST(ModelsIn, IgnoresForeignFiles) {
  const TempFolder folder;
  const auto found = [&] {
    std::vector<std::string> names;
    for (const fs::path& path : models_in(folder.path())) names.push_back(path.filename());
    return names;
  };
  using Names = std::vector<std::string>;
  const std::string vertex = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float ";
  write_text(folder / "m.ply", vertex + "opacity\nend_header\n0 0\n");
  for (const char* text : {R"({"title": "a scan"})", "{", "", "[1, 2]", R"({"asset": {"version": "2.0"}})"}) {
    for (const char* name : {"meta.json", "lod-meta.json", "scene.gltf", "scene.glb"}) {
      write_text(folder / name, text);
      EXPECT_EQ(found(), Names{"m.ply"}) << name << text;
      EXPECT_FALSE(is_streamed_sog(folder.path()));
    }
  }
  write_text(folder / "mesh.ply", vertex + "y\nend_header\n0 0\n");
  EXPECT_EQ(found(), Names{"m.ply"});
  write_text(folder / "scene.gltf", R"({"extensionsUsed": ["KHR_gaussian_splatting"]})");
  EXPECT_EQ(found(), (Names{"m.ply", "scene.gltf"}));
  // Even a truncated meta.json is recognized as a SOG's.
  write_text(folder / "meta.json", R"({"version": 2, "means": {"mi)");
  EXPECT_EQ(found(), Names{"meta.json"});
  write_text(folder / "lod-meta.json", R"({"lodLevels": 2, )");
  EXPECT_EQ(found(), Names{"lod-meta.json"});
  // Without a model, a file of another program is returned, so that the error names it.
  for (const char* name : {"m.ply", "mesh.ply", "scene.gltf", "scene.glb", "lod-meta.json"})
    fs::remove(folder / name);
  write_text(folder / "meta.json", R"({"title": "a scan"})");
  EXPECT_EQ(found(), Names{"meta.json"});
}

}  // namespace
}  // namespace binosplat
