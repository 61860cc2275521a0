// render --vr180: the metadata of its files, and the orientation of heads.

#include <cmath>

#include "app/scene.h"

namespace binosplat {
namespace {

struct Vr180 : SceneTest {
  const Words panorama = {"--vr180", "--size", "32x32"};

  // Writes a head that looks 37 degrees down, and two more to its side.
  Vr180() {
    json cameras;
    for (int k = 0; k < 3; ++k) {
      cameras.push_back(camera_json("v" + std::to_string(k), 0.2 * k));
      cameras.back()["rotation"] = {{1, 0, 0}, {0, 0.8, 0.6}, {0, -0.6, 0.8}};
    }
    save("cameras.json", cameras);
  }
};

TEST_F(Vr180, FileNameTellsLayout) {
  const auto size = [&](const Words& words, const std::string& name) {
    EXPECT_TRUE(good(render(joined(panorama, words))));
    const Image image = load_image(out + name);
    return glm::ivec2(image.width, image.height);
  };
  EXPECT_EQ(size({}, "/v0_180_LR.png"), glm::ivec2(64, 32));
  EXPECT_EQ(size({"--layout", "over-under"}, "/v0_180_TB.png"), glm::ivec2(32, 64));
  EXPECT_EQ(size({"--mono"}, "/v0_180.png"), glm::ivec2(32, 32));
}

TEST_F(Vr180, KeepsHeadLevel) {
  const auto run = reported(joined(panorama, {"--eye", "0,-1,0", "--at", "0,2,4", "--up", "0,-1,0"}));
  for (const auto& eye : run["views"][0]["eyes"]) {
    const auto forward = eye["axes"]["z_forward"].get<std::vector<double>>();
    EXPECT_NEAR(forward.at(1), 0.0, 1e-12);
    EXPECT_NEAR(forward.at(2), 1.0, 1e-12) << "looks another way";
    EXPECT_NEAR(eye["axes"]["y_down"][1].get<double>(), 1.0, 1e-12);
  }
}

// Up is that of the cameras of the named file, also if others lie beside the model.
TEST_F(Vr180, NamedCamerasSetUpDirection) {
  const auto down = [&](const Words& words) {
    const auto eye = reported(joined(panorama, joined(words, {"--mono"}))).at("views").at(0).at("eyes").at(0);
    return eye.at("axes").at("y_down").at(1).get<double>();
  };
  const std::string level = save("level.json", json::array({camera_json("level", 0.0)}));
  json two = {camera_json("a", 0.0), camera_json("b", 0.2)};
  two[1]["rotation"] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  EXPECT_NEAR(down({"--cameras", level}), 1.0, 1e-9);
  EXPECT_NEAR(
      down({"--cameras", save("named.json", {camera_json("a", 0.0), camera_json("b", 0.2)}), "--view", "b"}),
      1.0, 1e-9);
  const double beside = down({});
  EXPECT_LT(beside, 0.9) << "injected: the cameras beside the model are tilted";
  EXPECT_NEAR(down({"--path", level, "--keys"}), beside, 1e-9) << "keys may all be tilted alike";
  EXPECT_NEAR(down({"--cameras", save("two.json", two)}), beside, 1e-9) << "two that have no common up";
  json pose = camera_json("saved", 0.5);
  pose.update({{"up", {0.6, -0.8, 0}}, {"units_per_metre", 1.0}, {"ipd_metres", 0.06}, {"near", 0.1}});
  save("model.binosplat.json", json::array({pose}));
  EXPECT_NEAR(down({}), 0.8, 1e-9);
  EXPECT_NEAR(down({"--cameras", level}), 1.0, 1e-9) << "as the pose saved beside the model";
}

TEST_F(Vr180, AlignsEyePairs) {
  json cameras;
  for (const char* side : {"left", "right"}) {  // rotated outwards, and rolled
    json camera = camera_json(std::string("pair_") + side, side[0] == 'l' ? -0.1 : 0.1);
    const double s = side[0] == 'l' ? -0.1 : 0.1, c = std::sqrt(1 - s * s);
    camera["rotation"] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
    camera["position"][1] = side[0] == 'l' ? -0.05 : 0.05;
    cameras.push_back(camera);
  }
  const auto run = reported(joined(panorama, {"--cameras", save("pair.json", cameras), "--up", "0,-1,0"}));
  const auto eyes = run.at("views").at(0).at("eyes");
  EXPECT_EQ(eyes.at(0).at("axes"), eyes.at(1).at("axes"));
  EXPECT_NEAR(eyes.at(0).at("position").at(1).get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(eyes.at(1).at("position").at(0).get<double>(), std::hypot(0.1, 0.05), 1e-9);
  EXPECT_EQ(run.at("settings").at("projection"), "tangent");
}

TEST_F(Vr180, WritesVideoMetadata) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const auto facts = [&](const std::string& file, const std::string& layout) {
    EXPECT_TRUE(good(render(joined(panorama, {"--view", "all", "-o", folder / file, "--layout", layout}))));
    return facts_of(folder / file);
  };
  const std::string aside = facts("aside.mp4", "parallel");
  for (const char* fact :
       {"nb_read_frames=3", "projection=tiled equirectangular", "type=side by side", "width=64"})
    EXPECT_TRUE(has(aside, fact)) << fact;
  EXPECT_TRUE(has(facts("above.mov", "over-under"), "type=top and bottom"));
}

// The parts of a VR photo: its XMP text, and its data in pieces of 64 KiB.
struct Photo {
  std::string said, held;
  std::size_t whole = 0, pieces = 0;

  explicit Photo(const std::string& file) {
    const std::string bytes = read_text(file);
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
      EXPECT_TRUE(has(said, content.substr(more.size(), 32))) << "names another whole";
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

TEST_F(Vr180, VrPhotoHoldsBothEyes) {
  const std::string file = folder / "both.vr.jpg", eyes = folder / "eyes";
  ASSERT_TRUE(good(render({"--vr180", "--size", "1536x1536", "-o", file})));
  ASSERT_TRUE(good(render({"--vr180", "--size", "1536x1536", "-o", eyes, "--layout", "separate"})));
  const Photo photo(file);
  for (const char* fact : {"ProjectionType=\"equirectangular\"", "CroppedAreaImageWidthPixels=\"1536\"",
                           "FullPanoWidthPixels=\"3072\"", "CroppedAreaLeftPixels=\"768\""})
    EXPECT_TRUE(has(photo.said, fact)) << fact;
  EXPECT_EQ(photo.held.size(), photo.whole);
  EXPECT_GE(photo.pieces, 2U) << "too small a picture to tell";
  const std::string mark = "GImage:Data=\"";
  const std::size_t begin = photo.held.find(mark) + mark.size(), end = photo.held.find('"', begin);
  write_text(folder / "right.base64", photo.held.substr(begin, end - begin));
  write_text(folder / "right.jpg", asked("base64 -d " + (folder / "right.base64").string()));
  const std::string left = eyes + "/v0_180_left.png", right = eyes + "/v0_180_right.png";
  EXPECT_GE(psnr_of_files(file, left), 38.0);
  EXPECT_GE(psnr_of_files(folder / "right.jpg", right), 38.0);
  EXPECT_LE(psnr_of_files(folder / "right.jpg", left), 36.0) << "swapped eyes go unnoticed";
}

}  // namespace
}  // namespace binosplat
