#pragma once
// Reads and writes pictures. In memory pictures are display-referred floats (base/image.h).

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>

#include "base/image.h"

namespace binosplat {

/// Texts that a picture's file contains in addition to pixels: PNG text chunks, EXR header attributes.
using Notes = std::map<std::string, std::string>;

/// Limits the memory that a picture takes in the whole program, `bytes_per_pixel` for each pixel. Even a
/// small file can exceed the limit, because a thousand pixels of one colour take one bit.
struct PictureLimit {
  std::uint64_t bytes = UINT64_MAX;
  std::uint64_t bytes_per_pixel = 1;
  const char* advice = "";  // how to raise the limit, for the end of the error's text
};

/// Reads PNG (grey, RGB, palette, with or without alpha; 1 to 16 bits), JPEG (grey or colour) or OpenEXR
/// (formats/pictures/exr.h), recognised by content. The image has 1 channel for grey, 3 for RGB, 4 with
/// alpha. Throws Error naming the file for other formats and for damaged or cut files. If the picture exceeds
/// `limit`, throws Error with ExitCode::out_of_memory before it allocates memory.
Image load_image(const std::filesystem::path& path, const PictureLimit& limit = {});

/// Returns width and height in px of load_image()'s result. Reads only the header and the end of the file, so
/// a photo takes milliseconds. Throws Error as load_image() does, for faults in these two parts.
glm::ivec2 picture_size(const std::filesystem::path& path);

struct PngOptions {
  int bits = 8;   // per channel: 8 or 16
  int level = 1;  // of libdeflate, 0 (fast) to 12 (small)
  Notes notes;
};

/// Writes each value v as round(255 clamp(v)), or with 65535 for 16 bits. The image has 1, 3 or 4 channels.
/// Applies no gamma: the values are sRGB already, and the file declares this.
void save_png(const std::filesystem::path& path, const Image& image, const PngOptions& options = {});

std::string png_bytes(const Image& image, const PngOptions& options = {});

}  // namespace binosplat
