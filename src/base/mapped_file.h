#pragma once
// A file's bytes in memory, read by the system as they are touched.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace binosplat {

/// From now on a file that another program cuts short while it is mapped ends this one with
/// ExitCode::bad_input and a line that names the file, where the system would end it with SIGBUS and say
/// nothing. For `main`: a handler is the whole process's.
void end_cleanly_on_cut_files();

/// Throws the Error of a file that is not there or not readable; `reason` is as errno has it.
[[noreturn]] void fail_to_read(const std::filesystem::path& path, int reason);

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
  std::string name_;
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace binosplat
