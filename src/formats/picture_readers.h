#pragma once
// What load_image chooses from.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/image.h"
#include "formats/image_file.h"

namespace binosplat {

Image load_png(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit);
Image load_jpeg(const std::filesystem::path& path, std::span<const std::byte> bytes,
                const PictureLimit& limit);
Image load_exr(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit);

/// What picture_size() chooses from.
glm::ivec2 png_size(const std::filesystem::path& path, std::span<const std::byte> bytes);
glm::ivec2 jpeg_size(const std::filesystem::path& path, std::span<const std::byte> bytes);
glm::ivec2 exr_size(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Throws Error for a picture of more than 2^31 px, or of more than the file's bytes can hold at the best
/// compression that its format reaches, before anyone makes room for it: a header costs nothing to forge.
void check_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                std::uint64_t file_bytes, std::uint64_t most_pixels_a_byte);

/// Throws Error for a picture that check_size lets pass and that takes more than it may.
void check_room(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                const PictureLimit& limit);

/// Throws Error for an OpenEXR file whose headers promise what its bytes cannot hold: the library makes room
/// for attributes, tables and blocks of pixels before it looks; and for pictures beyond `limit`.
void check_exr_header(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      const PictureLimit& limit);

/// Whether a PNG has all of its chunks, up to the one that ends it, and where `by_sums` each as it was
/// written.
bool is_whole_png(std::span<const std::byte> bytes, bool by_sums);
/// Whether an OpenEXR file in lines has all of its blocks. Throws Error for what OpenEXR cannot read.
bool is_whole_exr(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
