#include "base/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>

#include "base/error.h"
#include "base/inputs.h"

namespace binosplat {

namespace fs = std::filesystem;

OutputFile::OutputFile(const fs::path& path) : target_(path) {
  std::error_code ignored;
  // A rename would replace the link and leave the file that it points to as it was.
  if (fs::is_symlink(target_, ignored)) target_ = fs::weakly_canonical(target_, ignored);
  if (!target_.has_filename()) fail("cannot write '{}': expected the name of a file", path.string());

  const fs::file_status status = fs::status(target_, ignored);
  if (fs::is_directory(status)) fail("cannot write {}: it is a folder; name a file in it", path.string());
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fail("cannot write {}: it is a device or a pipe, which a finished file cannot replace", path.string());
  }
  check_no_input(target_);
  const fs::path folder = target_.parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) {
    fail("cannot write {}: the folder {} cannot be made: {}", path.string(), folder.string(),
         error.message());
  }

  temporary_ = target_;
  // Processes of one number may share a disk, in containers or on several machines.
  temporary_ += fmt::format(".part-{}-{:08x}", getpid(), std::random_device()());
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) fail_to_write();
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail_to_write();
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::flush() {
  if (std::fflush(file_) != 0) fail_to_write();
}

void OutputFile::commit() {
  // What is buffered may find the disk full only now.
  std::FILE* file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail_to_write();
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail_to_write();
  committed_ = true;
}

void OutputFile::fail_to_write() const {
  const int reason = errno;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
  fail("cannot write {}: {}", target_.string(), std::strerror(reason));
}

}  // namespace binosplat
