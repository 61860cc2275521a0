#include <turbojpeg.h>

#include <memory>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "formats/picture_readers.h"

namespace binosplat {

std::optional<glm::ivec2> jpeg_size(std::span<const std::byte> bytes) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), &tjDestroy);
  glm::ivec2 size{0};
  int subsampling = 0, colours = 0;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const bool good = decoder != nullptr && tjDecompressHeader3(decoder.get(), data, bytes.size(), &size.x,
                                                              &size.y, &subsampling, &colours) == 0;
  return good ? std::optional(size) : std::nullopt;
}

Image load_jpeg(const std::filesystem::path& path, std::span<const std::byte> bytes,
                const PictureLimit& limit) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), &tjDestroy);
  if (decoder == nullptr) fail("{}: {}", path.string(), tjGetErrorStr2(nullptr));
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling, &colours) != 0) {
    fail("{}: broken JPEG: {}", path.string(), tjGetErrorStr2(decoder.get()));
  }
  if (width == 0 || height == 0) fail("{}: broken JPEG: it ends before its picture begins", path.string());
  if (colours == TJCS_CMYK || colours == TJCS_YCCK) fail("{}: a CMYK JPEG; convert it to RGB", path.string());
  check_size(path, width, height, bytes.size(),
             1024);  // two bits a block of 8 x 8 make 256, progressive ones less
  check_room(path, width, height, limit);

  const int channels = colours == TJCS_GRAY ? 1 : 3;
  Image image(width, height, channels);
  std::vector<unsigned char> values(image.data.size());
  const int format = channels == 1 ? TJPF_GRAY : TJPF_RGB;
  if (tjDecompress2(decoder.get(), data, bytes.size(), values.data(), width, width * channels, height, format,
                    TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0) {
    // A cut file is only a warning to the library, which fills the rest with grey.
    const std::string_view reason = tjGetErrorStr2(decoder.get());
    if (tjGetErrorCode(decoder.get()) != TJERR_WARNING || reason.find("remature") != std::string_view::npos) {
      fail("{}: broken JPEG: {}", path.string(), reason);
    }
    log_warning("{}: {}", path.string(), reason);
  }
  for (std::size_t i = 0; i < values.size(); ++i) image.data[i] = static_cast<float>(values[i]) / 255.0f;
  return image;
}

}  // namespace binosplat
