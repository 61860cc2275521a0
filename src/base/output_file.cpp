#include "base/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <random>
#include <set>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/inputs.h"

namespace binosplat {

namespace fs = std::filesystem;

namespace {

/// Waits until a file or folder is stored on the disk. On failure returns false and sets errno. Disks without
/// fsync and unreadable folders count as stored.
bool is_on_disk(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno == EACCES;
  const bool good = fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS;
  const int reason = errno;
  close(file);
  errno = reason;
  return good;
}

/// The unfinished files of all threads. Never destroyed, because a thread may hold the lock at exit.
struct Unfinished {
  std::mutex mutex;
  std::multiset<fs::path> paths;
};

Unfinished& unfinished() {
  static auto* const all = new Unfinished;
  return *all;
}

}  // namespace

UnfinishedFile::UnfinishedFile(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().paths.insert(path_);
}

UnfinishedFile::~UnfinishedFile() {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().paths.extract(path_);
}

void remove_unfinished_files() {
  unfinished().mutex.lock();
  std::error_code ignored;
  for (const fs::path& path : unfinished().paths) fs::remove(path, ignored);
}

OutputFile::OutputFile(const fs::path& path) : target_(path) {
  std::error_code ignored;
  // A rename would replace the link, not the file that it points to.
  if (fs::is_symlink(target_, ignored)) target_ = fs::weakly_canonical(target_, ignored);
  if (!target_.has_filename()) fail("cannot write '{}': expected the name of a file", path);

  const fs::file_status status = fs::status(target_, ignored);
  if (fs::is_directory(status)) fail("cannot write {}: it is a folder; name a file in it", path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail("cannot write {}: it is a device or a pipe, which a finished file cannot replace", path);
  check_no_input(target_);
  const fs::path folder = target_.parent_path();
  folders_.push_back(folder.empty() ? "." : folder);
  while (!fs::exists(folders_.back(), ignored) && folders_.back().has_relative_path()) {
    const fs::path above = folders_.back().parent_path();
    folders_.push_back(above.empty() ? "." : above);
  }
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) fail("cannot write {}: the folder {} cannot be made: {}", path, folder, error.message());

  // Containers or machines that share a disk may have equal process ids, so the name has a random number.
  temporary_.emplace(target_.string() + fmt::format(".part-{}-{:08x}", getpid(), std::random_device()()));
  {
    // Holds the lock, so that no file appears after remove_unfinished_files().
    const std::lock_guard lock(unfinished().mutex);
    file_ = std::fopen(temporary_->path().c_str(), "wb");
  }
  if (file_ == nullptr) fail_to_write();
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  std::error_code ignored;
  if (temporary_) fs::remove(temporary_->path(), ignored);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail_to_write();
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::flush() {
  if (std::fflush(file_) != 0) fail_to_write();
}

void OutputFile::commit() {
  finish();
  {
    const std::lock_guard lock(unfinished().mutex);
    if (std::rename(temporary_->path().c_str(), target_.c_str()) != 0) fail_to_write();
  }
  temporary_.reset();
  sync_folders();
}

bool OutputFile::commit_as_first() {
  finish();
  const char* const from = temporary_->path().c_str();
  bool first = false;
  {
    const std::lock_guard lock(unfinished().mutex);
    first = link(from, target_.c_str()) == 0;
    // Some disks have no hard links.
    if (!first && errno != EEXIST)
      first = renameat2(AT_FDCWD, from, AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0;
  }
  if (!first && errno != EEXIST) fail_to_write();
  if (first) sync_folders();
  return first;  // the destructor removes the temporary name
}

void OutputFile::finish() {
  // Closing flushes buffers, so a full disk may surface here.
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail_to_write();
  // A power failure must not leave the new name without its data, so the data are stored first.
  if (!is_on_disk(temporary_->path())) fail_to_write();
}

void OutputFile::sync_folders() const {
  for (const fs::path& folder : folders_) is_on_disk(folder);
}

void OutputFile::fail_to_write() const {
  const int reason = errno;
  std::error_code ignored;
  fs::remove(temporary_->path(), ignored);
  throw Error(reason == ENOMEM ? ExitCode::out_of_memory : ExitCode::bad_input,
              fmt::format("cannot write {}: {}", target_, std::strerror(reason)));
}

void write_file(const fs::path& path, std::string_view contents) {
  OutputFile file(path);
  file.write(contents);
  file.commit();
}

}  // namespace binosplat
