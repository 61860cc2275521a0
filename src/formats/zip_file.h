#pragma once
// Files in a zip archive, by name. Nothing is ever written to a disk by a name that an archive gives.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

struct zip;

namespace binosplat {

/// Whether a name that a file gives stays below that file's folder.
bool stays_below(const std::string& name);

/// Files of an archive that is to be written: names and contents.
using ZipEntries = std::vector<std::pair<std::string, std::vector<std::byte>>>;

/// An archive of these files, stored as they are; always the same bytes for the same files. Throws Error
/// where memory is short.
std::vector<std::byte> zip_of(const ZipEntries& entries);

class ZipFile {
 public:
  /// Opens an archive whose bytes outlive this; `source` names it in errors. Throws Error where the list of
  /// files at its end is damaged or missing.
  ZipFile(std::string source, std::span<const std::byte> bytes);

  bool has(const std::string& name) const;

  /// The names of its files, in its order.
  std::vector<std::string> names() const;

  /// The same for an error's text, the first few.
  std::string list() const;

  /// A whole file, stored or deflated, its checksum tested. Throws Error where it is missing, damaged,
  /// promises more than its bytes can unfold to, or more than `bytes_max`.
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
