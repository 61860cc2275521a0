#pragma once
// A file's bytes in memory, read by the system as they are touched.

#include <cstddef>
#include <filesystem>
#include <span>

namespace binosplat {

class MappedFile {
 public:
  /// Maps the whole file for reading. Throws Error if it is missing, a folder or not readable; an empty file
  /// is mapped as no bytes.
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
