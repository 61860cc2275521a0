// Image sizes from file headers, and damage that is found without decoding the pixels.

#include <gtest/gtest.h>

#include "formats/pictures/exr.h"
#include "formats/pictures/image_file.h"
#include "support/errors.h"
#include "support/jpeg.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

Image noise_image(int width, int height, int channels) {
  Image image(width, height, channels);
  test::Uniform uniform(3);
  for (float& value : image.data) value = static_cast<float>(uniform(0, 1));
  return image;
}

std::string jpeg_of(int format, int subsampling, int flags = 0) {
  std::vector<unsigned char> pixels(std::size_t{40} * 30 * 4);
  test::Uniform uniform(5);
  for (unsigned char& v : pixels) v = static_cast<unsigned char>(uniform(0, 255));
  return test::encode_jpeg(pixels, 40, 30, format, subsampling, 90, flags);
}

struct PictureSize : testing::Test {
  glm::ivec2 size_of(const std::string& bytes) const {
    test::write_text(folder / "picture", bytes);
    return picture_size(folder / "picture");
  }
  /// Whether both picture_size(), which reads only the header, and load_image() refuse the file.
  bool refused(const std::string& bytes, const std::vector<std::string>& parts) const {
    return test::fails_saying([&] { size_of(bytes); }, parts) &&
           test::fails_saying([&] { load_image(folder / "picture"); }, parts);
  }
  std::string exr_of(const Background& background) const {
    Picture picture(40, 30);
    for (std::size_t k = 0; k < picture.colour.size(); ++k)
      picture.colour[k] = glm::vec4(0.001f * static_cast<float>(k % 500), 0.2f, 0.3f, 0.25f);
    save_exr(folder / "a.exr", picture, {.background = background, .notes = {}});
    return test::read_text(folder / "a.exr");
  }
  const test::TempFolder folder;
};

TEST_F(PictureSize, ComesFromHeader) {
  for (const int channels : {1, 3, 4}) {
    for (const int bits : {8, 16})
      EXPECT_EQ(size_of(png_bytes(noise_image(40, 30, channels), {.bits = bits})), glm::ivec2(40, 30));
  }
  EXPECT_EQ(size_of(jpeg_of(TJPF_RGB, TJSAMP_420)), glm::ivec2(40, 30));
  EXPECT_EQ(size_of(jpeg_of(TJPF_RGB, TJSAMP_444, TJFLAG_PROGRESSIVE)), glm::ivec2(40, 30));
  EXPECT_EQ(size_of(jpeg_of(TJPF_GRAY, TJSAMP_GRAY)), glm::ivec2(40, 30));
  EXPECT_EQ(size_of(exr_of({})), glm::ivec2(40, 30));
  EXPECT_EQ(size_of(exr_of(glm::vec3(1.0f))), glm::ivec2(40, 30));
}

TEST_F(PictureSize, DetectsTruncation) {
  const std::string files[] = {png_bytes(noise_image(40, 30, 3)), jpeg_of(TJPF_RGB, TJSAMP_420),
                               jpeg_of(TJPF_RGB, TJSAMP_444, TJFLAG_PROGRESSIVE), exr_of({})};
  for (const std::string& good : files) {
    for (std::size_t left = 4; left + 2 < good.size(); left += left < 200 ? 3 : 211) {
      const std::string cut = good.substr(0, left);
      EXPECT_ERROR(size_of(cut), "picture") << left << " of " << good.size();
      // libjpeg may decode a progressive file that ends between scans, with a warning.
      if (&good == &files[2]) continue;
      EXPECT_TRUE(refused(cut, {"picture"})) << left << " of " << good.size();
    }
    EXPECT_TRUE(refused(good.substr(0, good.size() - 2), {"picture"}));
  }
  // The end of an embedded thumbnail, as cameras write one before the pixels, is not the end of a truncated
  // file.
  const std::string jpeg = jpeg_of(TJPF_RGB, TJSAMP_420), small = jpeg_of(TJPF_GRAY, TJSAMP_GRAY);
  const std::size_t length = small.size() + 2;
  const std::string note =
      std::string("\xff\xe1") + static_cast<char>(length >> 8) + static_cast<char>(length) + small;
  const std::string both = jpeg.substr(0, 2) + note + jpeg.substr(2);
  EXPECT_EQ(size_of(both), glm::ivec2(40, 30));
  EXPECT_EQ(size_of(both + "what some cameras write behind it"), glm::ivec2(40, 30));
  EXPECT_ERROR(size_of(both.substr(0, both.size() - 100)), "cut short");
}

TEST_F(PictureSize, RejectsNonPictures) {
  EXPECT_TRUE(refused("no picture at all\n", {"picture", "expected PNG, JPEG or OpenEXR", "a text file"}));
  EXPECT_TRUE(refused("ply\nformat ascii 1.0\n", {"a ply file"}));
  EXPECT_TRUE(refused("", {"an empty file"}));
  EXPECT_TRUE(refused("version https://git-lfs.github.com/spec/v1", {"git lfs pull"}));
  EXPECT_TRUE(refused(jpeg_of(TJPF_CMYK, TJSAMP_444), {"a CMYK JPEG; convert it to RGB"}));
  EXPECT_TRUE(refused("\x89PNG\r\n\x1a\n", {"broken PNG"}));
  EXPECT_TRUE(refused("\xff\xd8\xff\xe0", {"broken JPEG"}));
  EXPECT_TRUE(refused("\x76\x2f\x31\x01", {"broken OpenEXR"}));
  EXPECT_ERROR(picture_size(folder / "missing.png"), "missing.png");
  EXPECT_ERROR(load_image("/nowhere/a.png"), "/nowhere/a.png", "No such file");
}

}  // namespace
}  // namespace binosplat
