// PNG and JPEG: round trips of written files, files of every kind, and broken ones.

#include "formats/pictures/image_file.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "support/broken.h"
#include "support/errors.h"
#include "support/full_disk.h"
#include "support/jpeg.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

Image noise_beyond(int width, int height, int channels, std::uint32_t seed = 1) {
  Image image(width, height, channels);
  test::Uniform uniform(seed);
  for (float& value : image.data) value = static_cast<float>(uniform(-0.1, 1.1));
  return image;
}

bool equal_images(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels && a.data == b.data;
}

/// A file of any PNG colour type. The samples are given as rows pack them.
struct PngFile {
  int width = 0, height = 0, bits = 8, colour = PNG_COLOR_TYPE_RGB;
  int interlace = PNG_INTERLACE_NONE;
  std::vector<png_color> palette;
  std::vector<png_byte> palette_alpha;
  std::optional<png_color_16> transparent;
  std::vector<std::vector<png_byte>> rows;
};

void write_png(const fs::path& path, PngFile file) {
  std::FILE* out = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, static_cast<png_uint_32>(file.width), static_cast<png_uint_32>(file.height),
               file.bits, file.colour, file.interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!file.palette.empty())
    png_set_PLTE(png, info, file.palette.data(), static_cast<int>(file.palette.size()));
  png_color_16* transparent = file.transparent ? &*file.transparent : nullptr;
  if (!file.palette_alpha.empty() || transparent != nullptr) {
    png_set_tRNS(png, info, file.palette_alpha.data(), static_cast<int>(file.palette_alpha.size()),
                 transparent);
  }
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  for (auto& row : file.rows) rows.push_back(row.data());
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

Image load_png_file(const PngFile& file) {
  const test::TempFolder folder;
  write_png(folder / "image.png", file);
  return load_image(folder / "image.png");
}

Image image_of(int width, int height, int channels, const std::vector<double>& values) {
  Image image(width, height, channels);
  EXPECT_EQ(values.size(), image.data.size());
  std::copy(values.begin(), values.end(), image.data.begin());
  return image;
}

TEST(Png, RoundTripIsExact) {
  const test::TempFolder folder;
  for (const int bits : {8, 16}) {
    for (const int channels : {1, 3, 4}) {
      for (const auto& [width, height] :
           {std::pair(1, 1), std::pair(7, 5), std::pair(1, 40), std::pair(300, 200)}) {
        const Image image = noise_beyond(width, height, channels);
        save_png(folder / "image.png", image, {.bits = bits});
        const Image loaded = load_image(folder / "image.png");
        Image kept = quantised(image, bits == 8 ? 255 : 65535);
        EXPECT_TRUE(equal_images(loaded, kept)) << bits << " bits, " << channels << " channels";
        // Injected fault: one value of the last pixel is off by one 16-bit level.
        kept.data.back() += kept.data.back() > 0.5f ? -1.0f / 65535 : 1.0f / 65535;
        EXPECT_FALSE(equal_images(loaded, kept));
      }
    }
  }
}

TEST(Png, RoundsAndClamps) {
  const test::TempFolder folder;
  Image image(6, 1, 1);
  image.data = {-5.0f,
                7.0f,
                127.49f / 255,
                127.51f / 255,
                std::numeric_limits<float>::quiet_NaN(),
                std::numeric_limits<float>::infinity()};
  save_png(folder / "image.png", image, {.bits = 8});
  EXPECT_TRUE(equal_images(load_image(folder / "image.png"),
                           image_of(6, 1, 1, {0, 1, 127.0f / 255, 128.0f / 255, 0, 1})));
}

TEST(Png, CompressionIsLossless) {
  for (const int channels : {1, 3, 4}) {
    Image image = noise_beyond(61, 40, channels);
    // The upper half compresses, the noise below does not.
    for (std::size_t k = 0; k < image.data.size() / 2; ++k)
      image.data[k] = static_cast<float>(k % 61) / 61.0f;
    std::set<std::size_t> sizes;
    for (const int level : {0, 1, 12}) {
      const test::TempFolder folder;
      save_png(folder / "image.png", image, {.level = level});
      EXPECT_EQ(load_image(folder / "image.png").data, quantised(image).data) << channels << " at " << level;
      sizes.insert(std::filesystem::file_size(folder / "image.png"));
    }
    EXPECT_GT(sizes.size(), 1);
  }
  // A row that equals the one above it, and a row that does not, get different PNG filters.
  Image rows(64, 3, 1);
  for (int x = 0; x < 64; ++x) rows.at(x, 0, 0) = rows.at(x, 1, 0) = static_cast<float>(x * x % 97) / 97.0f;
  const test::TempFolder folder;
  save_png(folder / "rows.png", rows);
  EXPECT_EQ(load_image(folder / "rows.png").data, quantised(rows).data);
}

TEST(Png, WritesNotesAndSrgb) {
  const test::TempFolder folder;
  save_png(folder / "image.png", noise_beyond(2, 2, 3),
           {.notes = {{"units-per-metre", "1.5"}, {"view", "caf\xc3\xa9"}}});
  const std::string bytes = test::read_text(folder / "image.png");
  EXPECT_NE(bytes.find("sRGB"), std::string::npos);
  EXPECT_NE(bytes.find("units-per-metre"), std::string::npos);
  EXPECT_NE(bytes.find("caf\xc3\xa9"), std::string::npos);
}

TEST(Png, ScalesSmallGreyDepths) {
  PngFile file{.width = 4, .height = 1, .bits = 2, .colour = PNG_COLOR_TYPE_GRAY};
  file.rows = {{0b00011011}};
  EXPECT_TRUE(equal_images(load_png_file(file), image_of(4, 1, 1, {0, 85.0f / 255, 170.0f / 255, 1})));
}

TEST(Png, ExpandsPalettes) {
  PngFile file{.width = 3, .height = 1, .bits = 8, .colour = PNG_COLOR_TYPE_PALETTE};
  file.palette = {{255, 0, 51}, {0, 102, 255}};
  file.rows = {{1, 0, 1}};
  EXPECT_TRUE(equal_images(load_png_file(file), image_of(3, 1, 3, {0, 0.4f, 1, 1, 0, 0.2f, 0, 0.4f, 1})));
  file.palette_alpha = {51};
  EXPECT_TRUE(
      equal_images(load_png_file(file), image_of(3, 1, 4, {0, 0.4f, 1, 1, 1, 0, 0.2f, 0.2f, 0, 0.4f, 1, 1})));
}

TEST(Png, GreyAlphaBecomesRgba) {
  PngFile file{.width = 2, .height = 1, .bits = 8, .colour = PNG_COLOR_TYPE_GRAY_ALPHA};
  file.rows = {{51, 102, 255, 0}};
  EXPECT_TRUE(equal_images(load_png_file(file), image_of(2, 1, 4, {0.2f, 0.2f, 0.2f, 0.4f, 1, 1, 1, 0})));
  PngFile keyed{.width = 2, .height = 1, .bits = 8, .colour = PNG_COLOR_TYPE_GRAY};
  keyed.transparent = png_color_16{0, 0, 0, 0, 51};
  keyed.rows = {{51, 102}};
  EXPECT_TRUE(
      equal_images(load_png_file(keyed), image_of(2, 1, 4, {0.2f, 0.2f, 0.2f, 0, 0.4f, 0.4f, 0.4f, 1})));
}

TEST(Png, MayBeInterlaced) {
  PngFile file{.width = 9, .height = 9, .bits = 16, .colour = PNG_COLOR_TYPE_RGB};
  for (int y = 0; y < 9; ++y) {
    std::vector<png_byte>& row = file.rows.emplace_back();
    for (int i = 0; i < 9 * 6; ++i) row.push_back(static_cast<png_byte>(y * 54 + i));
  }
  const Image plain = load_png_file(file);
  file.interlace = PNG_INTERLACE_ADAM7;
  EXPECT_TRUE(equal_images(load_png_file(file), plain));
  EXPECT_FLOAT_EQ(plain.at(0, 1, 0), (54 * 256 + 55) / 65535.0f);  // The high byte is first.
}

std::string png_bytes() {
  const test::TempFolder folder;
  save_png(folder / "image.png", noise_beyond(40, 30, 3), {.bits = 8});
  return test::read_text(folder / "image.png");
}

testing::AssertionResult refuses_picture(const std::string& bytes, const std::vector<std::string>& said) {
  const test::TempFolder folder;
  test::write_text(folder / "picture", bytes);
  return test::fails_saying([&] { load_image(folder / "picture"); }, said);
}

TEST(Png, RejectsBrokenFiles) {
  const std::string good = png_bytes();
  EXPECT_TRUE(refuses_picture(good.substr(0, 1000), {"broken PNG: the file is cut short"}));
  EXPECT_TRUE(refuses_picture(test::patched(good, 1000, std::string(1, static_cast<char>(good[1000] ^ 1))),
                              {"broken PNG"}));
}

TEST(Png, ForgedSizesTakeNoMemory) {
  // The header says 2^31 - 1 px, then 30,000 px, on each side, with a correct checksum. The pixels are those
  // of 40 x 30.
  for (const std::uint32_t side : {0x7fffffffu, 30000u}) {
    std::string bytes = png_bytes();
    std::string number;
    test::append_bytes(number, side, true);
    bytes.replace(16, 8, number + number);
    std::string checksum;
    test::append_bytes(checksum,
                       static_cast<std::uint32_t>(crc32(0, reinterpret_cast<Bytef*>(&bytes[12]), 17)), true);
    bytes.replace(29, 4, checksum);
    EXPECT_TRUE(refuses_picture(bytes, {fmt::format("{} x {} px", side, side)}));
  }
}

TEST(Png, RejectsOtherBitDepths) {
  const test::TempFolder folder;
  EXPECT_ERROR(save_png(folder / "a.png", noise_beyond(1, 1, 3), {.bits = 12}), "8 or 16 bits, not 12");
  EXPECT_TRUE(folder.names().empty());
}

/// Returns a JPEG of smooth colours, which the compression changes little.
std::string jpeg_bytes(int format, int subsampling, Image& image) {
  image = Image(48, 32, format == TJPF_GRAY ? 1 : 3);
  std::vector<unsigned char> levels;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        levels.push_back(static_cast<unsigned char>(c == 0 ? 4 * x : c == 1 ? 6 * y : 3 * x + y));
        image.at(x, y, c) = static_cast<float>(levels.back()) / 255.0f;
      }
    }
  }
  return test::encode_jpeg(levels, 48, 32, format, subsampling, 98, TJFLAG_ACCURATEDCT);
}

double largest_in_images(const Image& a, const Image& b) {
  double worst = a.data.size() == b.data.size() && a.channels == b.channels ? 0 : 9;
  for (std::size_t i = 0; worst < 9 && i < a.data.size(); ++i) {
    worst = std::max(worst, std::abs(double{a.data[i]} - b.data[i]));
  }
  return worst;
}

TEST(Jpeg, ReadsColourAndGrey) {
  for (const auto& [format, subsampling] :
       {std::pair(TJPF_RGB, TJSAMP_444), std::pair(TJPF_GRAY, TJSAMP_GRAY)}) {
    Image image;
    const std::string bytes = jpeg_bytes(format, subsampling, image);
    const test::TempFolder folder;
    test::write_text(folder / "image.png", bytes);  // The content decides, not the extension.
    const Image loaded = load_image(folder / "image.png");
    EXPECT_LT(largest_in_images(loaded, image), 4.0 / 255);
    // Injected fault: all pixels are shifted by one and a half rows.
    std::rotate(image.data.begin(), image.data.end() - 72 * image.channels, image.data.end());
    EXPECT_GT(largest_in_images(loaded, image), 4.0 / 255);
  }
}

TEST(Jpeg, RejectsBrokenFiles) {
  Image image;
  const std::string good = jpeg_bytes(TJPF_RGB, TJSAMP_420, image);
  // The header says 65,500 x 65,500 px.
  std::string forged = good;
  const std::size_t frame = forged.find("\xff\xc0");
  for (const std::size_t at : {frame + 5, frame + 7}) forged.replace(at, 2, "\xff\xdc");
  EXPECT_TRUE(refuses_picture(forged, {"65500 x 65500 px"}));
}

}  // namespace
}  // namespace binosplat
