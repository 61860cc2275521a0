// Photos of every kind in --photos and compare: grey, with alpha, as OpenEXR; and those that cannot be read.

#include <cmath>

#include "app/scene.h"
#include "formats/exr.h"
#include "formats/image_file.h"
#include "measure/comparison.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::run_program;

struct Photos : test::SceneTest {
  Photos() {
    // Colours within 0 to 1: files of 8 bits have no others.
    test::PlyFile file = test::small_model();
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      for (std::size_t k = 0; k < file.columns.size(); ++k)
        file.rows[i][k] *= file.columns[k].starts_with("f_") ? 0.2 : 1.0;
    }
    test::write_text(model, to_bytes(file));
    add_cameras();
    std::filesystem::create_directories(photos);
    EXPECT_TRUE(good(render({"--view", "front", "--mono", "-o", folder / "exact.png"})));
    exact = load_image(folder / "exact.png");
  }

  Outcome against(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--view", "front", "--mono", "--photos",       photos,
                                          "-o",     out,     "--json", folder / "r.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return render(arguments);
  }
  /// PSNR against the photo; infinite is null in JSON.
  double psnr(const std::vector<std::string>& more = {}) const {
    const Outcome outcome = against(more);
    EXPECT_TRUE(good(outcome));
    const auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
    const auto& found = json.at("views").at(0).at("photo_psnr_db");
    return found.is_null() ? INFINITY : found.get<double>();
  }

  Image rgba(float alpha) const {
    Image image(exact.width, exact.height, 4);
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = i % 4 == 3 ? alpha : exact.data[i / 4 * 3 + i % 4];
    return image;
  }

  const std::string photos = folder / "photos", photo = folder / "photos/front.png";
  Image exact;
};

TEST_F(Photos, OpaqueAlphaIsLeftOut) {
  for (const int bits : {8, 16}) {
    save_png(photo, rgba(1.0f), bits);
    EXPECT_EQ(psnr(), INFINITY) << bits;
    EXPECT_EQ(against().err.find("has alpha"), std::string::npos);
    EXPECT_EQ(run_program({"compare", folder / "exact.png", photo, "--min-psnr", "200"}).code, 0);
  }
}

TEST_F(Photos, AnyOtherIsBeforeTheBackgroundOfThePictures) {
  // The model cut out: what it covers, and a quarter less of all.
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "--background", "none", "-o", folder / "cut.png"})));
  std::filesystem::copy(folder / "cut.png", photo);
  for (const char* background : {"0,0,0", "1,1,1", "0.1,0.8,0.3"}) {
    EXPECT_GT(psnr({"--background", background}), 45.0) << background;  // 8 bits twice
    const Outcome outcome = against({"--background", background});
    EXPECT_NE(outcome.err.find(std::string("front.png has alpha: it is compared before the background ") +
                               background),
              std::string::npos)
        << outcome.err;
    const std::string drawn = folder / (std::string(background) + ".png");
    ASSERT_TRUE(good(render({"--view", "front", "--mono", "--background", background, "-o", drawn})));
    EXPECT_TRUE(good(run_program({"compare", drawn, photo, "--background", background, "--min-psnr", "45"})));
  }
  // Planted fault: before another background.
  EXPECT_EQ(run_program({"compare", folder / "1,1,1.png", photo, "--min-psnr", "45"}).code, 1);
  const Outcome compared = run_program({"compare", folder / "exact.png", photo, "--json", folder / "c.json"});
  EXPECT_NE(compared.err.find("before the background 0,0,0"), std::string::npos) << compared.err;
  EXPECT_EQ(nlohmann::json::parse(test::read_text(folder / "c.json"))["background"],
            nlohmann::json({0, 0, 0}));
}

TEST_F(Photos, MayBeGreyOrOpenExr) {
  Image grey(exact.width, exact.height, 1);
  for (std::size_t i = 0; i < grey.data.size(); ++i) grey.data[i] = exact.data[3 * i];
  save_png(photo, grey);
  Image a = exact, b = grey;
  measure::make_shown(a, b);
  EXPECT_NEAR(psnr(), measure::psnr(a, b), 1e-3);
  std::filesystem::remove(photo);
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "--exr", "float", "-o", folder / "exr"})));
  std::filesystem::copy(folder / "exr/front.exr", photos + "/front.exr");
  EXPECT_GT(psnr(), 57.0);  // but for the rounding of the picture
}

TEST_F(Photos, WhatCannotBeReadIsFoundBeforeTheModel) {
  save_png(photo, exact);
  const std::string whole = test::read_text(photo);
  test::write_text(folder / "broken.ply", "no model");
  const auto refused = [&](const std::string& bytes, const std::string& said) {
    test::write_text(photo, bytes);
    std::filesystem::copy(folder / "cameras.json", folder / "cameras2.json",
                          std::filesystem::copy_options::overwrite_existing);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"render", "--view", "front", "--mono", "-o", out},
          {"calibrate", "--max-drop", "1", "-o", folder / "c.json"},
          {"trim", "--max-drop", "1", "-o", folder / "t.ply"},
          {"refit", "-o", folder / "f.ply"}}) {
      std::vector<std::string> arguments = {command[0], folder / "broken.ply", "--photos",
                                            photos,     "--cameras",           folder / "cameras2.json"};
      arguments.insert(arguments.end(), command.begin() + 1, command.end());
      EXPECT_TRUE(ended(run_program(arguments), 2, said)) << command[0];
    }
  };
  refused("no picture", "front.png is not a picture that can be read");
  refused(whole.substr(0, whole.size() / 2), "front.png: broken PNG: the file is cut short");
  refused(png_bytes(Image(5, 5, 4)), "front.png has 5 x 5 px");
  // Planted fault: one that can be read, so that the model is what is wrong.
  refused(whole, "broken.ply");
  test::write_text(photo, whole);
  std::filesystem::rename(photo, photos + "/other.png");
  EXPECT_TRUE(ended(run_program({"render", folder / "broken.ply", "--photos", photos, "--cameras",
                                 folder / "cameras2.json", "--mono", "--view", "front", "-o", out}),
                    2, "there is no photo of any view drawn, for one front.jpg"));
}

TEST_F(Photos, CalibrationTakesThemToo) {
  const auto entries = [&] {
    const Outcome outcome =
        run_program({"calibrate", model, "--photos", photos, "--max-drop", "0.5", "-o", folder / "c.json"});
    EXPECT_TRUE(good(outcome));
    nlohmann::json found = nlohmann::json::parse(test::read_text(folder / "c.json"))["entries"];
    for (nlohmann::json& entry : found) entry.erase("seconds");
    return found;
  };
  save_png(photo, exact);
  const nlohmann::json expected = entries();
  save_png(photo, rgba(1.0f));
  EXPECT_EQ(entries(), expected);
}

}  // namespace
}  // namespace binosplat
