#pragma once
// The readers of each picture format, for load_image and picture_size.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/image.h"
#include "formats/pictures/image_file.h"

namespace binosplat {

Image load_png(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit);
Image load_jpeg(const std::filesystem::path& path, std::span<const std::byte> bytes,
                const PictureLimit& limit);
Image load_exr(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit);

glm::ivec2 png_size(const std::filesystem::path& path, std::span<const std::byte> bytes);
glm::ivec2 jpeg_size(const std::filesystem::path& path, std::span<const std::byte> bytes);
glm::ivec2 exr_size(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Returns a PNG's texels as sog_texels() does (formats/pictures/webp.h). Throws Error for 16 bits a
/// channel.
std::vector<std::uint8_t> png_texels(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Throws Error for a picture of more than 2^31 px, or of more px than the file's bytes can hold at the
/// format's best compression. Readers call it before they allocate memory, because headers can be forged.
void check_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                std::uint64_t file_bytes, std::uint64_t max_pixels_per_byte);

/// Throws Error for a picture that passed check_size() but exceeds its memory limit.
void check_memory(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                  const PictureLimit& limit);

/// Throws Error for an OpenEXR file whose headers promise more than its bytes can hold, and for pictures
/// beyond `limit`. The library allocates attributes, tables and blocks of pixels before it checks.
void check_exr_header(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      const PictureLimit& limit);

/// Returns whether a PNG has all of its chunks up to the end; with `by_sums`, checks each chunk's checksum.
bool is_whole_png(std::span<const std::byte> bytes, bool by_sums);
/// Returns whether an OpenEXR file in scan lines has all blocks. Throws Error if OpenEXR cannot read it.
bool is_whole_exr(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
