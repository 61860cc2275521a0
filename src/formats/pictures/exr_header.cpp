#include <openexr.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

/// Reads a file's headers with OpenEXR's C library, which allocates no memory by sizes that the file states.
/// The C++ library does: 2 GB for a text that states this length in a file of 500 bytes.
class ExrHeaders {
 public:
  ExrHeaders(const std::filesystem::path& path, std::span<const std::byte> bytes)
      : path_(path), bytes_(bytes) {
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.user_data = this;
    how.read_fn = [](exr_const_context_t, void* self, void* to, std::uint64_t size, std::uint64_t from,
                     exr_stream_error_func_ptr_t) {
      const auto all = static_cast<const ExrHeaders*>(self)->bytes_;
      const auto left = all.subspan(std::min<std::size_t>(from, all.size()));
      const std::size_t count = std::min<std::size_t>(size, left.size());
      std::memcpy(to, left.data(), count);
      return static_cast<std::int64_t>(count);
    };
    how.size_fn = [](exr_const_context_t, void* self) {
      return static_cast<std::int64_t>(static_cast<const ExrHeaders*>(self)->bytes_.size());
    };
    how.error_handler_fn = [](exr_const_context_t context, exr_result_t, const char* text) {
      void* self = nullptr;
      if (exr_get_user_data(context, &self) == EXR_ERR_SUCCESS) static_cast<ExrHeaders*>(self)->note(text);
    };
    exr_context_t context = nullptr;
    const exr_result_t result = exr_start_read(&context, path.c_str(), &how);
    context_.reset(context);
    check(result);
    // The C library continues after some faults in headers, which the C++ library may interpret differently.
    if (!fault_.empty()) check(EXR_ERR_UNKNOWN);
  }

  int parts() const {
    int count = 0;
    check(exr_get_count(context_.get(), &count));
    return count;
  }

  /// Throws Error if the file cannot hold the pixels of an OpenEXR part, or if the pixels exceed `limit`.
  void check_part(int part, const PictureLimit& limit) const {
    exr_attr_box2i_t data, shown;
    exr_compression_t compression;
    exr_storage_t storage;
    const exr_attr_chlist_t* channels = nullptr;
    check(exr_get_data_window(context_.get(), part, &data));
    check(exr_get_display_window(context_.get(), part, &shown));
    check(exr_get_compression(context_.get(), part, &compression));
    check(exr_get_storage(context_.get(), part, &storage));
    check(exr_get_channels(context_.get(), part, &channels));
    const std::int64_t width = extent(data.min.x, data.max.x), height = extent(data.min.y, data.max.y);
    const std::int64_t shown_width = extent(shown.min.x, shown.max.x),
                       shown_height = extent(shown.min.y, shown.max.y);

    // Maximum number of pixels per byte. Pictures of one colour with up to 4 channels reach 7,000 with DWA,
    // and 500 with other compressions. The limits are about twice as large.
    const bool dwa = compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB;
    const int most = (dwa ? 16384 : 1024) * 4 / std::clamp(channels->num_channels, 4, 4096);
    const auto check_window = [&](std::int64_t w, std::int64_t h) {
      check_size(path_, w, h, bytes_.size(), static_cast<std::uint64_t>(most));
    };
    check_window(width, height);
    check_memory(path_, width, height, limit);
    // The area around the data window takes no bytes, so pictures of up to `always_allowed` px pass.
    constexpr std::int64_t always_allowed = std::int64_t{1} << 24;  // px: 4096 x 4096
    if (std::min(shown_width, shown_height) < 1 || shown_width > always_allowed / shown_height)
      check_window(shown_width, shown_height);
    check_memory(path_, shown_width, shown_height, limit);

    // OpenEXR allocates whole blocks of lines or rows of tiles, even for smaller pictures.
    const bool tiled = storage == EXR_STORAGE_TILED || storage == EXR_STORAGE_DEEP_TILED;
    std::uint32_t tile_width = 1, tile_height = 1;
    std::int32_t lines = 1, blocks = 0;
    if (tiled) {
      check(exr_get_tile_descriptor(context_.get(), part, &tile_width, &tile_height, nullptr, nullptr));
    } else {
      check(exr_get_scanlines_per_chunk(context_.get(), part, &lines));
    }
    const std::int64_t block_height = tiled ? std::int64_t{tile_height} : lines;
    const std::int64_t row = std::max(width, std::int64_t{tile_width});
    constexpr std::int64_t small = std::int64_t{1} << 22;  // px that are always allowed
    if (row > small / block_height) check_window(row, block_height);

    // A block takes at least 16 bytes: its entry in a table, its position and its size.
    check(exr_get_chunk_count(context_.get(), part, &blocks));
    if (blocks < 0 || static_cast<std::size_t>(blocks) > bytes_.size() / 16) {
      fail("{} is damaged or cut short: its header promises {} blocks, which {} bytes cannot hold", path_,
           blocks, bytes_.size());
    }
  }

 private:
  struct Finish {
    void operator()(exr_context_t context) const { exr_finish(&context); }
  };

  static std::int64_t extent(std::int32_t low, std::int32_t high) { return std::int64_t{high} - low + 1; }

  void note(const char* text) {
    if (fault_.empty()) fault_ = text;
  }

  void check(exr_result_t result) const {
    if (result == EXR_ERR_SUCCESS) return;
    fail("{}: broken OpenEXR: {}", path_, fault_.empty() ? exr_get_default_error_message(result) : fault_);
  }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  std::unique_ptr<std::remove_pointer_t<exr_context_t>, Finish> context_;
  std::string fault_;  // the first fault
};

}  // namespace

void check_exr_header(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      const PictureLimit& limit) {
  const ExrHeaders headers(path, bytes);
  for (int part = 0; part < headers.parts(); ++part) headers.check_part(part, limit);
}

}  // namespace binosplat
