#pragma once
// Pictures from and to files. In memory they are display-referred floats (base/image.h).

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "base/image.h"

namespace binosplat {

/// Words that a picture's file carries beside its pixels: PNG text chunks, EXR header attributes.
using Notes = std::map<std::string, std::string>;

/// What a picture may take in all that its reader does with it, which a small file may be far beyond: the
/// pixels of one colour are a bit in a thousand.
struct PictureLimit {
  std::uint64_t bytes = UINT64_MAX;
  std::uint64_t bytes_per_pixel = 1;
  const char* advice = "";  // who may raise it, for the end of the error's text
};

/// Reads PNG (grey, RGB, palette, with or without alpha; 1 to 16 bits), JPEG (grey or colour) or OpenEXR
/// (formats/exr.h says how); which one is decided by content. 1 channel for grey, 3 for RGB, 4 where there is
/// alpha. Throws Error naming the file for anything else, for damaged or cut files and, with
/// ExitCode::out_of_memory and before any is taken, for pictures beyond `limit`.
Image load_image(const std::filesystem::path& path, const PictureLimit& limit = {});

/// Width and height in px of what load_image() would read. Throws Error as that does, as far as the file's
/// header and end show: a photo takes milliseconds.
glm::ivec2 picture_size(const std::filesystem::path& path);

struct PngOptions {
  int bits = 8;   // a channel, or 16
  int level = 1;  // of libdeflate, 0 (fast) to 12 (small)
  Notes notes;
};

/// Writes round(255 clamp(v)), or 65535 for 16 bits, of 1, 3 or 4 channels. No gamma is applied: the values
/// are sRGB as they are, and the file says so.
void save_png(const std::filesystem::path& path, const Image& image, const PngOptions& options = {});

/// The bytes of such a file.
std::string png_bytes(const Image& image, const PngOptions& options = {});

}  // namespace binosplat
