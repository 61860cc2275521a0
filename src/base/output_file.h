#pragma once
// Files that are complete or absent: commit() renames a temporary file. Every output is written this way.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace binosplat {

/// Registers the path of a temporary file for remove_unfinished_files(), while this object exists.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path);
  /// Unregisters the file. Its creator removes it.
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Removes all unfinished files. Threads that then start or commit a file block forever, so end the process.
void remove_unfinished_files();

class OutputFile {
 public:
  /// Creates missing folders and opens PATH.part-PID-RANDOM beside PATH. Follows a symbolic link. Throws
  /// Error with path and reason on failure, or if `path` is a folder, a device or an input (base/inputs.h).
  explicit OutputFile(const std::filesystem::path& path);

  /// Removes the temporary file unless it was committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The temporary file, for libraries that write to a path. Before commit() it may lack data from write().
  const std::filesystem::path& path() const { return temporary_->path(); }

  /// Appends. Throws Error, for example on a full disk.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Flushes writes to the temporary file, so that it can be read before commit(). Throws as write() does.
  void flush();

  /// Flushes and closes the temporary file, and renames it to the target, which it replaces. Afterwards even
  /// a power failure leaves a complete file. If a step fails, throws Error and leaves the target as before.
  void commit();

  /// Like commit(), but returns false if the target exists. Of several processes, exactly one gets true.
  bool commit_as_first();

 private:
  void finish();
  void sync_folders() const;
  [[noreturn]] void fail_to_write() const;

  std::filesystem::path target_;
  std::vector<std::filesystem::path> folders_;  // the target's folder and its parents, up to one that existed
  std::optional<UnfinishedFile> temporary_;     // until the file is renamed
  std::FILE* file_ = nullptr;
};

/// Writes a complete file. Throws as OutputFile does.
void write_file(const std::filesystem::path& path, std::string_view contents);

}  // namespace binosplat
