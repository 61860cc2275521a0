#pragma once
// Files in a zip archive, by name. No name from an archive is ever used to write to disk.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

struct zip;

namespace binosplat {

/// Returns whether the relative path `name` in a file stays below the file's folder.
bool is_below_folder(const std::string& name);

/// Files of an archive to write: names and contents.
using ZipEntries = std::vector<std::pair<std::string, std::vector<std::byte>>>;

/// Returns an uncompressed, deterministic archive of these files. Throws Error if memory is short.
std::vector<std::byte> zip_of(const ZipEntries& entries);

class ZipFile {
 public:
  /// Opens an archive whose bytes outlive this object. Errors name the archive `source`. Throws Error if the
  /// list of files at its end is damaged or missing.
  ZipFile(std::string source, std::span<const std::byte> bytes);

  bool has(const std::string& name) const;

  /// Returns the names of its files, in file order.
  std::vector<std::string> names() const;

  /// Returns the first few names, for an error's text.
  std::string list() const;

  /// Returns the contents of a file, stored or deflated; verifies the checksum. Throws Error if the file is
  /// missing or damaged, or if its promised size exceeds `bytes_max` or what its bytes can expand to.
  std::vector<std::byte> read(const std::string& name, std::size_t bytes_max = SIZE_MAX) const;

 private:
  [[noreturn]] void fail_entry(const std::string& name, const std::string& reason) const;

  struct Close {
    void operator()(zip* archive) const;
  };
  std::string source_;
  std::uint64_t bytes_;  // of the archive
  std::unique_ptr<zip, Close> archive_;
};

}  // namespace binosplat
