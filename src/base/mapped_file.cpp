#include "base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace binosplat {

void fail_to_read(const std::filesystem::path& path, int reason) {
  if (reason == ENOMEM)
    throw Error(ExitCode::out_of_memory, fmt::format("out of memory: cannot read {}", path));
  const bool address = path.string().find("://") != std::string::npos;
  fail("cannot read {}: {}", path, address ? "it is a URL; download the file first" : std::strerror(reason));
}

MappedFile::MappedFile(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail_to_read(path, errno);
  struct stat status {};
  int reason = fstat(file, &status) == 0 ? 0 : errno;
  const bool regular = S_ISREG(status.st_mode);
  if (regular && status.st_size > 0) {
    void* data = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_PRIVATE, file, 0);
    if (data == MAP_FAILED) {
      reason = errno;
    } else {
      data_ = static_cast<const std::byte*>(data);
      size_ = static_cast<std::size_t>(status.st_size);
    }
  }
  close(file);
  if (reason != 0) fail_to_read(path, reason);
  if (S_ISDIR(status.st_mode)) fail("cannot read {}: it is a folder; name a file in it", path);
  if (!regular) fail("cannot read {}: it is a device or a pipe; name a file", path);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace binosplat
