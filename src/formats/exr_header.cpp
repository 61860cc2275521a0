#include <algorithm>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "formats/content.h"
#include "formats/picture_readers.h"

namespace binosplat {

namespace {

/// Types of attributes whose values OpenEXR reads without a look at the size that the file gives.
struct FixedType {
  std::string_view name;
  std::size_t bytes;
};
constexpr FixedType fixed_types[] = {{"box2f", 16},
                                     {"box2i", 16},
                                     {"chromaticities", 32},
                                     {"compression", 1},
                                     {"deepImageState", 1},
                                     {"double", 8},
                                     {"envmap", 1},
                                     {"float", 4},
                                     {"int", 4},
                                     {"keycode", 28},
                                     {"lineOrder", 1},
                                     {"m33d", 72},
                                     {"m33f", 36},
                                     {"m44d", 128},
                                     {"m44f", 64},
                                     {"rational", 8},
                                     {"tiledesc", 9},
                                     {"timecode", 8},
                                     {"v2d", 16},
                                     {"v2f", 8},
                                     {"v2i", 8},
                                     {"v3d", 24},
                                     {"v3f", 12},
                                     {"v3i", 12}};

std::uint32_t number_at(std::string_view value, std::size_t at) {
  std::uint32_t bits = 0;
  for (std::size_t i = 4; i > 0; --i) bits = bits << 8 | static_cast<unsigned char>(value[at + i - 1]);
  return bits;
}

/// Length along an axis of a box2i: two corners, both within.
std::int64_t extent(std::string_view box, std::size_t axis) {
  const auto corner = [&](std::size_t at) { return static_cast<std::int32_t>(number_at(box, at)); };
  return std::int64_t{corner(8 + 4 * axis)} - corner(4 * axis) + 1;
}

/// What decides how much memory OpenEXR takes for a part of a file.
struct ExrPart {
  std::int64_t width = 0;  // px, of the data window
  std::int64_t height = 0;
  std::int64_t shown_width = 0;  // px, of the display window
  std::int64_t shown_height = 0;
  std::int64_t channels = 0;
  std::size_t compression = 0;
  bool tiled = false;
  std::int64_t tile_width = 1;  // px
  std::int64_t tile_height = 1;
};

/// Walks the attributes of all headers in a file: NAME 0 TYPE 0 SIZE VALUE, numbers with the lowest byte
/// first.
class Walker {
 public:
  Walker(const std::filesystem::path& path, std::span<const std::byte> bytes, const PictureLimit& limit)
      : path_(path), text_(as_text(bytes)), limit_(limit) {}

  void check() {
    if (text_.size() < 8) fail_broken();
    const bool tiled = (text_[5] & 0x02) != 0;
    const bool many_parts = (text_[5] & 0x10) != 0;
    do {
      ExrPart part;
      part.tiled = tiled;
      while (at_ < text_.size() && text_[at_] != '\0') read_attribute(part);
      ++at_;
      check_part(part);
    } while (many_parts && at_ < text_.size() && text_[at_] != '\0');
  }

 private:
  [[noreturn]] void fail_broken() const {
    fail("{}: broken OpenEXR: at byte {} of its header", path_.string(), at_);
  }

  std::string_view take(std::size_t size) {
    if (size > text_.size() - at_) fail_broken();
    const std::string_view taken = text_.substr(at_, size);
    at_ += size;
    return taken;
  }

  std::string_view take_name() {
    const std::size_t end = text_.find('\0', at_);
    if (end == std::string_view::npos || end - at_ > 255) fail_broken();
    const std::string_view name = take(end - at_);
    ++at_;
    return name;
  }

  void read_attribute(ExrPart& part) {
    const std::string_view name = take_name();
    const std::string_view type = take_name();
    const std::uint32_t size = number_at(take(4), 0);
    for (const FixedType& fixed : fixed_types) {
      if (fixed.name == type && fixed.bytes != size) fail_broken();
    }
    const std::size_t end = at_ + size;
    if (type == "chlist") part.channels = count_channels();
    const std::string_view value = type == "chlist" ? std::string_view() : take(size);
    if (at_ != end) fail_broken();

    if (name == "dataWindow" && type == "box2i") {
      part.width = extent(value, 0);
      part.height = extent(value, 1);
    } else if (name == "displayWindow" && type == "box2i") {
      part.shown_width = extent(value, 0);
      part.shown_height = extent(value, 1);
    } else if (name == "tiles" && type == "tiledesc") {
      part.tile_width = std::max<std::int64_t>(1, number_at(value, 0));
      part.tile_height = std::max<std::int64_t>(1, number_at(value, 4));
    } else if (name == "compression" && type == "compression") {
      part.compression = static_cast<unsigned char>(value[0]);
    } else if (name == "type") {
      part.tiled = value.find("tile") != std::string_view::npos;
    }
  }

  /// Of a list that ends with an empty name.
  std::int64_t count_channels() {
    std::int64_t count = 0;
    while (!take_name().empty()) {
      take(16);
      ++count;
    }
    return count;
  }

  void check_part(const ExrPart& part) const {
    // Of one colour all over, 7,000 px a byte were seen with DWA, 500 with the others, of up to 4 channels.
    const bool dwa = part.compression == 8 || part.compression == 9;
    const std::int64_t most = (dwa ? 16384 : 1024) * 4 / std::clamp<std::int64_t>(part.channels, 4, 4096);
    const auto check = [&](std::int64_t width, std::int64_t height) {
      check_size(path_, width, height, text_.size(), static_cast<std::uint64_t>(most));
    };
    check(part.width, part.height);
    check_room(path_, part.width, part.height, limit_);
    // What is shown around the data takes no bytes.
    constexpr std::int64_t shown = std::int64_t{1} << 24;  // px that need no reason: 4096 x 4096
    if (std::min(part.shown_width, part.shown_height) < 1 || part.shown_width > shown / part.shown_height)
      check(part.shown_width, part.shown_height);
    check_room(path_, part.shown_width, part.shown_height, limit_);

    // OpenEXR reads blocks of whole lines or rows of tiles, and makes room for a whole one even where the
    // picture is smaller.
    constexpr std::int64_t lines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    const std::int64_t block_width = part.tiled ? part.tile_width : part.width;
    const std::int64_t block_height =
        part.tiled ? part.tile_height : lines[std::min(part.compression, std::size(lines) - 1)];
    constexpr std::int64_t small = std::int64_t{1} << 22;  // px that need no reason
    const std::int64_t row = std::max(part.width, block_width);
    if (row > small / block_height) check(row, block_height);

    // A block takes 16 bytes at least: its place in a table, its own place and size.
    const auto blocks = [](std::int64_t length, std::int64_t block) { return (length + block - 1) / block; };
    const std::int64_t count = blocks(part.width, block_width) * blocks(part.height, block_height);
    if (count > std::ssize(text_) / 16) {
      fail("{} is damaged or cut short: its header promises {} blocks, which {} bytes cannot hold",
           path_.string(), count, text_.size());
    }
  }

  const std::filesystem::path& path_;
  std::string_view text_;
  const PictureLimit& limit_;
  std::size_t at_ = 8;
};

}  // namespace

void check_exr_header(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      const PictureLimit& limit) {
  Walker(path, bytes, limit).check();
}

}  // namespace binosplat
