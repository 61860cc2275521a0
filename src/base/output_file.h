#pragma once
// Files that appear whole or not at all: what is written goes to a temporary name beside the target, which
// commit() renames. Every output of the program is written through this.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace binosplat {

/// A file that is being written under a temporary name, for as long as this lives.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path);
  /// Leaves the file: who made it removes it.
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// From now on finished files have to stay. An OutputFile in a folder that held one, and is gone meanwhile,
/// is an Error and no new folder. For `main`: who calls the library may do with files what they like.
void watch_finished_files();

/// Throws Error naming a file that was finished since then and is not there now.
void check_finished_files();

/// Removes all unfinished files of the process, which is to end now: threads that are about to begin another
/// one, or to give one its name, wait for that end.
void remove_unfinished_files();

class OutputFile {
 public:
  /// Creates the folders above `path` where they are missing and opens PATH.part-PID-RANDOM in the same
  /// folder. A symbolic link is followed. Throws Error naming the path and the reason: a file stands where a
  /// folder is needed, no permission, or the path names something that is not a regular file (a folder, a
  /// device) or an input of the run (base/inputs.h).
  explicit OutputFile(const std::filesystem::path& path);

  /// Removes the temporary file unless it was committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The temporary file, for libraries that write by name; what write() is given may not be in it
  /// before commit().
  const std::filesystem::path& path() const { return temporary_->path(); }

  /// Appends. Throws Error, for one when the disk is full.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Puts all that was written into the temporary file, so that it can be read before commit(). Throws Error
  /// as write() does.
  void flush();

  /// Flushes, closes and renames to the target, replacing what stood there; a loss of power from then on
  /// leaves the file whole. Throws Error where any of it fails; then the target is as it was. A file of a
  /// cache, which others may remove, need not stay.
  void commit(bool has_to_stay = true);

  /// The same where nothing stands there; else false, and what stands there stays. Of several that do so at
  /// once, in whatever processes, one gets true.
  bool commit_as_first();

 private:
  void finish();
  void sync_folders() const;
  [[noreturn]] void fail_to_write() const;

  std::filesystem::path target_;
  std::vector<std::filesystem::path> folders_;  // the file's, and those above it that were made for it
  std::optional<UnfinishedFile> temporary_;     // until it has its name
  std::FILE* file_ = nullptr;
};

/// Writes a file whose contents are there as a whole. Throws as OutputFile does.
void write_file(const std::filesystem::path& path, std::string_view contents);

}  // namespace binosplat
