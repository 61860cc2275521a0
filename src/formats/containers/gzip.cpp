#include "formats/containers/gzip.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <new>

#include "base/error.h"

namespace binosplat {

namespace {

constexpr int with_gzip_header = 16 + MAX_WBITS;
/// zlib counts bytes in 32 bits.
constexpr std::size_t max_at_once = std::size_t{1} << 30;

}  // namespace

GzipReader::GzipReader(std::string source, std::span<const std::byte> bytes)
    : source_(std::move(source)), stream_(std::make_unique<z_stream>()) {
  *stream_ = {};
  // zlib does not write to its input.
  stream_->next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  // Files of these formats are below 4 GiB.
  stream_->avail_in = static_cast<uInt>(std::min<std::size_t>(bytes.size(), 0xffffffff));
  if (inflateInit2(stream_.get(), with_gzip_header) != Z_OK) throw std::bad_alloc();
}

GzipReader::~GzipReader() { inflateEnd(stream_.get()); }

std::vector<std::byte> GzipReader::read(std::size_t most) {
  std::vector<std::byte> out(most);
  std::size_t filled = 0;
  while (!ended_ && filled < most) {
    stream_->next_out = reinterpret_cast<Bytef*>(out.data() + filled);
    const std::size_t capacity = std::min(most - filled, max_at_once);
    stream_->avail_out = static_cast<uInt>(capacity);
    const int result = inflate(stream_.get(), Z_NO_FLUSH);
    filled += capacity - stream_->avail_out;
    ended_ = result == Z_STREAM_END;
    if (result == Z_BUF_ERROR || (result == Z_OK && stream_->avail_in == 0 && stream_->avail_out > 0)) {
      fail("{} is cut short: its gzip data ends after {} unpacked bytes; fetch or export it again", source_,
           stream_->total_out);
    }
    if (result != Z_OK && result != Z_STREAM_END) {
      fail("{} is damaged: {} after {} unpacked bytes of its gzip data; fetch or export it again", source_,
           stream_->msg != nullptr ? stream_->msg : "an unknown fault", stream_->total_out);
    }
  }
  out.resize(filled);
  return out;
}

std::vector<std::byte> gzip_of(std::span<const std::byte> bytes) {
  constexpr int usual_level = 6;
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(usual_level), libdeflate_free_compressor);
  if (compressor == nullptr) throw std::bad_alloc();
  std::vector<std::byte> out(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()));
  out.resize(libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

}  // namespace binosplat
