// Camera files of users: the pictures drawn from them, the photos that match their views, and errors.

#include <cmath>

#include "app/scene.h"

namespace binosplat {
namespace {

struct CameraFiles : SceneTest {
  const std::string report = folder / "r.json", ply = folder / "t.ply";

  /// Writes a COLMAP reconstruction with one lens and views 0.3 apart that look along z.
  void save_colmap(const std::string& lens, const Words& names) const {
    fs::create_directories(folder / "sparse/0");
    write_text(folder / "sparse/0/cameras.txt", "1 " + lens + "\n");
    std::string images;
    for (std::size_t i = 0; i < names.size(); ++i)
      images += fmt::format("{} 1 0 0 0 {} 0 0 1 {}\n\n", i + 1, 0.3 * static_cast<double>(i), names[i]);
    write_text(folder / "sparse/0/images.txt", images);
  }

  /// Draws the views as photos into `images`.
  void take_photos() const { ASSERT_TRUE(good(mono({"--view", "all", "-o", folder / "images"}))); }

  Outcome mono(const Words& words) const { return render(joined(words, {"--mono", "--json", report})); }

  /// Returns the PSNR of each view against its photo, or -1 without a photo.
  std::vector<double> photo_psnr() const {
    const json drawn = load_json(report);
    std::vector<double> all;
    for (const json& view : drawn.at("views")) {
      const auto db = view.find("photo_psnr_db");
      all.push_back(db == view.end() ? -1.0 : db->is_null() ? INFINITY : db->get<double>());
    }
    return all;
  }

  /// Returns the only picture of a run, and removes its folder.
  std::vector<float> picture(const Words& arguments) const {
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

TEST_F(CameraFiles, MatchesEachViewToOnePhoto) {
  const Words views = {"IMG.png", "IMG (1).png", "left/1.png", "right/1.png", "left_1.png"};
  save_colmap(pinhole, views);
  // The run writes all pictures. Copies with the views' own names then serve as the photos of these views.
  ASSERT_TRUE(good(mono({"--view", "all", "-o", folder / "drawn"})));
  for (const char* side : {"left", "right"}) fs::create_directories(folder / "images" / side);
  const Words drawn = {"IMG.png", "IMG (1).png", "left_1.png", "right_1.png", "left_1_2.png"};
  for (std::size_t i = 0; i < views.size(); ++i)
    fs::copy(folder / "drawn" / drawn[i], folder / "images" / views[i]);
  const auto others = [&] {
    EXPECT_TRUE(good(mono({"--view", "all", "--photos", "beside"})));
    return std::ranges::count_if(photo_psnr(), [](double db) { return db != INFINITY; });
  };
  EXPECT_EQ(others(), 0);
  // Injected fault: one view's photo replaces another's.
  fs::copy(folder / "images/IMG.png", folder / "images/IMG (1).png", fs::copy_options::overwrite_existing);
  EXPECT_EQ(others(), 1);
}

TEST_F(CameraFiles, RejectsTwoViewsOfOnePhoto) {
  save_colmap(pinhole, {"a.png", "b.png", "c.png", "d.png"});
  const std::string photos = folder / "images";
  ASSERT_TRUE(good(mono({"--view", "all", "-o", photos})));
  save_colmap(pinhole, {"a.png", "b.png", "c.png", "a.jpg"});
  const std::string said = "a.png matches the views 'a.jpg' and 'a.png'";
  expect_refused({{{"--view", "all", "--photos", "beside"}, said},
                  {{"--view", "a.jpg", "--photos", photos}, said}},  // only one is drawn, but all are checked
                 {"--mono"});
  expect_refused_after({}, {{{"trim", model, "--photos", photos, "--max-drop", "1", "-o", ply}, said},
                            {{"calibrate", model, "--photos", photos, "--max-drop", "1"}, said},
                            {{"refit", model, "--photos", photos, "-o", ply}, said}});
}

TEST_F(CameraFiles, InvalidDefaultCamerasOnlyWarn) {
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
    // A camera file named by the user must be valid.
    const std::string named = std::string(name) == "cameras.bin" ? folder.path().string() : file;
    EXPECT_EQ(mono({"--cameras", named}).code, 2) << text;
    fs::remove(file);
  }
  write_text(folder / "cameras.json", "[]");
  fs::remove_all(out);
  const std::string photos = folder / "images";
  expect_refused({{{"--view", "a"}, cannot},
                  {{"--tour", "walk"}, cannot},
                  {{"--photos", photos}, "the model cannot be used: "}},
                 {"--mono"});
  expect_refused_after({},
                       {{{"trim", model, "--quality", "40", "-o", ply}, cannot},
                        {{"refit", model, "--against", "exact", "-o", ply}, cannot},
                        {{"bench", model, "--photos", photos}, "cannot be used: "},
                        {{"calibrate", model, "--photos", photos, "--max-drop", "1"}, "cannot be used: "}});
  EXPECT_TRUE(
      ended(run_program({"info", model, "--views"}), 0, "holds no cameras; cameras are made up instead"));
}

TEST_F(CameraFiles, UnusedUnsupportedLensesOnlyWarn) {
  save_colmap(fisheye, {"a.jpg", "b.jpg"});
  const char* what = "lens of the model OPENCV_FISHEYE, which is not a pinhole";
  EXPECT_TRUE(ended(mono({"--size", "36x24"}), 0, what));
  EXPECT_TRUE(ended(mono({"--size", "36x24", "--eye", "0,0,0", "--at", "0,0,4"}), 0, what));
  save("other.json", json{camera_json("front", 0.0)});
  EXPECT_EQ(mono({"--cameras", folder / "other.json"}).code, 0);
  // If views of these lenses are requested, they are an error.
  expect_refused({{{"--view", "a.jpg"}, what},
                  {{"--tour", "walk"}, what},
                  {{"--cameras", folder / "sparse/0"}, what},
                  {{"--photos", folder.path()}, ""}},
                 {"--mono"});
}

TEST_F(CameraFiles, PosesUseRequestedLens) {
  save("front.json", json{camera_json("front", 0.0)});
  const std::vector<float> expected = picture({"--cameras", folder / "front.json"});
  const std::string file = folder / "poses.json";
  write_text(file,
             R"([{"file_path": "images/a.png", "transform": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0]]}])");
  const std::string fov = fmt::format("{}", 2 * 180 / M_PI * std::atan(0.4));
  EXPECT_TRUE(picture({"--cameras", file, "--fov", fov, "--size", "72x48"}) == expected);
  EXPECT_TRUE(picture({"--cameras", file, "--size", "72x48"}) != expected) << "60 degrees";
  EXPECT_TRUE(ended(mono({"--cameras", file, "--size", "72x48"}), 0, "has poses but no lenses"));
  EXPECT_TRUE(
      ended(mono({"--cameras", folder / "front.json", "--fov", "50"}), 2, "--up and --fov are for cameras"));
}

TEST_F(CameraFiles, PlyCameraIsFirstView) {
  add_cameras();
  const std::vector<float> expected = picture({"--view", "side"});
  PlyFile file = small_model();
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
      << "the injected fault: another camera";
}

// A model with only COLMAP's reconstruction and the photos in its folder.
TEST_F(CameraFiles, ColmapGivesPublishedPsnr) {
  REQUIRE_SCENE("fox", scene);
  fs::create_directories(folder / "fox");
  for (const char* name : {"fox.ply", "sparse", "photos"})
    fs::create_symlink(scene / name, folder / "fox" / name);
  const bool all = test::switched_on("BINOSPLAT_LONG");
  Words words = {"render", folder / "fox/fox.ply", "--mono", "--photos", "beside", "--json", report};
  const json published = load_json(scene / "psnr.json");
  for (const auto& [view, psnr] : published.items()) {
    if (all || view == "0001" || view == "0110") words.insert(words.end(), {"--view", view + ".jpg"});
  }
  ASSERT_TRUE(good(run_into_out(words)));
  const json views = load_json(report)["views"];
  EXPECT_EQ(views.size(), all ? 7u : 2u);
  for (const json& view : views) {
    const std::string name = fs::path(view["name"].get<std::string>()).stem();
    const double psnr = view["photo_psnr_db"];
    EXPECT_NEAR(psnr, published[name].get<double>(), 0.02) << name;
    // Injected fault: another view's number.
    EXPECT_GT(std::abs(psnr - published[name == "0001" ? "0110" : "0001"].get<double>()), 0.02);
  }
}

}  // namespace
}  // namespace binosplat
