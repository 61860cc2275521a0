#include "preview/camera_key_list.h"

#include <gtest/gtest.h>

#include "base/inputs.h"
#include "formats/cameras/cameras_file.h"
#include "scene/key_path.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::preview {
namespace {

namespace fs = std::filesystem;

Camera at(double x) {
  Camera camera = test::front_camera(64, 40, 55.0);
  camera.position.x = x;
  return camera;
}

std::vector<double> places(const std::vector<Camera>& cameras) {
  std::vector<double> x;
  for (const Camera& camera : cameras) x.push_back(camera.position.x);
  return x;
}

struct KeyListTest : testing::Test {
  test::TempFolder folder;
  const fs::path file = fs::path(folder.path()) / "cameras.json";
};

using Places = std::vector<double>;

TEST_F(KeyListTest, WritesChanges) {
  KeyList list(folder.path());
  EXPECT_FALSE(fs::exists(file));
  for (const double x : {1.0, 2.0, 3.0}) list.add(at(x));
  EXPECT_EQ(list.file(), file);
  EXPECT_TRUE(are_keys(load_cameras(file))) << "render --path would take them for frames";
  list.replace(1, at(5.0));
  EXPECT_EQ(places(load_cameras(file)), (Places{1.0, 5.0, 3.0}));
  EXPECT_EQ(load_cameras(file)[1].time, key_seconds);
  list.remove(0);
  EXPECT_EQ(places(load_cameras(file)), (Places{5.0, 3.0}));
  EXPECT_EQ(load_cameras(file)[0].time, 0.0) << "times count from the first key that is left";
  EXPECT_EQ(load_cameras(file)[1].time, key_seconds);
  EXPECT_EQ(load_cameras(file)[0].name, "key_000");
  list.remove(1);
  list.remove(0);
  EXPECT_FALSE(fs::exists(file)) << "a list without cameras is no cameras.json";
  list.add(at(7.0));
  EXPECT_EQ(places(load_cameras(file)), (Places{7.0}));
}

TEST_F(KeyListTest, NewSessionContinues) {
  KeyList(folder.path()).add(at(1.0));
  KeyList list(folder.path());
  EXPECT_EQ(places(list.keys()), (Places{1.0}));
  list.add(at(2.0));
  EXPECT_EQ(places(load_cameras(file)), (Places{1.0, 2.0}));
  EXPECT_EQ(load_cameras(file)[1].time, key_seconds);
}

TEST_F(KeyListTest, KeepsForeignFiles) {
  for (const std::string text : {"[{\"img_name\": \"a\"}]", "no JSON"}) {
    test::write_text(file, text);
    KeyList list(folder.path());
    EXPECT_TRUE(list.keys().empty());
    list.add(at(1.0));
    EXPECT_NE(list.file(), file);
    EXPECT_EQ(test::read_text(file), text);
    EXPECT_EQ(places(load_cameras(list.file())), (Places{1.0}));
    fs::remove(list.file());
  }
}

TEST_F(KeyListTest, ConcurrentSessionsKeepKeys) {
  KeyList one(folder.path()), other(folder.path());
  one.add(at(1.0));
  other.add(at(2.0));
  one.add(at(3.0));
  EXPECT_NE(one.file(), other.file());
  EXPECT_EQ(places(load_cameras(one.file())), (Places{1.0, 3.0}));
  EXPECT_EQ(places(load_cameras(other.file())), (Places{2.0}));
  // A session that loses its keys does not remove a file that another program has written.
  test::write_text(one.file(), "another's");
  const fs::path before = one.file();
  one.remove(0);
  one.remove(0);
  EXPECT_EQ(test::read_text(before), "another's");
}

TEST_F(KeyListTest, NeverOverwritesInput) {
  KeyList(folder.path()).add(at(1.0));
  protect_input(file);
  KeyList list(folder.path());
  list.add(at(2.0));
  EXPECT_NE(list.file(), file);
  EXPECT_EQ(places(load_cameras(file)), (Places{1.0}));
}

}  // namespace
}  // namespace binosplat::preview
