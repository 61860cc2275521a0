// What views are called, and whose photos they take: no two may be mistaken for each other.

#include <gtest/gtest.h>

#include "formats/cameras_file.h"
#include "formats/view_files.h"
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

/// The names of a reconstruction's views whose images.txt is `images`.
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

TEST(CameraNames, OfColmapsTextAreAllThatIsLeftOfTheLine) {
  EXPECT_EQ(names_in(image(1, "IMG.jpg") + image(2, "IMG (1).jpg") + image(3, "IMG (2).jpg")),
            (CameraNames{"IMG (1).jpg", "IMG (2).jpg", "IMG.jpg"}));
  EXPECT_EQ(names_in(image(1, "left/0001.jpg") + image(2, "right/0001.jpg") + image(3, "left/0001.png")),
            (CameraNames{"left/0001.jpg", "left/0001.png", "right/0001.jpg"}));
  EXPECT_EQ(names_in(image(1, "Bild  3 \xc3\xa4.jpg")), CameraNames{"Bild  3 \xc3\xa4.jpg"})
      << "two blanks, UTF-8";
  // Blanks and tabs between fields and at the end of a line are none of a name's; neither is CR.
  EXPECT_EQ(names_in("1\t1 0 0 0  0 0 0 1\t  a b.jpg \t\r\n\r\n2 1 0 0 0 0 0 0 1 c d\r\n"),
            (CameraNames{"a b.jpg", "c d"}));
  EXPECT_EQ(names_in("\xef\xbb\xbf# a comment\r\n  # another\n\n" + image(1, "# 1.jpg")),
            CameraNames{"# 1.jpg"});
  EXPECT_EQ(names_in("1 1 0 0 0 0 0 0 1 a b\n1.5 2.5 -1 3 4 17\n" + image(2, "3 4 5")),
            (CameraNames{"3 4 5", "a b"}));
}

TEST(CameraNames, AnImageIsNotTakenForThePointsOfAnother) {
  // Twelve words, as many as of four points, in the place of the points.
  const std::string two = "1 1 0 0 0 0 0 0 1 a.jpg\n2 1 0 0 0 0 0 0 1 my b c.jpg\n";
  EXPECT_TRUE(test::fails_saying([&] { names_in(two); }, {"images.txt, line 2", "points seen in image 1"}));
}

/// Of two cameras of these names, each kind of file.
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

TEST(CameraNames, ThatOccurTwiceStopEveryReader) {
  for (const auto& [kind, files] : pairs_of("same name.jpg", "same name.jpg")) {
    const TempFolder folder;
    for (const auto& [name, text] : files) write_text(folder / name, text);
    EXPECT_TRUE(test::fails_saying([&] { load_cameras(folder.path()); },
                                   {folder.path().string(), "two cameras are called 'same name.jpg'"}))
        << kind;
  }
  // As they should be.
  for (const auto& [kind, files] : pairs_of("left/1.jpg", "right/1.jpg")) {
    const TempFolder folder;
    for (const auto& [name, text] : files) write_text(folder / name, text);
    EXPECT_EQ(load_cameras(folder.path()).size(), 2u) << kind;
  }
}

TEST(CameraNames, NoTwoViewsTakeOnePhoto) {
  const TempFolder folder;
  const auto check = [&](const CameraNames& names) {
    std::vector<Camera> views(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) views[i].name = names[i];
    check_photos_apart(folder.path(), views);
  };
  fs::create_directories(folder / "left");
  fs::create_directories(folder / "right");
  for (const char* name : {"a.jpg", "left/1.jpg", "right/1.jpg", "b_c.jpg"}) write_text(folder / name, "");
  EXPECT_TRUE(test::fails_saying(
      [&] {
        check({"a.jpg", "left/1.jpg", "a.png"});
      },
      {"a.jpg would be the photo of both views 'a.jpg' and 'a.png'"}));
  EXPECT_TRUE(test::fails_saying([&] { check({"a", "a.jpg"}); }, {"both views 'a' and 'a.jpg'"}));
  EXPECT_TRUE(test::fails_saying([&] { check({"b/c", "b_c.jpg"}); }, {"b_c.jpg would be the photo"}));
  EXPECT_TRUE(test::fails_saying([&] { check({"left/1.jpg", "right/../left/1"}); }, {"1.jpg would be"}));
  check({"a.jpg", "left/1.jpg", "right/1.jpg", "none.jpg", "none.png"});
  // Once the other has its own.
  write_text(folder / "a.png", "");
  check({"a.jpg", "a.png"});
}

}  // namespace
}  // namespace binosplat
