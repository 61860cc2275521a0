#pragma once
// Reads gzip up to a given size, so that a small file cannot unpack to a huge one.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct z_stream_s;

namespace binosplat {

/// The largest factor by which data in the deflate format (gzip, zip) expands.
inline constexpr std::size_t max_deflate_growth = 1032;

class GzipReader {
 public:
  /// Starts at the first gzip member in `bytes`, which must outlive this object. Errors name `source`.
  GzipReader(std::string source, std::span<const std::byte> bytes);
  ~GzipReader();
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  /// Returns the next bytes: `most`, or fewer at the end. Throws Error if they are damaged or cut short, or
  /// if the checksum at the end is wrong.
  std::vector<std::byte> read(std::size_t most);

 private:
  std::string source_;
  std::unique_ptr<z_stream_s> stream_;
  bool ended_ = false;
};

/// Compresses bytes. The result is deterministic: it contains no time.
std::vector<std::byte> gzip_of(std::span<const std::byte> bytes);

}  // namespace binosplat
