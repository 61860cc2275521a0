// Files of cameras as users have them: what is drawn of each, whose photo it is compared with, and what
// stops.

#include <cmath>

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::has;
using test::Outcome;
using test::write_text;

namespace fs = std::filesystem;
using nlohmann::json;

struct CameraFiles : test::SceneTest {
  const std::string report = folder / "r.json";

  /// A reconstruction with a lens of COLMAP's, of views 0.3 apart that look along z.
  void save_colmap(const std::string& lens, const std::vector<std::string>& names) const {
    fs::create_directories(folder / "sparse/0");
    write_text(folder / "sparse/0/cameras.txt", "1 " + lens + "\n");
    std::string images;
    for (std::size_t i = 0; i < names.size(); ++i)
      images += fmt::format("{} 1 0 0 0 {} 0 0 1 {}\n\n", i + 1, 0.3 * static_cast<double>(i), names[i]);
    write_text(folder / "sparse/0/images.txt", images);
  }

  /// Photos in `images`: what the views themselves show.
  void take_photos() const { ASSERT_TRUE(good(mono({"--view", "all", "-o", folder / "images"}))); }

  Outcome mono(const test::Words& words) const { return render(joined(words, {"--mono", "--json", report})); }

  /// The PSNR of each view against its photo; -1 without one.
  std::vector<double> photo_psnr() const {
    const json drawn = test::load_json(report);
    std::vector<double> all;
    for (const json& view : drawn.at("views")) {
      const auto db = view.find("photo_psnr_db");
      all.push_back(db == view.end() ? -1.0 : db->is_null() ? INFINITY : db->get<double>());
    }
    return all;
  }

  /// The one picture of a run, in a folder that is then gone.
  std::vector<float> picture(const std::vector<std::string>& arguments) const {
    EXPECT_TRUE(good(mono(arguments)));
    std::vector<float> pixels;
    for (const auto& entry : fs::directory_iterator(out)) {
      if (entry.path().extension() == ".png") pixels = load_image(entry.path()).data;
    }
    fs::remove_all(out);
    return pixels;
  }
};

const std::string pinhole = "PINHOLE 72 48 60 60 36 24";
const std::string fisheye = "OPENCV_FISHEYE 72 48 60 60 36 24 0 0 0 0";

TEST_F(CameraFiles, NamesWithBlanksHavePhotosOfTheirOwn) {
  save_colmap(pinhole, {"IMG.png", "IMG (1).png", "IMG (2).png"});
  take_photos();
  ASSERT_TRUE(good(mono({"--view", "all", "--photos", "beside"})));
  EXPECT_EQ(photo_psnr(), (std::vector<double>(3, INFINITY)));
  // Planted fault: one view's photo in the place of another's.
  fs::copy(folder / "images/IMG.png", folder / "images/IMG (1).png", fs::copy_options::overwrite_existing);
  ASSERT_TRUE(good(mono({"--view", "all", "--photos", "beside"})));
  std::size_t others = 0;
  for (const double db : photo_psnr()) others += db > 0.0 && db < 60.0 ? 1 : 0;
  EXPECT_EQ(others, 1u);
}

TEST_F(CameraFiles, FoldersAndEndingsTellViewsApart) {
  save_colmap(pinhole, {"left/1.png", "right/1.png", "left_1.png"});
  // All three are written, and as photos under their own names each is its view's.
  ASSERT_TRUE(good(mono({"--view", "all", "-o", folder / "drawn"})));
  fs::create_directories(folder / "images/left");
  fs::create_directories(folder / "images/right");
  for (const auto& [file, view] : std::map<std::string, std::string>{
           {"left_1.png", "left/1.png"}, {"left_1_2.png", "left_1.png"}, {"right_1.png", "right/1.png"}})
    fs::copy(folder / "drawn" / file, folder / "images" / view);
  ASSERT_TRUE(good(mono({"--view", "all", "--photos", "beside"})));
  EXPECT_EQ(photo_psnr(), (std::vector<double>(3, INFINITY)));
}

TEST_F(CameraFiles, TwoViewsOfOnePhotoStopAllThatMeasuresByPhotos) {
  save_colmap(pinhole, {"a.png", "b.png", "c.png", "d.png"});
  take_photos();
  const std::string photos = folder / "images";
  save_colmap(pinhole, {"a.png", "b.png", "c.png", "a.jpg"});
  const auto stops = [](const Outcome& outcome) {
    return ended(outcome, 2, "a.png would be the photo of both views 'a.jpg' and 'a.png'");
  };
  EXPECT_TRUE(stops(mono({"--view", "all", "--photos", "beside"})));
  EXPECT_TRUE(stops(mono({"--view", "a.jpg", "--photos", photos}))) << "though only one is drawn";
  for (const char* command : {"trim", "calibrate"}) {
    EXPECT_TRUE(stops(test::run_program({command, model, "--photos", photos, "--max-drop", "1", "-o",
                                         folder / (std::string(command) == "trim" ? "t.ply" : "t.json")})))
        << command;
  }
  EXPECT_TRUE(stops(test::run_program({"refit", model, "--photos", photos, "-o", folder / "t.ply"})));
}

// Of NeRF's synthetic scenes INRIA's trainer writes r_0 twice.
TEST_F(CameraFiles, TwoViewsOfOneNameAreBothDrawn) {
  const json cameras = {test::camera_json("r_0", 0.0), test::camera_json("r_1", 0.2),
                        test::camera_json("r_0", 0.4)};
  write_text(folder / "cameras.json", cameras.dump());
  const std::vector<float> first = picture({"--view", "r_0"}), other = picture({"--view", "r_0_2"});
  EXPECT_TRUE(first != other);
  EXPECT_TRUE(picture({}) == first);
  write_text(folder / "third.json", json{cameras[2]}.dump());
  EXPECT_TRUE(picture({"--cameras", folder / "third.json"}) == other);
  ASSERT_TRUE(good(mono({"--view", "all", "--cameras", folder / "cameras.json"})));
  for (const char* name : {"r_0", "r_1", "r_0_2"}) EXPECT_TRUE(fs::exists(out + "/" + name + ".png")) << name;
}

TEST_F(CameraFiles, CamerasThatNobodyNamedStopNoPicture) {
  fs::create_directories(folder / "images");
  const json frame = {{"file_path", "./train/r_0"},
                      {"transform_matrix", json::parse("[[1,0,0,0],[0,1,0,0],[0,0,1,0]]")}};
  const std::pair<const char*, std::string> broken[] = {
      {"cameras.json", "[{\"id\": 0"},
      {"cameras.json", ""},
      {"cameras.json", "[]"},
      {"cameras.json", "7"},
      {"cameras.json", R"({"version": 1, "cameras": [{"fov": 60}]})"},
      {"transforms_train.json", json{{"camera_angle_x", 1.04}, {"frames", {frame}}}.dump()},
      {"cameras.bin", ""}};
  const std::string cannot = "the cameras beside " + model + " cannot be used: ";
  for (const auto& [name, text] : broken) {
    const std::string file = folder / name;
    write_text(file, text);
    if (std::string(name) == "cameras.bin") write_text(folder / "images.bin", "");
    const Outcome drawn = mono({"--size", "36x24"});
    EXPECT_TRUE(ended(drawn, 0, "; cameras are made up instead"));
    EXPECT_TRUE(ended(drawn, 0, "warning: " + (folder.path() / "").string()));
    EXPECT_EQ(drawn.err.find("warning:"), drawn.err.rfind("warning:")) << drawn.err;
    // Whatever needs them, or names their file, does not go on without.
    EXPECT_TRUE(ended(mono({"--view", "a"}), 2, cannot)) << text;
    EXPECT_TRUE(ended(mono({"--tour", "walk"}), 2, cannot)) << text;
    EXPECT_TRUE(ended(mono({"--photos", folder / "images"}), 2, "the model cannot be used: ")) << text;
    const std::string named = std::string(name) == "cameras.bin" ? folder.path().string() : file;
    EXPECT_EQ(mono({"--cameras", named}).code, 2) << text;
    fs::remove(file);
  }
  write_text(folder / "cameras.json", "[]");
  const auto run = [](const test::Words& words) { return test::run_program(words); };
  EXPECT_TRUE(ended(run({"info", model, "--views"}), 0, "holds no cameras; cameras are made up instead"));
  EXPECT_TRUE(ended(run({"convert", model, "-o", folder / "c.spz", "--report", "1", "--size", "36x24"}), 0,
                    "holds no cameras; cameras are made up instead"));
  EXPECT_TRUE(
      ended(run({"levels", model, "-o", folder / "levels"}), 0, "no cameras are left beside the levels"));
  EXPECT_TRUE(ended(run({"trim", model, "--quality", "40", "-o", folder / "t.ply"}), 2, cannot));
  EXPECT_TRUE(ended(run({"refit", model, "--against", "exact", "-o", folder / "t.ply"}), 2, cannot));
  for (const char* command : {"bench", "calibrate"}) {
    test::Words words = {command, model, "--photos", folder / "images", "-o", folder / "o.json"};
    if (std::string(command) == "calibrate") words.insert(words.end(), {"--max-drop", "1"});
    EXPECT_TRUE(ended(run(words), 2, "cannot be used: ")) << command;
  }
}

TEST_F(CameraFiles, PhotosOfPathsThatOtherProgramsWrote) {
  save_colmap(pinhole, {"v.png"});
  take_photos();
  fs::remove_all(folder / "sparse");
  for (const char* path : {"images/v.png", "images\\v.png", "C:\\data\\images\\v.png"}) {
    json frames = {
        {"frames",
         {{{"file_path", path}, {"transform_matrix", json::parse("[[1,0,0,0],[0,-1,0,0],[0,0,-1,0]]")}}}},
        {"fl_x", 60}};
    for (const bool sized : {true, false}) {
      if (sized) frames["w"] = 72, frames["h"] = 48;
      write_text(folder / "transforms.json", frames.dump());
      frames.erase("w");
      for (const std::string& photos : {std::string(folder / "images"), std::string("beside")}) {
        ASSERT_TRUE(good(mono({"--photos", photos}))) << path;
        EXPECT_EQ(photo_psnr(), std::vector<double>{INFINITY}) << path;
      }
    }
  }
}

TEST_F(CameraFiles, LensesThatCannotBeDrawnAreAWarningWhereOthersWillDo) {
  save_colmap(fisheye, {"a.jpg", "b.jpg"});
  const char* what = "lens of the model OPENCV_FISHEYE, which is no pinhole's";
  EXPECT_TRUE(ended(mono({"--size", "36x24"}), 0, what));
  EXPECT_TRUE(ended(mono({"--size", "36x24", "--eye", "0,0,0", "--at", "0,0,4"}), 0, what));
  write_text(folder / "other.json", json{test::camera_json("front", 0.0)}.dump());
  EXPECT_EQ(mono({"--cameras", folder / "other.json"}).code, 0);
  // Where they are asked for, they are an error.
  EXPECT_TRUE(ended(mono({"--view", "a.jpg"}), 2, what));
  EXPECT_TRUE(ended(mono({"--view", "all"}), 2, what));
  EXPECT_TRUE(ended(mono({"--tour", "walk"}), 2, what));
  EXPECT_TRUE(ended(mono({"--cameras", folder / "sparse/0"}), 2, what));
  EXPECT_EQ(mono({"--photos", folder.path()}).code, 2);
}

TEST_F(CameraFiles, DistortionOfZeroIsDrawnAndMoreIsDrawnWithAWarning) {
  save_colmap(pinhole, {"a.jpg"});
  const std::vector<float> expected = picture({});
  save_colmap("FULL_OPENCV 72 48 60 60 36 24 0 0 0 0 0 0 0 0", {"a.jpg"});
  EXPECT_FALSE(has(mono({}).err, "distorted"));
  fs::remove_all(out);
  EXPECT_TRUE(picture({}) == expected);
  save_colmap("SIMPLE_RADIAL 72 48 60 36 24 0.1", {"a.jpg"});
  // r = 43.27 px of 60: 43.27 * 0.1 * 0.52.
  EXPECT_TRUE(ended(mono({}), 0, "It moves the farthest corner of a picture by 2.25 px"));
  fs::remove_all(out);
  EXPECT_TRUE(picture({}) == expected);
}

/// What a camera at the origin that looks along z is with OpenGL's axes.
const json opengl_rows = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};

TEST_F(CameraFiles, PathsOfNerfstudioAreViewsAndPaths) {
  write_text(folder / "front.json", json{test::camera_json("front", 0.0)}.dump());
  const std::vector<float> expected = picture({"--cameras", folder / "front.json"});
  json path = {{"render_width", 72},
               {"render_height", 48},
               {"fps", 24},
               {"seconds", 0.125},
               {"keyframes", json::array()}};
  for (const double x : {0.0, 0.1, 0.2}) {
    json frame = {
        {"camera_to_world", opengl_rows}, {"fov", 2 * 180 / M_PI * std::atan(0.4)}, {"aspect", 1.5}};
    frame["camera_to_world"][3] = x;
    path["camera_path"].push_back(frame);
  }
  const std::string file = folder / "camera_path.json";
  write_text(file, path.dump());
  EXPECT_TRUE(picture({"--cameras", file}) == expected);
  EXPECT_TRUE(picture({"--cameras", file, "--view", "00001"}) != expected)
      << "the planted fault: another frame";
  ASSERT_TRUE(good(mono({"--path", file})));
  for (const char* name : {"00000", "00001", "00002"}) EXPECT_TRUE(fs::exists(out + "/" + name + ".png"));
  EXPECT_TRUE(load_image(out + "/00000.png").data == expected);
}

TEST_F(CameraFiles, PosesTakeTheLensThatIsAskedFor) {
  write_text(folder / "front.json", json{test::camera_json("front", 0.0)}.dump());
  const std::vector<float> expected = picture({"--cameras", folder / "front.json"});
  const std::string file = folder / "poses.json";
  write_text(file,
             R"([{"file_path": "images/a.png", "transform": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0]]}])");
  const std::string fov = fmt::format("{}", 2 * 180 / M_PI * std::atan(0.4));
  EXPECT_TRUE(picture({"--cameras", file, "--fov", fov, "--size", "72x48"}) == expected);
  EXPECT_TRUE(picture({"--cameras", file, "--size", "72x48"}) != expected) << "60 degrees";
  EXPECT_TRUE(ended(mono({"--cameras", file, "--size", "72x48"}), 0, "tells poses and no lenses"));
  EXPECT_TRUE(
      ended(mono({"--cameras", folder / "front.json", "--fov", "50"}), 2, "--up and --fov are for cameras"));
}

TEST_F(CameraFiles, TheCameraInAModelsPlyIsItsFirstView) {
  add_cameras();
  const std::vector<float> expected = picture({"--view", "side"});
  test::PlyFile file = test::small_model();
  const auto add = [&](const char* name, const std::vector<double>& numbers) {
    file.header_after += fmt::format("element {0} {1}\nproperty float {0}\n", name, numbers.size());
    for (const double number : numbers) test::append_value(file.data_after, file.format, "float", number);
  };
  add("extrinsic", {1, 0, 0, -0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  add("intrinsic", {60, 0, 36, 0, 60, 24, 0, 0, 1});
  add("image_size", {72, 48});
  write_text(model, to_bytes(file));
  EXPECT_TRUE(picture({}) == expected);
  EXPECT_TRUE(picture({"--cameras", folder / "cameras.json"}) != expected)
      << "the planted fault: another camera";
}

}  // namespace
}  // namespace binosplat
