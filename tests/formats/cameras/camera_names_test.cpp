// Names of views and the photos that views get by their names: no two views may be confused.

#include <gtest/gtest.h>

#include "formats/cameras/cameras_file.h"
#include "formats/cameras/view_files.h"
#include "support/broken.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::little;
using test::TempFolder;
using test::write_text;

const std::string lens = "1 PINHOLE 160 120 120 120 80 60\n";

/// Returns the view names of a COLMAP reconstruction whose images.txt is `images`.
std::vector<std::string> names_in(const std::string& images) {
  const TempFolder folder;
  write_text(folder / "cameras.txt", lens);
  write_text(folder / "images.txt", images);
  std::vector<std::string> names;
  for (const Camera& camera : load_cameras(folder.path())) names.push_back(camera.name);
  return names;
}

std::string image(int id, const std::string& name) {
  return std::to_string(id) + " 1 0 0 0 0 0 0 1 " + name + "\n\n";
}

using CameraNames = std::vector<std::string>;

TEST(CameraNames, ColmapNamesMayHaveBlanks) {
  EXPECT_EQ(names_in(image(1, "IMG.jpg") + image(2, "IMG (1).jpg") + image(3, "IMG (2).jpg")),
            (CameraNames{"IMG (1).jpg", "IMG (2).jpg", "IMG.jpg"}));
  EXPECT_EQ(names_in(image(1, "left/0001.jpg") + image(2, "right/0001.jpg") + image(3, "left/0001.png")),
            (CameraNames{"left/0001.jpg", "left/0001.png", "right/0001.jpg"}));
  EXPECT_EQ(names_in(image(1, "Bild  3 \xc3\xa4.jpg")), CameraNames{"Bild  3 \xc3\xa4.jpg"})
      << "two blanks, UTF-8";
  // Blanks and tabs between fields and at the end of a line are not part of a name; nor is CR.
  EXPECT_EQ(names_in("1\t1 0 0 0  0 0 0 1\t  a b.jpg \t\r\n\r\n2 1 0 0 0 0 0 0 1 c d\r\n"),
            (CameraNames{"a b.jpg", "c d"}));
  EXPECT_EQ(names_in("\xef\xbb\xbf# a comment\r\n  # another\n\n" + image(1, "# 1.jpg")),
            CameraNames{"# 1.jpg"});
  EXPECT_EQ(names_in("1 1 0 0 0 0 0 0 1 a b\n1.5 2.5 -1 3 4 17\n" + image(2, "3 4 5")),
            (CameraNames{"3 4 5", "a b"}));
}

TEST(CameraNames, DistinguishImagesFromPoints) {
  // The second line has twelve words, as many as four points. It is in the place of the first image's points,
  // which some programs omit.
  const std::string two = "1 1 0 0 0 0 0 0 1 a.jpg\n2 1 0 0 0 0 0 0 1 my b c.jpg\n";
  EXPECT_EQ(names_in(two), (CameraNames{"a.jpg", "my b c.jpg"}));
  EXPECT_EQ(names_in(two + "# a comment\n3 1 0 0 0 0 0 0 1 12\n1.5 2 -1\n\n4 1 0 0 0 0 0 0 1 d"),
            (CameraNames{"12", "a.jpg", "d", "my b c.jpg"}));
  for (const char* cut : {"1.5 2 -1 4\n", "1.5 x -1\n", "2 1 0 0 0 0 0 0\n"})
    EXPECT_ERROR(names_in("1 1 0 0 0 0 0 0 1 a.jpg\n" + std::string(cut)), "images.txt, line 2",
                 "points seen in image 1")
        << cut;
}

TEST(CameraNames, ParseNumbersLikeColmap) {
  const TempFolder folder;
  const auto load = [&](const std::string& lens_of, const std::string& image_of) {
    write_text(folder / "cameras.txt", lens_of);
    write_text(folder / "images.txt", image_of);
    return load_cameras(folder.path()).at(0);
  };
  const Camera camera = load("+1.0 PINHOLE 160.0 +120 +140 1.4e2 80.0 +60.5\n",
                             "12.0 +1 +0 0 0 +0.25 0 -0.5 1.0 a\n+3.5 2.0 12.0 1 2 +7\n");
  EXPECT_EQ(camera.width, 160);
  EXPECT_EQ(camera.height, 120);
  EXPECT_EQ(camera.fx, 140.0);
  EXPECT_EQ(camera.cy, 60.5);
  EXPECT_EQ(camera.position, glm::dvec3(-0.25, 0.0, 0.5));
  for (const char* bad : {"160.5", "-160", "++160", "1e30", "160px", "nan", "+"})
    EXPECT_ERROR(load(fmt::format("1 PINHOLE {} 120 1 1 1 1\n", bad), "1 1 0 0 0 0 0 0 1 a\n"),
                 "cameras.txt, line 1", "is not a number of pixels")
        << bad;
}

/// Files of each kind that describe two cameras with these names.
struct Pair {
  std::string kind;
  std::map<std::string, std::string> files;
};

std::vector<Pair> pairs_of(const std::string& a, const std::string& b) {
  const auto record = [](std::uint32_t id, const std::string& name) {
    std::string bytes = little(id) + little(1.0);
    for (int i = 0; i < 6; ++i) bytes += little(0.0);
    return bytes + little(std::uint32_t{1}) + name + '\0' + little(std::uint64_t{0});
  };
  std::string pinhole = little(std::uint64_t{1}) + little(std::uint32_t{1}) + little(1) +
                        little(std::uint64_t{160}) + little(std::uint64_t{120});
  for (const double value : {120.0, 120.0, 80.0, 60.0}) pinhole += little(value);
  const json rows = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  const json camera = {
      {"width", 160}, {"height", 120},         {"fx", 120},
      {"fy", 120},    {"position", {0, 0, 0}}, {"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  json list = {camera, camera}, frames, poses;
  list[0]["img_name"] = a;
  list[1]["img_name"] = b;
  for (const std::string& name : {a, b}) {
    frames.push_back({{"file_path", name}, {"transform_matrix", rows}});
    poses.push_back({{"file_path", name}, {"transform", rows}});
  }
  return {
      {"text", {{"cameras.txt", lens}, {"images.txt", image(1, a) + image(2, b)}}},
      {"binary",
       {{"cameras.bin", pinhole}, {"images.bin", little(std::uint64_t{2}) + record(1, a) + record(2, b)}}},
      {"cameras.json", {{"cameras.json", list.dump()}}},
      {"transforms.json",
       {{"transforms.json", json{{"w", 160}, {"h", 120}, {"fl_x", 120}, {"frames", frames}}.dump()}}},
      {"poses", {{"transforms.json", poses.dump()}}}};
}

TEST(CameraNames, DuplicatesGetNumbers) {
  for (const auto& [kind, files] : pairs_of("same name.jpg", "same name.jpg")) {
    const TempFolder folder;
    for (const auto& [name, text] : files) write_text(folder / name, text);
    testing::internal::CaptureStderr();
    const std::vector<Camera> cameras = load_cameras(folder.path());
    const std::string said = testing::internal::GetCapturedStderr();
    ASSERT_EQ(cameras.size(), 2u) << kind;
    EXPECT_EQ(cameras[0].name, "same name.jpg") << kind;
    EXPECT_EQ(cameras[1].name, "same name_2.jpg") << kind;
    EXPECT_NE(said.find("1 of 2 cameras repeat an earlier name"), std::string::npos) << said;
  }
  // Names that differ only by folder are left as they are.
  for (const auto& [kind, files] : pairs_of("left/1.jpg", "right/1.jpg")) {
    const TempFolder folder;
    for (const auto& [name, text] : files) write_text(folder / name, text);
    EXPECT_EQ(load_cameras(folder.path()).size(), 2u) << kind;
  }
}

TEST(CameraNames, NumberedNamesStayUnique) {
  // COLMAP's views are sorted by name.
  EXPECT_EQ(names_in(image(1, "r_0") + image(2, "r_0_2") + image(3, "r_0") + image(4, "r_0") +
                     image(5, "r_0_2") + image(6, "a_left") + image(7, "a_left")),
            (CameraNames{"a_left", "a_2_left", "r_0", "r_0_3", "r_0_4", "r_0_2", "r_0_2_2"}));
}

/// Returns the photos that views of these names get from the folder `below` in `folder`, "" for a view
/// without a photo.
CameraNames photos_of(const TempFolder& folder, const std::string& below, const CameraNames& names) {
  std::vector<Camera> views(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) views[i].name = names[i];
  set_short_names(views);
  CameraNames photos;
  for (const Camera& view : views) {
    const auto photo = find_view_photo(folder / below, view);
    photos.push_back(photo ? fs::relative(*photo, folder.path()).string() : "");
  }
  return photos;
}

TEST(CameraNames, PhotosMatchByPathEnd) {
  const TempFolder folder;
  for (const char* name : {"images", "images/cam0", "images/cam1", "flat"})
    fs::create_directories(folder / name);
  for (const char* name : {"images/v.png", "images/cam0/w.jpg", "images/cam1/w.jpg", "flat/w.jpg",
                           "flat/x.jpg", "images/a\\b.png"})
    write_text(folder / name, "");
  for (const char* name : {"images/v.png", "./images/v.png", "images\\v.png", "C:\\data\\images\\v.png",
                           "v.png", "../data/v.png", "/data/images/v", "images\\v"}) {
    EXPECT_EQ(photos_of(folder, "images", {name}), CameraNames{"images/v.png"}) << name;
    EXPECT_EQ(photos_of(folder, "images/", {name}), CameraNames{"images/v.png"}) << name;
  }
  EXPECT_EQ(photos_of(folder, "", {"images\\v.png"}), CameraNames{"images/v.png"});
  EXPECT_EQ(photos_of(folder, "images", {"a\\b.png"}), CameraNames{"images/a\\b.png"})
      << "a file of this name";
  EXPECT_EQ(photos_of(folder, "flat", {"cam0/x.jpg", "cam1/y.jpg"}), (CameraNames{"flat/x.jpg", ""}));
  // If view names differ only by folder, no view gets a photo of another.
  for (const char* before : {"", "C:\\s\\", "/s/"}) {
    const CameraNames cams = {before + std::string("cam0/w.jpg"), before + std::string("cam1/w.jpg")};
    EXPECT_EQ(photos_of(folder, "images", cams), (CameraNames{"images/cam0/w.jpg", "images/cam1/w.jpg"}));
    EXPECT_EQ(photos_of(folder, "images/cam1", cams), (CameraNames{"", "images/cam1/w.jpg"}));
    EXPECT_EQ(photos_of(folder, "flat", cams), (CameraNames{"", ""}));
  }
  EXPECT_EQ(photos_of(folder, "flat", {"cam0/w.jpg", "cam1/w.png"}), (CameraNames{"", ""}));
}

TEST(CameraNames, RejectSharedPhoto) {
  const TempFolder folder;
  const auto check = [&](const CameraNames& names) {
    std::vector<Camera> views(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) views[i].name = names[i];
    check_photos_unique(folder.path(), views);
  };
  fs::create_directories(folder / "left");
  fs::create_directories(folder / "right");
  for (const char* name : {"a.jpg", "left/1.jpg", "right/1.jpg", "b_c.jpg"}) write_text(folder / name, "");
  EXPECT_TRUE(test::fails_saying(
      [&] {
        check({"a.jpg", "left/1.jpg", "a.png"});
      },
      {"a.jpg matches the views 'a.jpg' and 'a.png'"}));
  EXPECT_ERROR(check({"a", "a.jpg"}), "the views 'a' and 'a.jpg'");
  EXPECT_ERROR(check({"b/c", "b_c.jpg"}), "b_c.jpg matches");
  EXPECT_ERROR(check({"left/1.jpg", "right/../left/1"}), "1.jpg matches");
  check({"a.jpg", "left/1.jpg", "right/1.jpg", "none.jpg", "none.png"});
  // The error ends once the other view has a photo with its exact name.
  write_text(folder / "a.png", "");
  check({"a.jpg", "a.png"});
}

}  // namespace
}  // namespace binosplat
