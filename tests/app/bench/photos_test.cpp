// Photos of every kind for --photos and compare: grey, with alpha, as OpenEXR, and unreadable ones.

#include <cmath>

#include "app/scene.h"
#include "formats/pictures/exr.h"
#include "measure/comparison.h"

namespace binosplat {
namespace {

struct Photos : SceneTest {
  Photos() {
    // Colours within 0 to 1, because 8-bit files hold no others.
    PlyFile file = small_model();
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      for (std::size_t k = 0; k < file.columns.size(); ++k)
        file.rows[i][k] *= file.columns[k].starts_with("f_") ? 0.2 : 1.0;
    }
    write_text(model, to_bytes(file));
    add_cameras();
    fs::create_directories(photos);
    EXPECT_TRUE(good(render(joined(front, {"-o", folder / "exact.png"}))));
    exact = load_image(folder / "exact.png");
  }

  /// Returns the PSNR against the photo. Infinity is null in JSON.
  double psnr(const Words& more = {}) const {
    const auto found =
        reported(joined(joined(front, {"--photos", photos}), more))["views"][0]["photo_psnr_db"];
    return found.is_null() ? INFINITY : found.get<double>();
  }

  Image rgba(float alpha) const {
    Image image(exact.width, exact.height, 4);
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = i % 4 == 3 ? alpha : exact.data[i / 4 * 3 + i % 4];
    return image;
  }

  const Words front = {"--view", "front", "--mono"};
  const std::string photos = folder / "photos", photo = folder / "photos/front.png";
  Image exact;
};

TEST_F(Photos, AreComparedAsEightBits) {
  save_png(photo, exact);
  EXPECT_EQ(psnr({"--bits", "16"}), INFINITY);
  for (const int bits : {8, 16}) {  // opaque alpha is ignored
    save_png(photo, rgba(1.0f), {.bits = bits});
    EXPECT_EQ(psnr(), INFINITY) << bits;
    EXPECT_EQ(run_program({"compare", folder / "exact.png", photo, "--min-psnr", "200"}).code, 0);
  }
  Image other = exact;
  other.at(10, 10, 0) += other.at(10, 10, 0) > 0.5f ? -0.2f : 0.2f;
  save_png(photo, other);
  EXPECT_NEAR(psnr(), -10.0 * std::log10(0.2 * 0.2 / (72 * 48 * 3)), 0.001);
}

TEST_F(Photos, AlphaUsesPictureBackground) {
  // The photo is the model without its background.
  ASSERT_TRUE(good(render(joined(front, {"--background", "none", "-o", photo}))));
  for (const std::string background : {"1,1,1", "0.1,0.8,0.3"}) {
    const std::string drawn = folder / (background + ".png");
    // The picture is rounded to 8 bits twice.
    EXPECT_GT(psnr({"--background", background, "-o", drawn}), 45.0) << background;
    EXPECT_TRUE(good(run_program({"compare", drawn, photo, "--background", background, "--min-psnr", "45"})));
  }
  EXPECT_TRUE(has(render(joined(front, {"--photos", photos, "--background", "1,1,1"})).err,
                  "front.png has alpha: photos with alpha are compared over the background 1,1,1"));
  // Injected fault: another background.
  EXPECT_EQ(run_program({"compare", folder / "1,1,1.png", photo, "--min-psnr", "45"}).code, 1);
  EXPECT_TRUE(ended(run_program({"compare", folder / "exact.png", photo, "--json", folder / "c.json"}), 0,
                    "over the background 0,0,0"));
  EXPECT_EQ(load_json(folder / "c.json")["background"], json({0, 0, 0}));
}

TEST_F(Photos, AcceptGreyAndOpenExr) {
  Image grey(exact.width, exact.height, 1);
  for (std::size_t i = 0; i < grey.data.size(); ++i) grey.data[i] = exact.data[3 * i];
  save_png(photo, grey);
  Image a = exact, b = grey;
  measure::prepare_comparison(a, b);
  EXPECT_NEAR(psnr(), measure::psnr(a, b), 1e-3);
  fs::remove(photo);
  ASSERT_TRUE(good(render(joined(front, {"--exr", "float", "-o", photos + "/front.exr"}))));
  EXPECT_GT(psnr(), 57.0);  // except for the picture's rounding
}

TEST_F(Photos, UnreadablePhotoFailsEarly) {
  const std::string whole = png_bytes(exact), cameras = folder / "cameras2.json";
  write_text(folder / "broken.ply", "no model");
  fs::copy(folder / "cameras.json", cameras);
  const auto run = [&](const char* command, const Words& more) {
    fs::remove_all(folder / "new");
    return run_program(
        joined({command, folder / "broken.ply", "--photos", photos, "--cameras", cameras}, more));
  };
  const std::pair<const char*, Words> commands[] = {
      {"render", {"--view", "front", "--mono", "-o", out}},
      {"calibrate", {"--max-drop", "1", "-o", folder / "c.json"}},
      {"trim", {"--max-drop", "1", "-o", folder / "t.ply"}},
      {"refit", {"-o", folder / "f.ply"}},
      {"bench", {"-o", folder / "new"}},
      {"bench", {"--suite", "paper", "-o", folder / "new"}},
  };
  const auto refused = [&](const std::string& bytes, const std::string& said) {
    write_text(photo, bytes);
    for (const auto& [command, more] : commands) EXPECT_TRUE(ended(run(command, more), 2, said)) << command;
  };
  refused("no picture", "front.png is not a picture that can be read");
  refused(png_bytes(Image(5, 5, 4)), "front.png has 5 x 5 px");
  // Injected fault: with a readable photo, the error names the model.
  refused(whole, "broken.ply");
  // Without any photo, all else is correct.
  fs::remove(photo);
  fs::copy_file(model, folder / "broken.ply", fs::copy_options::overwrite_existing);
  for (const auto& [command, more] : commands)
    EXPECT_TRUE(ended(run(command, more), 2, "there is no photo of any view")) << command;
  EXPECT_TRUE(ended(run("render", commands[0].second), 2, "drawn, for one front.jpg"));
}

}  // namespace
}  // namespace binosplat
