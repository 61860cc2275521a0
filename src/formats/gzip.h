#pragma once
// gzip: read in pieces whose sizes the reader knows beforehand, so that nothing unfolds beyond them.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct z_stream_s;

namespace binosplat {

/// The most bytes that deflate, which zip archives use, too, can make of one.
inline constexpr std::size_t deflate_growth_most = 1032;

class GzipReader {
 public:
  /// Starts with the first member of `bytes`, which outlive this; `source` names them in errors.
  GzipReader(std::string source, std::span<const std::byte> bytes);
  ~GzipReader();
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  /// The next bytes, `most` or those up to the end. Throws Error where they are damaged, cut short or their
  /// checksum, which stands at the end, is wrong.
  std::vector<std::byte> read(std::size_t most);

 private:
  std::string source_;
  std::unique_ptr<z_stream_s> stream_;
  bool ended_ = false;
};

/// The bytes as gzip has them; always the same for the same ones: it has no time in it.
std::vector<std::byte> gzip_of(std::span<const std::byte> bytes);

}  // namespace binosplat
