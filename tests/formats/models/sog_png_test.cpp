// SOG whose pictures are PNG: any kind that keeps 8 bits a channel.

#include <gtest/gtest.h>

#include "formats/models/sog.h"
#include "formats/pictures/image_file.h"
#include "formats/pictures/webp.h"
#include "support/fixtures.h"
#include "support/jpeg.h"
#include "support/load.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::Copy;

/// Returns a WebP picture's pixels, the first `channels` of RGBA.
Image pixels_of(const std::string& webp, int channels) {
  const auto bytes = std::as_bytes(std::span(webp));
  const TableSize size = sog_texture_size("a.webp", bytes);
  const std::vector<std::uint8_t> texels = sog_texels("a.webp", bytes);
  Image image(static_cast<int>(size.x), static_cast<int>(size.y), channels);
  const auto n = static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<float>(texels[i / n * 4 + i % n]) / 255.0f;
  return image;
}

/// Replaces all WebP pictures of a folder by PNG pictures of the same name, as `write` makes them.
template <typename Write>
void replace_pictures(const fs::path& folder, const Write& write) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".webp")
      test::write_text(entry.path(), write(pixels_of(test::read_text(entry.path()), 4)));
  }
}

std::string as_png(const Image& image) { return png_bytes(image); }

std::string in_names(std::string text) {
  for (std::size_t at; (at = text.find(".webp")) != std::string::npos;) text.replace(at, 5, ".png");
  return text;
}

TEST(SogPng, EqualsWebp) {
  REQUIRE_FIXTURES(folder);
  for (const char* name : {"playbot-lod6", "logo-v1-cut", "st-lod", "st-lod/1_0"}) {
    const Copy copy(folder / "sog" / name);
    const Model reference = load_model(copy.path());
    replace_pictures(copy.path(), as_png);  // still named .webp: the content decides
    EXPECT_TRUE(test::equal(load_model(copy.path()), reference)) << name;
    replace_pictures(copy.path(), [](const Image&) { return std::string(); });  // injected: pictures are read
    EXPECT_ERROR(load_model(copy.path()), "expected a WebP or PNG picture");
  }
}

TEST(SogPng, IsReadFromArchive) {
  REQUIRE_FIXTURES(folder);
  const fs::path sog = folder / "sog/playbot-lod6";
  test::ZipEntries files;
  for (const auto& entry : fs::directory_iterator(sog)) {
    const std::string bytes = test::read_text(entry.path()), name = entry.path().filename().string();
    files.emplace_back(in_names(name),
                       name.ends_with("json") ? in_names(bytes) : as_png(pixels_of(bytes, 4)));
  }
  for (const bool deflated : {false, true})
    EXPECT_TRUE(test::equal(test::load_model_of(test::zipped(files, deflated), "m.sog"), load_model(sog)));
}

// Programs that make PNG files smaller leave the channels out that say nothing.
TEST(SogPng, AcceptsMissingChannels) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/playbot-lod6");
  for (const char* name : {"means_l.webp", "means_u.webp", "scales.webp", "shN_labels.webp"})
    copy.write(as_png(pixels_of(copy.read(name), 3)), name);
  EXPECT_TRUE(test::equal(load_model(copy.path()), load_model(folder / "sog/playbot-lod6")));
  std::vector<std::uint8_t> greys;
  for (int i = 0; i < 44 * 44; ++i) {
    const auto grey = static_cast<std::uint8_t>(i % 251);
    greys.insert(greys.end(), {grey, grey, grey, 255});
  }
  copy.write(test::webp(44, 44, greys), "scales.webp");
  const Model reference = load_model(copy.path());
  const Image grey = pixels_of(copy.read("scales.webp"), 1);
  copy.write(as_png(grey), "scales.webp");
  EXPECT_TRUE(test::equal(load_model(copy.path()), reference));
  // A palette of the 251 greys; PNG stores numbers, lengths and checksums from the highest byte on.
  const auto chunk = [](const std::string& type, const std::string& data) {
    const auto number = [](std::size_t n) {
      std::string bytes;
      for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift);
      return bytes;
    };
    const std::string summed = type + data;
    return number(data.size()) + summed +
           number(crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())));
  };
  std::string palette, rows;
  for (int i = 0; i < 251; ++i) palette += std::string(3, static_cast<char>(i));
  for (int i = 0; i < 44 * 44; ++i) {
    if (i % 44 == 0) rows += '\0';  // a row without a filter
    rows += static_cast<char>(i % 251);
  }
  std::vector<Bytef> packed(compressBound(rows.size()));
  uLongf size = packed.size();
  compress(packed.data(), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  const std::string header("\0\0\0\x2c\0\0\0\x2c\x08\x03\0\0\0", 13);
  copy.write(
      "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("PLTE", palette) +
          chunk("IDAT", std::string(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size))) +
          chunk("IEND", ""),
      "scales.webp");
  EXPECT_TRUE(test::equal(load_model(copy.path()), reference));
}

TEST(SogPng, RejectsInvalidPictures) {
  REQUIRE_FIXTURES(folder);
  const fs::path sog = folder / "sog/playbot-lod6";
  const Image quats = pixels_of(test::read_text(sog / "quats.webp"), 4);
  const std::string good = as_png(quats);
  const std::vector<unsigned char> pixels(std::size_t{3} * 44 * 44, 77);
  const std::vector<test::BrokenFile> refusals = {
      {png_bytes(quats, {.bits = 16}), {"meta.json: quats.webp", "16 bits", "expected 8"}},
      {good.substr(0, good.size() / 2), {"meta.json: quats.webp", "broken PNG", "cut short"}},
      {as_png(Image(4, 4, 4)), {"meta.json: quats.webp", "4 x 4 texels do not fit 1873 Gaussians"}},
      {test::encode_jpeg(pixels, 44, 44, TJPF_RGB, TJSAMP_444, 90),
       {"meta.json: quats.webp", "expected a WebP or PNG picture, but it looks like a JPEG picture"}}};
  const Copy copy(sog);
  test::expect_refusals("quats.webp", refusals, [&](const std::string& bytes) {
    copy.write(bytes, "quats.webp");
    load_model(copy.path());
  });
}

}  // namespace
}  // namespace binosplat
