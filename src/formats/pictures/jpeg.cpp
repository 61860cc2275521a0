#include <turbojpeg.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "formats/containers/content.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

using namespace std::string_view_literals;

class JpegReader {
 public:
  JpegReader(const std::filesystem::path& path, std::span<const std::byte> bytes)
      : path_(path), bytes_(bytes), decoder_(tjInitDecompress(), &tjDestroy) {
    if (decoder_ == nullptr) fail("{}: {}", path, tjGetErrorStr2(nullptr));
    int subsampling = 0;
    if (tjDecompressHeader3(decoder_.get(), data(), bytes.size(), &size_.x, &size_.y, &subsampling,
                            &colours_) != 0) {
      fail("{}: broken JPEG: {}", path, tjGetErrorStr2(decoder_.get()));
    }
    if (size_.x == 0 || size_.y == 0) fail("{}: broken JPEG: it ends before its picture begins", path);
    if (colours_ == TJCS_CMYK || colours_ == TJCS_YCCK) fail("{}: a CMYK JPEG; convert it to RGB", path);
    // With 2 bits for a block of 8 x 8 px, a byte holds 256 px. Progressive files need fewer bits.
    check_size(path, size_.x, size_.y, bytes.size(), 1024);
    warn_if_turned();
  }

  const glm::ivec2& size() const { return size_; }

  /// Returns whether an end marker follows the start of the pixels. Pixel data cannot contain one.
  bool has_end() const {
    const std::string_view text = as_text(bytes_);
    std::size_t at = 2;
    while (at + 4 <= text.size() && text[at] == '\xff' && text[at + 1] != '\xda') {
      // Any number of bytes 255 may precede a marker.
      const bool fill = text[at + 1] == '\xff';
      const auto high = static_cast<unsigned char>(text[at + 2]);
      at += fill ? 1 : 2 + std::size_t{256} * high + static_cast<unsigned char>(text[at + 3]);
    }
    return at < text.size() && text.find("\xff\xd9", at) != std::string_view::npos;
  }

  Image read() const {
    const int channels = colours_ == TJCS_GRAY ? 1 : 3;
    Image image(size_.x, size_.y, channels);
    std::vector<unsigned char> values(image.data.size());
    const int format = channels == 1 ? TJPF_GRAY : TJPF_RGB;
    if (tjDecompress2(decoder_.get(), data(), bytes_.size(), values.data(), size_.x, size_.x * channels,
                      size_.y, format, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0) {
      // The library only warns about a cut file, and fills the rest with grey.
      const std::string_view reason = tjGetErrorStr2(decoder_.get());
      if (tjGetErrorCode(decoder_.get()) != TJERR_WARNING ||
          reason.find("remature") != std::string_view::npos) {
        fail("{}: broken JPEG: {}", path_, reason);
      }
      log_warning("{}: {}", path_, reason);
    }
    for (std::size_t i = 0; i < values.size(); ++i) image.data[i] = static_cast<float>(values[i]) / 255.0f;
    return image;
  }

 private:
  void warn_if_turned() const {
    const std::string_view text = as_text(bytes_).substr(0, 65536);
    // EXIF's entry of the orientation, one short with the tag 0x112, in either byte order
    for (const auto entry : {"\x12\1\3\0\1\0\0\0"sv, "\1\x12\0\3\0\0\0\1\0"sv}) {
      const std::string_view found = text.substr(std::min(text.find(entry), text.size()));
      const int turn = found.size() > entry.size() ? found[entry.size()] : 1;
      static std::atomic<bool> said = false;
      if (turn > 1 && turn <= 8 && !said.exchange(true))
        log_warning(
            "{}: its EXIF turns it (orientation {}), and perhaps others; pixels are taken as stored, as "
            "COLMAP does. If its camera sees the turned photo, turn the pixels",
            path_, turn);
    }
  }

  const unsigned char* data() const { return reinterpret_cast<const unsigned char*>(bytes_.data()); }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  std::unique_ptr<void, decltype(&tjDestroy)> decoder_;
  glm::ivec2 size_{0};
  int colours_ = 0;
};

}  // namespace

glm::ivec2 jpeg_size(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const JpegReader reader(path, bytes);
  if (!reader.has_end()) fail("{}: broken JPEG: the file is cut short", path);
  return reader.size();
}

Image load_jpeg(const std::filesystem::path& path, std::span<const std::byte> bytes,
                const PictureLimit& limit) {
  const JpegReader reader(path, bytes);
  check_memory(path, reader.size().x, reader.size().y, limit);
  return reader.read();
}

}  // namespace binosplat
