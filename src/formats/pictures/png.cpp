// libpng reports errors by longjmp, which runs no destructors. Functions that it may leave keep their objects
// in a struct of the caller.
#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"
#include "formats/containers/bytes.h"
#include "formats/pictures/image_file.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

struct PngReader {
  const std::filesystem::path& path;
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
  bool rgba = false;  // expands all pixels to RGBA
  std::vector<png_byte> values;
  std::vector<png_bytep> rows;

  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  static_cast<PngReader*>(png_get_error_ptr(png))->error = text;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep out, std::size_t size) {
  PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
  if (size > reader.bytes.size() - reader.at) png_error(png, "the file is cut short");
  std::memcpy(out, reader.bytes.data() + reader.at, size);
  reader.at += size;
}

/// Calls `work`, which libpng may leave. Throws Error if it does.
void with_png_errors(PngReader& reader, void (*work)(PngReader& reader)) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) fail("{}: broken PNG: {}", reader.path, reader.error);
  work(reader);
}

void read_png_header(PngReader& reader) {
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_read_fn(reader.png, &reader, read_bytes);
  png_read_info(reader.png, reader.info);
}

/// Expands pixels to 8 or 16 bits of grey, RGB or RGBA.
void expand(PngReader& reader) {
  png_set_expand(reader.png);
  const bool alpha = (png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_ALPHA) != 0 ||
                     png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
  if (alpha || reader.rgba) png_set_gray_to_rgb(reader.png);
  if (reader.rgba) png_set_add_alpha(reader.png, 255, PNG_FILLER_AFTER);
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_read_update_info(reader.png, reader.info);
}

void read_rows(PngReader& reader) {
  png_read_image(reader.png, reader.rows.data());
  png_read_end(reader.png, nullptr);
}

/// Reads everything before the pixels, and returns the picture's size.
glm::ivec2 begin(PngReader& reader) {
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
  if (reader.png == nullptr || (reader.info = png_create_info_struct(reader.png)) == nullptr)
    throw std::bad_alloc();
  with_png_errors(reader, read_png_header);
  const png_uint_32 width = png_get_image_width(reader.png, reader.info);
  const png_uint_32 height = png_get_image_height(reader.png, reader.info);
  const int bits = png_get_bit_depth(reader.png, reader.info) * png_get_channels(reader.png, reader.info);
  constexpr std::uint64_t best_deflate = 1032;  // maximum bytes from one byte of a zlib stream
  check_size(reader.path, width, height, reader.bytes.size(),
             best_deflate * 8 / static_cast<std::uint64_t>(bits) + 1);
  return glm::ivec2(width, height);
}

void read_values(PngReader& reader, int height) {
  with_png_errors(reader, expand);
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  reader.values.resize(row_bytes * static_cast<std::size_t>(height));
  for (std::size_t at = 0; at < reader.values.size(); at += row_bytes)
    reader.rows.push_back(&reader.values[at]);
  with_png_errors(reader, read_rows);
}

}  // namespace

// A PNG is a signature, then chunks of LENGTH NAME DATA CHECKSUM.
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
  if (!is_whole_png(bytes, false)) fail("{}: broken PNG: the file is cut short", path);
  return size;
}

Image load_png(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit) {
  PngReader reader{path, bytes};
  const glm::ivec2 size = begin(reader);
  check_memory(path, size.x, size.y, limit);
  read_values(reader, size.y);
  Image image(size.x, size.y, png_get_channels(reader.png, reader.info));
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  const auto values = std::as_bytes(std::span(reader.values));
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = wide ? static_cast<float>(load_number<std::uint16_t>(&values[2 * i])) / 65535.0f
                         : static_cast<float>(reader.values[i]) / 255.0f;
  return image;
}

std::vector<std::uint8_t> png_texels(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  PngReader reader{path, bytes};
  const glm::ivec2 size = begin(reader);
  if (png_get_bit_depth(reader.png, reader.info) == 16)
    fail("{}: a PNG picture of 16 bits a channel; expected 8: export the model again", path);
  reader.rgba = true;
  read_values(reader, size.y);
  return reader.values;
}

}  // namespace binosplat
