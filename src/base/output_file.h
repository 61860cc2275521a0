#pragma once
// Files that are complete or absent: writes go to a temporary file beside the target, which commit() renames.
// The program writes every output this way.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace binosplat {

/// The path of a temporary file, registered while this exists.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path);
  /// Unregisters the file, but does not remove it: its creator does.
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// From now on, finished files must stay. If a folder with a finished file disappears, OutputFile throws
/// Error and does not create the folder again. Only for `main`: users of the library may remove files.
void watch_finished_files();

/// Throws Error, naming a file that was finished since then and no longer exists.
void check_finished_files();

/// Removes all unfinished files; the process must end now. Threads that start or commit a file block until
/// then.
void remove_unfinished_files();

class OutputFile {
 public:
  /// Creates missing folders above `path` and opens PATH.part-PID-RANDOM in its folder. Follows a symbolic
  /// link. Throws Error with path and reason: a file in place of a folder, no permission, a folder or device,
  /// or an input of the run (base/inputs.h).
  explicit OutputFile(const std::filesystem::path& path);

  /// Removes the temporary file unless it was committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The temporary file, for libraries that write by name. Before commit() it may lack data from write().
  const std::filesystem::path& path() const { return temporary_->path(); }

  /// Appends. Throws Error, for example on a full disk.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Flushes all writes to the temporary file, so that it can be read before commit(). Throws Error as
  /// write() does.
  void flush();

  /// Flushes, closes and renames to the target, which it replaces. Then even a power failure leaves a
  /// complete file. Throws Error if any step fails, and leaves the target as before. `has_to_stay`: false for
  /// files of caches, which others may remove.
  void commit(bool has_to_stay = true);

  /// As commit(), but only if the target does not exist; else returns false. Of several processes at once,
  /// exactly one gets true.
  bool commit_as_first();

 private:
  void finish();
  void sync_folders() const;
  [[noreturn]] void fail_to_write() const;

  std::filesystem::path target_;
  std::vector<std::filesystem::path> folders_;  // the file's, and those created above it
  std::optional<UnfinishedFile> temporary_;     // until it is renamed
  std::FILE* file_ = nullptr;
};

/// Writes a complete file. Throws as OutputFile does.
void write_file(const std::filesystem::path& path, std::string_view contents);

}  // namespace binosplat
