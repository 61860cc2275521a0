// Writes PNG by libdeflate, which makes smaller files than zlib in half the time. A PNG is a signature, then
// chunks of LENGTH NAME DATA CHECKSUM; IDAT holds the filtered rows as one zlib stream.
#include <libdeflate.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/output_file.h"
#include "formats/containers/bytes.h"
#include "formats/pictures/image_file.h"

namespace binosplat {

namespace {

using Bytes = std::vector<std::uint8_t>;

void append_chunk(std::string& png, std::string_view name, std::string_view data) {
  png += big_endian(static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.append(name).append(data);
  png += big_endian(libdeflate_crc32(0, &png[begin], png.size() - begin));
}

/// Encodes the image's row `y` for PNG, big-endian. NaN becomes 0.
void encode_row(const Image& image, int y, int bits, std::uint8_t* row) {
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  const float* values = &image.data[static_cast<std::size_t>(y) * count];
  for (std::size_t i = 0; i < count; ++i) {
    if (bits == 8) {
      row[i] = static_cast<std::uint8_t>(step_of(values[i], 255.0f));
    } else {
      const auto step = static_cast<std::uint16_t>(step_of(values[i], 65535.0f));
      row[2 * i] = static_cast<std::uint8_t>(step >> 8);
      row[2 * i + 1] = static_cast<std::uint8_t>(step & 255);
    }
  }
}

/// PNG's filters store each byte's difference from a prediction: `left`, `above`, or the mean of both.
enum Filter : std::uint8_t { sub = 1, up = 2, average = 3 };

void filter(Filter type, const std::uint8_t* row, const std::uint8_t* left, const std::uint8_t* above,
            Bytes& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int guess = type == sub ? left[i] : type == up ? above[i] : (left[i] + above[i]) / 2;
    out[i] = static_cast<std::uint8_t>(row[i] - guess);
  }
}

/// Estimates the compressed size as PNG's specification proposes: the sum of absolute differences.
std::uint64_t left_to_pack(const Bytes& filtered) {
  std::uint64_t sum = 0;
  for (const std::uint8_t byte : filtered)
    sum += static_cast<std::uint64_t>(std::abs(static_cast<int>(static_cast<std::int8_t>(byte))));
  return sum;
}

/// Returns, for each row, the number of the filter with the smallest estimate, then the filtered row. Paeth,
/// the fourth filter, saves nothing on rendered pictures, and takes as long as the other three.
Bytes filtered_rows(const Image& image, int bits) {
  const std::size_t pixel = static_cast<std::size_t>(image.channels * bits / 8);
  const std::size_t size = pixel * static_cast<std::size_t>(image.width);
  // A pixel of zeros precedes each row, and a row of zeros precedes the first row.
  Bytes row(pixel + size), above(pixel + size), best(size), tried(size), all;
  all.reserve((1 + size) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    encode_row(image, y, bits, &row[pixel]);
    std::uint64_t least = UINT64_MAX;
    Filter chosen = sub;
    for (const Filter type : {sub, up, average}) {
      filter(type, &row[pixel], row.data(), &above[pixel], tried);
      const std::uint64_t left = left_to_pack(tried);
      if (left >= least) continue;
      least = left;
      chosen = type;
      std::swap(best, tried);
    }
    all.push_back(chosen);
    all.insert(all.end(), best.begin(), best.end());
    std::swap(row, above);
  }
  return all;
}

std::string packed(const Bytes& bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (compressor == nullptr) throw std::bad_alloc();
  std::string out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

}  // namespace

std::string png_bytes(const Image& image, const PngOptions& options) {
  const auto& [bits, level, notes] = options;
  if (bits != 8 && bits != 16) fail("a PNG has 8 or 16 bits, not {}", bits);
  constexpr int size_max = INT32_MAX / 8;  // maximum bytes of a row
  if (image.width < 1 || image.height < 1 || image.width > size_max / image.channels)
    fail("a PNG cannot have {} x {} px", image.width, image.height);
  const char colour_type = image.channels == 1 ? 0 : image.channels == 3 ? 2 : 6;
  std::string header = big_endian(static_cast<std::uint32_t>(image.width)) +
                       big_endian(static_cast<std::uint32_t>(image.height));
  // Deflate, adaptive filters, not interlaced.
  header += {static_cast<char>(bits), colour_type, 0, 0, 0};

  std::string png = "\x89PNG\r\n\x1a\n";
  append_chunk(png, "IHDR", header);
  append_chunk(png, "sRGB", std::string_view("\0", 1));  // rendering intent: perceptual
  // The five zeros: uncompressed text, without a language.
  for (const auto& [key, value] : notes) append_chunk(png, "iTXt", key + std::string(5, '\0') + value);
  std::string rows = packed(filtered_rows(image, bits), level);
  // A chunk's length has 31 bits. Readers join the data of several IDAT chunks.
  constexpr std::size_t piece = std::size_t{1} << 30;
  for (std::size_t at = 0; at < rows.size(); at += piece)
    append_chunk(png, "IDAT", std::string_view(rows).substr(at, piece));
  append_chunk(png, "IEND", {});
  return png;
}

void save_png(const std::filesystem::path& path, const Image& image, const PngOptions& options) {
  std::string bytes;
  try {
    bytes = png_bytes(image, options);
  } catch (const Error& error) {
    fail("{}: {}", path, error.what());
  }
  write_file(path, bytes);
}

}  // namespace binosplat
