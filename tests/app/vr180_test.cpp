// render --vr180: what files say of themselves, how heads are held, and what is refused.

#include <cmath>
#include <cstdlib>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::write_text;

struct Vr180 : test::SceneTest {
  // A head that looks 37 degrees down, and two more beside it.
  Vr180() {
    nlohmann::json cameras;
    for (int k = 0; k < 3; ++k) {
      cameras.push_back(test::camera_json("v" + std::to_string(k), 0.2 * k));
      cameras.back()["rotation"] = {{1, 0, 0}, {0, 0.8, 0.6}, {0, -0.6, 0.8}};
    }
    write_text(folder / "cameras.json", cameras.dump());
  }
};

TEST_F(Vr180, PutsBothEyesIntoAFileWhoseNameSaysSo) {
  ASSERT_TRUE(good(render({"--vr180", "--size", "32x32", "-o", out, "--json", folder / "run.json"})));
  const Image both = load_image(out + "/v0_180_LR.png");
  EXPECT_EQ(both.width, 64);
  EXPECT_EQ(both.height, 32);
  ASSERT_TRUE(good(render({"--vr180", "--size", "32x32", "-o", out, "--layout", "over-under"})));
  EXPECT_EQ(load_image(out + "/v0_180_TB.png").height, 64);
  ASSERT_TRUE(good(render({"--vr180", "--size", "32x32", "-o", out, "--mono"})));
  EXPECT_EQ(load_image(out + "/v0_180.png").width, 32);
}

TEST_F(Vr180, HoldsTheHeadLevel) {
  ASSERT_TRUE(good(render({"--eye", "0,-1,0", "--at", "0,2,4", "--up", "0,-1,0", "--vr180", "--size", "32x32",
                           "-o", out, "--json", folder / "run.json"})));
  const auto view = nlohmann::json::parse(test::read_text(folder / "run.json")).at("views").at(0);
  for (const auto& eye : view.at("eyes")) {
    const auto forward = eye.at("axes").at("z_forward").get<std::vector<double>>();
    const auto down = eye.at("axes").at("y_down").get<std::vector<double>>();
    EXPECT_NEAR(forward.at(1), 0.0, 1e-12);
    EXPECT_NEAR(forward.at(2), 1.0, 1e-12) << "looks another way";
    EXPECT_NEAR(down.at(1), 1.0, 1e-12);
  }
}

TEST_F(Vr180, HoldsPairsLevelAndTogether) {
  nlohmann::json cameras;
  for (const char* side : {"left", "right"}) {  // turned outwards, and rolled
    nlohmann::json camera = test::camera_json(std::string("pair_") + side, side[0] == 'l' ? -0.1 : 0.1);
    const double s = side[0] == 'l' ? -0.1 : 0.1, c = std::sqrt(1 - s * s);
    camera["rotation"] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
    camera["position"][1] = side[0] == 'l' ? -0.05 : 0.05;
    cameras.push_back(camera);
  }
  write_text(folder / "pair.json", cameras.dump());
  ASSERT_TRUE(good(render({"--cameras", folder / "pair.json", "--up", "0,-1,0", "--vr180", "--size", "32x32",
                           "-o", out, "--json", folder / "run.json"})));
  const auto run = nlohmann::json::parse(test::read_text(folder / "run.json"));
  const auto eyes = run.at("views").at(0).at("eyes");
  EXPECT_EQ(eyes.at(0).at("axes"), eyes.at(1).at("axes"));
  EXPECT_NEAR(eyes.at(0).at("position").at(1).get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(eyes.at(1).at("position").at(0).get<double>(), std::hypot(0.1, 0.05), 1e-9);
  EXPECT_EQ(run.at("settings").at("projection"), "tangent");
}

TEST_F(Vr180, TellsPlayersWhatAVideoIs) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const auto facts = [&](const std::string& file, const std::string& layout) {
    EXPECT_TRUE(good(
        render({"--vr180", "--size", "32x32", "--view", "all", "-o", folder / file, "--layout", layout})));
    return facts_of(folder / file);
  };
  const std::string aside = facts("aside.mp4", "parallel"), above = facts("above.mov", "over-under");
  for (const char* fact :
       {"nb_read_frames=3", "projection=tiled equirectangular", "type=side by side", "width=64"})
    EXPECT_NE(aside.find(fact), std::string::npos) << fact << " is not in " << aside;
  for (const char* fact : {"nb_read_frames=3", "projection=tiled equirectangular", "type=top and bottom"})
    EXPECT_NE(above.find(fact), std::string::npos) << fact << " is not in " << above;
}

// The parts of a VR photo: what XMP says of it, and what it holds in 64 KiB pieces.
struct Photo {
  std::string said, held;
  std::size_t whole = 0, pieces = 0;

  explicit Photo(const std::string& file) {
    const std::string bytes = test::read_text(file);
    const auto byte = [&](std::size_t at) {
      return static_cast<std::size_t>(static_cast<unsigned char>(bytes.at(at)));
    };
    const std::string plain("http://ns.adobe.com/xap/1.0/\0", 29),
        more("http://ns.adobe.com/xmp/extension/\0", 35);
    for (std::size_t at = 2; byte(at) == 0xff && byte(at + 1) != 0xda;
         at += 2 + 256 * byte(at + 2) + byte(at + 3)) {
      const std::string content = bytes.substr(at + 4, 256 * byte(at + 2) + byte(at + 3) - 2);
      if (content.rfind(plain, 0) == 0) said = content.substr(plain.size());
      if (content.rfind(more, 0) != 0) continue;
      EXPECT_NE(said.find(content.substr(more.size(), 32)), std::string::npos) << "names another whole";
      const auto number = [&](std::size_t from) {
        std::size_t value = 0;
        for (std::size_t k = 0; k < 4; ++k)
          value = 256 * value + static_cast<unsigned char>(content.at(from + k));
        return value;
      };
      whole = number(more.size() + 32);
      EXPECT_EQ(number(more.size() + 36), held.size()) << "a piece is not where it says";
      ++pieces;
      held += content.substr(more.size() + 40);
    }
  }
};

TEST_F(Vr180, WritesVrPhotosThatHoldBothEyes) {
  const std::string file = folder / "both.vr.jpg", eyes = folder / "eyes";
  ASSERT_TRUE(good(render({"--vr180", "--size", "1536x1536", "-o", file})));
  ASSERT_TRUE(good(render({"--vr180", "--size", "1536x1536", "-o", eyes, "--layout", "separate"})));
  const Photo photo(file);
  for (const char* fact : {"ProjectionType=\"equirectangular\"", "CroppedAreaImageWidthPixels=\"1536\"",
                           "FullPanoWidthPixels=\"3072\"", "CroppedAreaLeftPixels=\"768\""})
    EXPECT_NE(photo.said.find(fact), std::string::npos) << fact << " is not in " << photo.said;
  EXPECT_EQ(photo.held.size(), photo.whole);
  EXPECT_GE(photo.pieces, 2U) << "too small a picture to tell";
  const std::string mark = "GImage:Data=\"";
  const std::size_t begin = photo.held.find(mark) + mark.size(), end = photo.held.find('"', begin);
  write_text(folder / "right.base64", photo.held.substr(begin, end - begin));
  ASSERT_EQ(std::system(
                ("base64 -d " + (folder / "right.base64").string() + " > " + (folder / "right.jpg").string())
                    .c_str()),
            0);
  const Image left = load_image(file), right = load_image(folder / "right.jpg");
  const Image drawn_left = load_image(eyes + "/v0_180_left.png"),
              drawn_right = load_image(eyes + "/v0_180_right.png");
  EXPECT_GE(measure::psnr(left, drawn_left), 38.0);
  EXPECT_GE(measure::psnr(right, drawn_right), 38.0);
  EXPECT_LE(measure::psnr(right, drawn_left), 36.0) << "swapped eyes go unnoticed";
  EXPECT_TRUE(ended(render({"--vr180", "--mono", "-o", file}), 2, "holds both eyes"));
  EXPECT_TRUE(ended(render({"-o", file}), 2, "pictures are written as .png"));
}

TEST_F(Vr180, RefusesWhatHasNoMeaningForIt) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& text) {
    arguments.emplace_back("--vr180");
    return ended(render(arguments), 2, text);
  };
  EXPECT_TRUE(refused({"--quality", "40"}, "leave --quality out"));
  EXPECT_TRUE(refused({"--order", "depth"}, "leave --order out"));
  EXPECT_TRUE(refused({"--only", "left"}, "leave --only out"));
  EXPECT_TRUE(refused({"--size", "9000x9000"}, "at most 8192"));
  EXPECT_TRUE(refused({"-o", folder / "a.vr.jpg", "--exr", "half"}, "--exr"));
  EXPECT_TRUE(refused({"--size", "32x30"}, "an even number of pixels twice"));
  EXPECT_TRUE(refused({"--layout", "anaglyph"}, "parallel and over-under"));
  EXPECT_TRUE(refused({"-o", folder / "a.webm"}, "only .mp4 and .mov"));
  EXPECT_TRUE(refused({"--preset", "headset"}, "--preset"));
}

}  // namespace
}  // namespace binosplat
