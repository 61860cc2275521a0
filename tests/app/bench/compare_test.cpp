// binosplat compare: its numbers against calculations by hand, its exit codes, and its errors.

#include <cmath>

#include "app/scene.h"
#include "formats/pictures/exr.h"

namespace binosplat {
namespace {

Image gradient(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t k = 0; k < image.data.size(); ++k) image.data[k] = static_cast<float>(k % 251) / 255.0f;
  return image;
}

Image plain(int side, int channels, float value) {
  Image image(side, side, channels);
  for (float& v : image.data) v = value;
  return image;
}

struct Compare : SceneTest {
  std::string png(const std::string& name, const Image& image) {
    save_png(folder / name, image);
    return folder / name;
  }
  Outcome compare(const std::string& a, const std::string& b, const Words& more = {}) const {
    return run_program(joined({"compare", a, b, "--json", folder / "c.json"}, more));
  }
  json said() const { return load_json(folder / "c.json"); }
};

TEST_F(Compare, EqualPicturesHaveInfinitePsnr) {
  const std::string a = png("a.png", gradient(20, 16, 3));
  const Outcome outcome = checked(compare(a, a, {"--min-psnr", "200"}));
  EXPECT_TRUE(has(outcome.out, "infinite"));
  EXPECT_TRUE(said()["equal"].get<bool>());
  EXPECT_TRUE(said()["psnr_db"].is_null());
  EXPECT_EQ(said()["ssim"], 1.0);
  EXPECT_EQ(said()["flip"], 0.0);
}

TEST_F(Compare, LocatesWrongPixel) {
  Image image = gradient(20, 16, 3);
  const std::string a = png("a.png", image);
  image.at(7, 5, 1) += 32.0f / 255.0f;
  const std::string b = png("b.png", image);
  const double psnr = -10.0 * std::log10(std::pow(32.0 / 255.0, 2) / (20 * 16 * 3));

  const Outcome outcome = checked(compare(a, b, {"--difference", folder / "d.png"}));
  EXPECT_TRUE(has(outcome.out, "x 7, y 5, green"));
  EXPECT_FALSE(said()["equal"].get<bool>());
  EXPECT_NEAR(said()["psnr_db"].get<double>(), psnr, 1e-4);
  EXPECT_NEAR(said()["largest_error"]["value"].get<double>(), 32.0 / 255.0, 1e-6);
  EXPECT_EQ(said()["largest_error"]["x"], 7);
  EXPECT_EQ(said()["largest_error"]["y"], 5);

  // The difference picture is black except for that pixel.
  const Image difference = load_image(folder / "d.png");
  EXPECT_GT(difference.at(7, 5, 1), 0.5f);
  EXPECT_EQ(difference.at(7, 5, 0), 0.0f);
  EXPECT_EQ(difference.at(6, 5, 1), 0.0f);

  // The bound is just below or just above the measured value.
  EXPECT_TRUE(good(compare(a, b, {"--min-psnr", std::to_string(psnr - 0.01)})));
  EXPECT_TRUE(
      ended(compare(a, b, {"--min-psnr", std::to_string(psnr + 0.01)}), 1, "fall short of --min-psnr"));
}

// Black and white by hand (flip_test.cpp), and the viewer's distance, which matters in detailed pictures.
TEST_F(Compare, FlipDependsOnViewingDistance) {
  const std::string black = png("black.png", Image(24, 24, 3)), white = png("white.png", plain(24, 3, 1.0f));
  EXPECT_TRUE(has(compare(black, white).out, "FLIP           0.967379 at 67 pixels"));
  EXPECT_NEAR(said()["flip"].get<double>(), 0.967379, 2e-6);

  const std::string detail = png("detail.png", gradient(24, 24, 3));
  const auto flip_at = [&](const char* ppd) {
    EXPECT_TRUE(good(compare(detail, black, {"--ppd", ppd})));
    EXPECT_EQ(said()["pixels_per_degree"], std::stod(ppd));
    return said()["flip"].get<double>();
  };
  EXPECT_NE(flip_at("67"), flip_at("30"));
}

TEST_F(Compare, NanLeavesMetricsUndefined) {
  Picture picture(24, 16);
  const std::string plain_exr = folder / "plain.exr", broken = folder / "broken.exr";
  save_exr(plain_exr, picture, {false, true, glm::vec3(0.0f), {}});
  EXPECT_TRUE(has(compare(plain_exr, plain_exr).out, "infinite")) << "injected: without such a value";
  for (const float value : {NAN, INFINITY, -INFINITY}) {
    picture.colour[24 * 5 + 7].y = value;
    save_exr(broken, picture, {false, true, glm::vec3(0.0f), {}});
    for (const auto& [a, b] : {std::pair(broken, plain_exr), {plain_exr, broken}, {broken, broken}}) {
      const Outcome outcome = compare(a, b, {"--min-psnr", "10"});
      const std::string place = "undefined: " + broken + " holds a NaN or an infinity at x 7, y 5, green";
      EXPECT_EQ(outcome.code, 1);
      for (const char* name : {"PSNR           ", "SSIM           ", "FLIP           "})
        EXPECT_TRUE(has(outcome.out, name + place)) << outcome.out;
      EXPECT_TRUE(said()["psnr_db"].is_null() && said()["ssim"].is_null() && said()["flip"].is_null());
      EXPECT_FALSE(said()["equal"].get<bool>());
      EXPECT_TRUE(said()["largest_error"]["value"].is_null());
      EXPECT_EQ(said()["largest_error"]["x"], 7);
    }
  }
}

TEST_F(Compare, IncomparableInputExitsWithTwo) {
  const std::string a = png("a.png", gradient(20, 16, 3)), wide = png("wide.png", gradient(21, 16, 3));
  write_text(folder / "text.png", "no picture at all\n");
  const std::string whole = read_text(a);
  write_text(folder / "cut.png", whole.substr(0, whole.size() / 2));
  expect_refused_after({"compare"},
                       {{{a, wide}, "21 x 16"},
                        {{a, a, "--background", "1,2,3"}, "--background 1,2,3: expected numbers from 0 to 1"},
                        {{a, folder / "missing.png"}, "missing.png"},
                        {{folder / "text.png", a}, "text.png"},
                        {{a, folder / "cut.png"}, "cut.png"},
                        {{a, folder.path()}, folder.path()},
                        {{a, a, "--difference", a + "/d.png"}, "is a file where a folder is needed"},
                        {{a, a, "--json", folder.path()}, "it is a folder"},
                        {{a}, "see: binosplat compare --help"},
                        {{a, a, "--ppd", "0"}, "see: binosplat compare --help"}});
}

TEST_F(Compare, RejectsOversizedPicturesEarly) {
  // Rows of one colour take hardly any bytes. The files are cut short, but the error comes before they are
  // read to the end.
  const std::string small = png("small.png", Image(1000, 1000, 1)), text = read_text(small);
  write_text(small, text.substr(0, text.size() - 20));
  EXPECT_TRUE(ended(
      compare(small, small, {"--max-memory", "100"}), 4,
      "small.png: 1000 x 1000 px need 170 MB of memory, and 100 MB are allowed; --max-memory allows more"));
  EXPECT_TRUE(ended(compare(small, small, {"--max-memory", "171"}), 2, "broken PNG"));
  for (const char* name : {"alpha_float.exr", "grey.jpg"}) {
    const std::string file = std::string(BINOSPLAT_SOURCE_DIR) + "/tests/fuzz/corpus/image/" + name;
    EXPECT_EQ(compare(file, file, {"--max-memory", "0.001"}).code, 4) << name;
    EXPECT_EQ(compare(file, file, {"--max-memory", "10"}).code, 0) << name;
  }
}

#if !defined(__SANITIZE_ADDRESS__)  // needs more address space than the limit allows
TEST_F(Compare, OutOfMemoryExitsWithFour) {
  const std::string a = png("a.png", Image(4000, 4000, 3));
  EXPECT_TRUE(ended(run_program({"compare", a, a}, {.limits = {{RLIMIT_AS, 300'000'000}}}), 4,
                    "need 2720 MB of memory"));
}
#endif

TEST_F(Compare, PrintsHelpAndVersion) {
  EXPECT_TRUE(has(run_program({"--help"}).out, "3 no usable OpenGL, display or headset; 4 out of memory"));
  EXPECT_EQ(run_program({"--version"}).out, "binosplat 0.1.0\n");
  EXPECT_TRUE(has(run_program({"compare", "--help"}).out, "--min-psnr"));
  EXPECT_EQ(run_program({}).code, 2);
  EXPECT_EQ(run_program({"no-such-command"}).code, 2);
}

}  // namespace
}  // namespace binosplat
