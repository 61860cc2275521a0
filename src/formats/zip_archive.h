#pragma once
// Zip archives in memory, read with libzip. Nothing is ever written to disk.

#include <zip.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace binosplat {

class ZipArchive {
 public:
  /// Opens the archive that `bytes` are; they must outlive it. `path` is named in every error. Throws Error
  /// for what is no whole archive, and for an entry whose name leads out of it ("/x", "../x").
  ZipArchive(const std::filesystem::path& path, std::span<const std::byte> bytes);

  /// The names of its entries, in its order.
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const;

  /// An entry's whole content, unpacked and checked against its checksum. Throws Error if there is none of
  /// this name, if it promises or unpacks to more than `bytes_max`, or if it is damaged.
  std::vector<std::byte> read(const std::string& name, std::size_t bytes_max) const;

 private:
  struct Close {
    void operator()(zip_t* archive) const { zip_discard(archive); }
  };

  std::filesystem::path path_;
  std::unique_ptr<zip_t, Close> archive_;
  std::vector<std::string> names_;
};

}  // namespace binosplat
