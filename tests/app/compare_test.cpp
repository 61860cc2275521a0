// binosplat compare: its numbers against a calculation by hand, its exit codes, what it refuses.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/image.h"
#include "formats/exr.h"
#include "formats/image_file.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::Outcome;
using test::run_program;
using test::TempFolder;
using testing::Test;

Image gradient(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t k = 0; k < image.data.size(); ++k) image.data[k] = static_cast<float>(k % 251) / 255.0f;
  return image;
}

struct Compare : Test {
  TempFolder folder;

  std::string png(const std::string& name, const Image& image) {
    save_png(folder / name, image);
    return folder / name;
  }
  nlohmann::json read_json(const std::string& name) {
    return nlohmann::json::parse(test::read_text(folder / name));
  }
};

TEST_F(Compare, EqualPicturesAreInfinitelyAlike) {
  const std::string a = png("a.png", gradient(20, 16, 3));
  const Outcome outcome = run_program({"compare", a, a, "--min-psnr", "200", "--json", folder / "c.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("infinite"), std::string::npos) << outcome.out;
  const auto json = read_json("c.json");
  EXPECT_TRUE(json["equal"].get<bool>());
  EXPECT_TRUE(json["psnr_db"].is_null());
  EXPECT_EQ(json["ssim"].get<double>(), 1.0);
  EXPECT_EQ(json["flip"].get<double>(), 0.0);
}

TEST_F(Compare, OneWrongPixelIsMeasuredAndFound) {
  Image image = gradient(20, 16, 3);
  const std::string a = png("a.png", image);
  image.at(7, 5, 1) += 32.0f / 255.0f;
  const std::string b = png("b.png", image);
  const double psnr = -10.0 * std::log10(std::pow(32.0 / 255.0, 2) / (20 * 16 * 3));

  const Outcome outcome =
      run_program({"compare", a, b, "--json", folder / "c.json", "--difference", folder / "d.png"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("x 7, y 5, green"), std::string::npos) << outcome.out;
  const auto json = read_json("c.json");
  EXPECT_FALSE(json["equal"].get<bool>());
  EXPECT_NEAR(json["psnr_db"].get<double>(), psnr, 1e-4);
  EXPECT_NEAR(json["largest_error"]["value"].get<double>(), 32.0 / 255.0, 1e-6);
  EXPECT_EQ(json["largest_error"]["x"], 7);
  EXPECT_EQ(json["largest_error"]["y"], 5);

  // The difference picture is black but for that pixel.
  const Image difference = load_image(folder / "d.png");
  EXPECT_GT(difference.at(7, 5, 1), 0.5f);
  EXPECT_EQ(difference.at(7, 5, 0), 0.0f);
  EXPECT_EQ(difference.at(6, 5, 1), 0.0f);

  // The bar lies just below or just above what was measured.
  EXPECT_EQ(run_program({"compare", a, b, "--min-psnr", std::to_string(psnr - 0.01)}).code, 0);
  const Outcome below = run_program({"compare", a, b, "--min-psnr", std::to_string(psnr + 0.01)});
  EXPECT_EQ(below.code, 1);
  EXPECT_NE(below.err.find("fall short of --min-psnr"), std::string::npos) << below.err;
}

// Black and white by hand (flip_test.cpp), and the viewer's distance, which matters where there is detail.
TEST_F(Compare, FlipAndItsViewer) {
  const std::string black = png("black.png", Image(24, 24, 3));
  Image image(24, 24, 3);
  for (float& v : image.data) v = 1.0f;
  const std::string white = png("white.png", image);
  const Outcome outcome = run_program({"compare", black, white, "--json", folder / "c.json"});
  EXPECT_NE(outcome.out.find("FLIP           0.967379 at 67 pixels"), std::string::npos) << outcome.out;
  EXPECT_NEAR(read_json("c.json")["flip"].get<double>(), 0.967379, 2e-6);

  const std::string detail = png("detail.png", gradient(24, 24, 3));
  const auto flip_at = [&](const char* ppd) {
    EXPECT_EQ(run_program({"compare", detail, black, "--ppd", ppd, "--json", folder / "p.json"}).code, 0);
    EXPECT_EQ(read_json("p.json")["pixels_per_degree"], std::stod(ppd));
    return read_json("p.json")["flip"].get<double>();
  };
  EXPECT_NE(flip_at("67"), flip_at("30"));
}

// One picture as PNG of 8 bits and as OpenEXR in both encodings: apart by rounding only.
TEST_F(Compare, PngAndExrOfOnePictureAreEqualToRounding) {
  Picture picture(24, 16);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const float v = static_cast<float>(k) / static_cast<float>(picture.colour.size());
    picture.colour[k] = {v, 0.5f * v, 0.25f + 0.5f * v, 0.0f};
    picture.z_sum[k] = 2.0f;
  }
  const Background black = glm::vec3(0.0f);
  const std::string a = png("a.png", composite(picture, black));
  for (const bool display : {false, true}) {
    const std::string b = folder / (display ? "display.exr" : "linear.exr");
    save_exr(b, picture, {false, display, black, {}});
    const Outcome outcome = run_program({"compare", a, b, "--json", folder / "c.json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto json = read_json("c.json");
    EXPECT_LE(json["largest_error"]["value"].get<double>(), 0.501 / 255.0);
    // And it is no comparison of a picture with itself.
    EXPECT_GT(json["largest_error"]["value"].get<double>(), 0.3 / 255.0);
  }
}

TEST_F(Compare, GreyIsComparedWithColour) {
  Image grey(16, 16, 1), colour(16, 16, 3);
  for (float& v : grey.data) v = 0.4f;
  for (float& v : colour.data) v = 0.4f;
  EXPECT_EQ(run_program({"compare", png("g.png", grey), png("c.png", colour), "--min-psnr", "100"}).code, 0);
  colour.at(3, 3, 2) = 0.8f;
  EXPECT_EQ(run_program({"compare", png("g.png", grey), png("d.png", colour), "--min-psnr", "100"}).code, 1);
}

TEST_F(Compare, WhatCannotBeComparedIsCodeTwo) {
  const std::string a = png("a.png", gradient(20, 16, 3));
  const std::string wide = png("wide.png", gradient(21, 16, 3));
  const std::string alpha = png("alpha.png", gradient(20, 16, 4));
  test::write_text(folder / "text.png", "no picture at all\n");
  const std::string whole = test::read_text(a);
  test::write_text(folder / "cut.png", whole.substr(0, whole.size() / 2));
  const struct {
    std::vector<std::string> arguments;
    const char* said;
  } cases[] = {
      {{"compare", a, wide}, "21 x 16"},
      {{"compare", a, alpha, "--background", "1,2,3"}, "--background 1,2,3: expected numbers from 0 to 1"},
      {{"compare", a, folder / "missing.png"}, "missing.png"},
      {{"compare", folder / "text.png", a}, "text.png"},
      {{"compare", a, folder / "cut.png"}, "cut.png"},
      {{"compare", a, folder.path()}, folder.path().c_str()},
      {{"compare", a, a, "--difference", a + "/d.png"}, "is a file where a folder is needed"},
      {{"compare", a, a, "--json", folder.path()}, "it is a folder"},
      {{"compare", a}, "see: binosplat compare --help"},
      {{"compare", a, a, "--min-psnr", "loud"}, "see: binosplat compare --help"},
      {{"compare", a, a, "--ppd", "0"}, "see: binosplat compare --help"},
      {{"compare", a, a, "--max-memory", "0"}, "see: binosplat compare --help"},
  };
  const auto before = folder.files();
  for (const auto& c : cases) {
    const Outcome outcome = run_program(c.arguments);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(c.said), std::string::npos)
        << "expected '" << c.said << "' in: " << outcome.err;
  }
  EXPECT_EQ(folder.files(), before);
}

TEST_F(Compare, PicturesBeyondAllMemoryAreRefusedBeforeTheyAreRead) {
  // Rows of one colour take hardly any bytes. Neither is read to its end, where each is cut short.
  const std::string small = png("small.png", Image(1000, 1000, 1));
  const std::string text = test::read_text(small);
  test::write_text(small, text.substr(0, text.size() - 20));
  const Outcome outcome = run_program({"compare", small, small, "--max-memory", "100"});
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("small.png: 1000 x 1000 px take 170 MB of memory here, and 100 may be taken; "
                             "--max-memory allows more"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(run_program({"compare", small, small, "--max-memory", "171"}).err.find("broken PNG"),
            std::string::npos);
  for (const char* name : {"alpha_float.exr", "grey.jpg"}) {
    const std::filesystem::path file =
        std::filesystem::path(BINOSPLAT_SOURCE_DIR) / "tests/fuzz/corpus/image" / name;
    EXPECT_EQ(run_program({"compare", file, file, "--max-memory", "0.001"}).code, 4) << name;
    EXPECT_EQ(run_program({"compare", file, file, "--max-memory", "10"}).code, 0) << name;
  }
}

#if !defined(__SANITIZE_ADDRESS__)  // which needs more address space than any limit leaves
TEST_F(Compare, TooLittleMemoryIsCodeFour) {
  const std::string a = png("a.png", Image(4000, 4000, 3));
  test::Surroundings small;
  small.limits[RLIMIT_AS] = 300'000'000;
  const Outcome outcome = run_program({"compare", a, a}, small);
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("out of memory"), std::string::npos) << outcome.err;
}
#endif

TEST_F(Compare, UsageHelpAndVersion) {
  EXPECT_EQ(run_program({"--help"}).code, 0);
  EXPECT_EQ(run_program({"--version"}).out, "binosplat 0.1.0\n");
  const Outcome help = run_program({"compare", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--min-psnr"), std::string::npos);
  EXPECT_EQ(run_program({}).code, 2);
  EXPECT_EQ(run_program({"no-such-command"}).code, 2);
}

}  // namespace
}  // namespace binosplat
