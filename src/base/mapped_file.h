#pragma once
// A file mapped into memory. The system reads pages on access.

#include <cstddef>
#include <filesystem>
#include <span>

namespace binosplat {

/// Throws the Error for a missing or unreadable file; `reason` is an errno.
[[noreturn]] void fail_to_read(const std::filesystem::path& path, int reason);

class MappedFile {
 public:
  /// Maps the whole file; an empty file gives no bytes. Throws Error for folders and unreadable files.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace binosplat
