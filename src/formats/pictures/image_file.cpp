#include "formats/pictures/image_file.h"

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/containers/content.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

struct PictureReader {
  Content content;
  Image (*load)(const std::filesystem::path&, std::span<const std::byte>, const PictureLimit&);
  glm::ivec2 (*size)(const std::filesystem::path&, std::span<const std::byte>);
};
constexpr PictureReader picture_readers[] = {{Content::png, load_png, png_size},
                                             {Content::jpeg, load_jpeg, jpeg_size},
                                             {Content::exr, load_exr, exr_size}};

const PictureReader& reader_of(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const Content content = content_of(bytes);
  for (const PictureReader& reader : picture_readers)
    if (reader.content == content) return reader;
  fail(
      "{} is not a picture that can be read: expected PNG, JPEG or OpenEXR (convert it to PNG), but it looks "
      "like {}",
      path, describe(content));
}

}  // namespace

Image load_image(const std::filesystem::path& path, const PictureLimit& limit) {
  const MappedFile file(path);
  return reader_of(path, file.bytes()).load(path, file.bytes(), limit);
}

glm::ivec2 picture_size(const std::filesystem::path& path) {
  const MappedFile file(path);
  return reader_of(path, file.bytes()).size(path, file.bytes());
}

void check_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                std::uint64_t file_bytes, std::uint64_t max_pixels_per_byte) {
  constexpr std::int64_t max_pixels = std::int64_t{1} << 31;
  if (width < 1 || height < 1 || width > max_pixels || height > max_pixels / width)
    fail("{}: a picture of {} x {} px cannot be read (from 1 px to 2^31)", path, width, height);
  if (static_cast<std::uint64_t>(width * height) / max_pixels_per_byte > file_bytes) {
    fail("{} is damaged or cut short: its header promises {} x {} px, which {} bytes cannot hold", path,
         width, height, file_bytes);
  }
}

void check_memory(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                  const PictureLimit& limit) {
  const auto pixels = static_cast<std::uint64_t>(width * height);  // at most 2^31: see check_size
  const std::uint64_t bytes = pixels * limit.bytes_per_pixel;
  if (bytes <= limit.bytes) return;
  throw Error(ExitCode::out_of_memory,
              fmt::format("{}: {} x {} px need {} MB of memory, and {} MB are allowed{}", path, width, height,
                          bytes / 1'000'000, limit.bytes / 1'000'000, limit.advice));
}

}  // namespace binosplat
