// libpng reports errors by longjmp, which runs no destructors: what it may jump out of keeps its objects in a
// struct of the caller.
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/output_file.h"
#include "formats/image_file.h"
#include "formats/picture_readers.h"

namespace binosplat {

namespace {

struct PngReader {
  const std::filesystem::path& path;
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<png_byte> values;
  std::vector<png_bytep> rows;

  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct PngWriter {
  std::string encoded;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<png_byte> row;
  std::vector<png_text> texts;

  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

template <typename Owner>
[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  static_cast<Owner*>(png_get_error_ptr(png))->error = text;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep out, std::size_t size) {
  PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
  if (size > reader.bytes.size() - reader.at) png_error(png, "the file is cut short");
  std::memcpy(out, reader.bytes.data() + reader.at, size);
  reader.at += size;
}

void write_bytes(png_structp png, png_bytep data, std::size_t size) {
  static_cast<PngWriter*>(png_get_io_ptr(png))->encoded.append(reinterpret_cast<const char*>(data), size);
}

bool read_png_header(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_read_fn(reader.png, &reader, read_bytes);
  png_read_info(reader.png, reader.info);
  return true;
}

/// To 8 or 16 bits of grey, RGB or RGBA.
bool expand(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png);
  const bool alpha = (png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_ALPHA) != 0 ||
                     png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
  if (alpha) png_set_gray_to_rgb(reader.png);
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, reader.rows.data());
  png_read_end(reader.png, nullptr);
  return true;
}

/// The image's row `y` as PNG stores it: big-endian. NaN becomes 0.
void encode_row(const Image& image, int y, int bits, std::vector<png_byte>& row) {
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  const float* values = &image.data[static_cast<std::size_t>(y) * count];
  for (std::size_t i = 0; i < count; ++i) {
    if (bits == 8) {
      row[i] = static_cast<png_byte>(step_of(values[i], 255.0f));
    } else {
      const auto step = static_cast<std::uint16_t>(step_of(values[i], 65535.0f));
      row[2 * i] = static_cast<png_byte>(step >> 8);
      row[2 * i + 1] = static_cast<png_byte>(step & 255);
    }
  }
}

bool write_image(PngWriter& writer, const Image& image, int bits) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  const int colour = image.channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : image.channels == 3 ? PNG_COLOR_TYPE_RGB
                                           : PNG_COLOR_TYPE_RGB_ALPHA;
  png_set_write_fn(writer.png, &writer, write_bytes, nullptr);
  png_set_user_limits(writer.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), bits, colour, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  // Once filtered, drawn pictures hold runs and little else that repeats: looking for nothing else is five
  // times as fast, and makes files 2 to 6 % larger.
  png_set_compression_strategy(writer.png, Z_RLE);
  png_set_text(writer.png, writer.info, writer.texts.data(), static_cast<int>(writer.texts.size()));
  png_write_info(writer.png, writer.info);
  for (int y = 0; y < image.height; ++y) {
    encode_row(image, y, bits, writer.row);
    png_write_row(writer.png, writer.row.data());
  }
  png_write_end(writer.png, nullptr);
  return true;
}

}  // namespace

namespace {

/// Reads all up to the pixels, and returns the picture's size.
glm::ivec2 begin(PngReader& reader) {
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error<PngReader>, on_warning);
  if (reader.png == nullptr || (reader.info = png_create_info_struct(reader.png)) == nullptr)
    throw std::bad_alloc();
  if (!read_png_header(reader)) fail("{}: broken PNG: {}", reader.path.string(), reader.error);
  const png_uint_32 width = png_get_image_width(reader.png, reader.info);
  const png_uint_32 height = png_get_image_height(reader.png, reader.info);
  const int bits = png_get_bit_depth(reader.png, reader.info) * png_get_channels(reader.png, reader.info);
  constexpr std::uint64_t best_deflate = 1032;  // bytes out of one byte of a zlib stream
  check_size(reader.path, width, height, reader.bytes.size(),
             best_deflate * 8 / static_cast<std::uint64_t>(bits) + 1);
  return glm::ivec2(width, height);
}

}  // namespace

// Chunks of LENGTH NAME DATA SUM, behind a signature.
bool is_whole_png(std::span<const std::byte> bytes, bool by_sums) {
  constexpr std::size_t signature = 8, around = 12;
  const auto number = [&](std::size_t at) {
    return png_get_uint_32(reinterpret_cast<png_const_bytep>(&bytes[at]));
  };
  for (std::size_t at = signature, length = 0; at + around <= bytes.size(); at += around + length) {
    length = number(at);
    if (length > bytes.size() - at - around) return false;
    const auto summed = bytes.subspan(at + 4, 4 + length);  // name and data
    if (by_sums &&
        crc32_z(0, reinterpret_cast<const Bytef*>(summed.data()), summed.size()) != number(at + 8 + length))
      return false;
    if (std::memcmp(summed.data(), "IEND", 4) == 0) return true;
  }
  return false;
}

glm::ivec2 png_size(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  PngReader reader{path, bytes};
  const glm::ivec2 size = begin(reader);
  if (!is_whole_png(bytes, false)) fail("{}: broken PNG: the file is cut short", path.string());
  return size;
}

Image load_png(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit) {
  PngReader reader{path, bytes};
  const glm::ivec2 size = begin(reader);
  check_room(path, size.x, size.y, limit);
  if (!expand(reader)) fail("{}: broken PNG: {}", path.string(), reader.error);

  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const auto height = static_cast<std::size_t>(size.y);
  reader.values.resize(row_bytes * height);
  for (std::size_t y = 0; y < height; ++y) reader.rows.push_back(&reader.values[y * row_bytes]);
  if (!read_rows(reader)) fail("{}: broken PNG: {}", path.string(), reader.error);

  Image image(size.x, size.y, png_get_channels(reader.png, reader.info));
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    if (wide) {
      std::uint16_t step;
      std::memcpy(&step, &reader.values[2 * i], sizeof(step));
      image.data[i] = static_cast<float>(step) / 65535.0f;
    } else {
      image.data[i] = static_cast<float>(reader.values[i]) / 255.0f;
    }
  }
  return image;
}

std::string png_bytes(const Image& image, int bits, const Notes& notes) {
  if (bits != 8 && bits != 16) fail("a PNG has 8 or 16 bits, not {}", bits);
  PngWriter writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_error<PngWriter>, on_warning);
  if (writer.png == nullptr || (writer.info = png_create_info_struct(writer.png)) == nullptr)
    throw std::bad_alloc();
  writer.row.resize(static_cast<std::size_t>(image.width) *
                    static_cast<std::size_t>(image.channels * bits / 8));
  for (const auto& [key, value] : notes) {
    png_text text{};
    text.compression = PNG_ITXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(key.c_str());
    text.text = const_cast<char*>(value.c_str());
    writer.texts.push_back(text);
  }
  if (!write_image(writer, image, bits)) fail("cannot write a PNG: {}", writer.error);
  return std::move(writer.encoded);
}

void save_png(const std::filesystem::path& path, const Image& image, int bits, const Notes& notes) {
  OutputFile file(path);
  try {
    file.write(png_bytes(image, bits, notes));
  } catch (const Error& error) {
    fail("{}: {}", path.string(), error.what());
  }
  file.commit();
}

}  // namespace binosplat
