// The pose file next to a model.

#include "formats/cameras/pose_file.h"

#include <gtest/gtest.h>

#include "formats/cameras/cameras_file.h"
#include "support/broken.h"

namespace binosplat {
namespace {

using test::write_text;

SavedPose sample_pose() {
  SavedPose pose;
  pose.camera.name = "saved";
  pose.camera.width = 300;
  pose.camera.height = 200;
  pose.camera.fx = 210.5;
  pose.camera.fy = 211.25;
  pose.camera.cx = 150.125;
  pose.camera.cy = 99.5;
  pose.camera.position = {1.0 / 3.0, -2.0, 1e-7};
  pose.camera.rotation = glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
  pose.up = {0.0, 0.6, 0.8};
  pose.units_per_metre = 2.5;
  pose.ipd = 0.061;
  pose.near_plane = 0.05;
  return pose;
}

TEST(PoseFile, RoundTrips) {
  const test::TempFolder folder;
  const SavedPose pose = sample_pose();
  EXPECT_FALSE(find_pose(folder / "room.ply"));
  save_pose(pose_path(folder / "room.ply"), pose);
  EXPECT_EQ(folder.files(), std::set<std::string>{"room.binosplat.json"});
  for (const char* model : {"room.ply", "room.spz"}) {
    const auto read = find_pose(folder / model);
    ASSERT_TRUE(read) << model;
    EXPECT_EQ(read->camera.position, pose.camera.position);
    EXPECT_EQ(read->camera.rotation, pose.camera.rotation);
    EXPECT_EQ(read->camera.cx, pose.camera.cx);
    EXPECT_EQ(read->camera.width, 300);
    EXPECT_EQ(read->up, pose.up);
    EXPECT_EQ(read->units_per_metre, 2.5);
    EXPECT_EQ(read->ipd, 0.061);
    EXPECT_EQ(read->near_plane, 0.05);
  }
  EXPECT_FALSE(find_pose(folder / "rooms.ply"));
  // A pose file is also a list of cameras.
  EXPECT_EQ(load_cameras(folder / "room.binosplat.json").at(0).fy, pose.camera.fy);
}

TEST(PoseFile, LiesBesideFolder) {
  const test::TempFolder folder;
  std::filesystem::create_directory(folder / "scan.v2");
  EXPECT_EQ(pose_path(folder / "scan.v2"), folder / "scan.v2.binosplat.json");
  EXPECT_EQ(pose_path((folder / "scan.v2").string() + "/"), folder / "scan.v2.binosplat.json");
}

TEST(PoseFile, RejectsInvalidValues) {
  const test::TempFolder folder;
  const auto path = pose_path(folder / "room.ply");
  save_pose(path, sample_pose());
  const std::string good = test::read_text(path);
  const auto with = [&](const char* from, const char* to) { return test::replaced(good, from, to); };
  const std::vector<test::BrokenFile> refusals = {
      {with("\"units_per_metre\": 2.5", "\"units_per_metre\": 0"),
       {"units_per_metre", "mend it, or delete it"}},
      {with("\"ipd_metres\": 0.061", "\"ipd_metres\": -1"), {"ipd_metres"}},
      {with("\"near\": 0.05", "\"near\": \"far\""), {"near"}},
      {with("\"up\"", "\"down\""), {"up"}},
      {with("0.6", "1e200"), {"up"}},
      {with("\"fx\": 210.5", "\"fx\": -1"), {"fx"}},
      {with("[", "{"), {"line", "mend it, or delete it"}},
  };
  test::expect_refusals("room.binosplat.json", refusals, [&](const std::string& text) {
    write_text(path, text);
    find_pose(folder / "room.ply");
  });
}

}  // namespace
}  // namespace binosplat
