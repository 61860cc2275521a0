#include "base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

#include "base/error.h"

namespace binosplat {

namespace {

/// A mapping. Its members are atomic, because the signal handler reads them and cannot lock.
struct Mapping {
  std::atomic<const std::byte*> data = nullptr;  // null: the entry is free
  std::atomic<std::size_t> size = 0;
  std::atomic<const char*> name = nullptr;
};

/// There are more entries than files mapped at once. The handler cannot name a file without an entry.
std::array<Mapping, 256> mappings;
static_assert(std::atomic<const char*>::is_always_lock_free && std::atomic<std::size_t>::is_always_lock_free);

void remember(const std::byte* data, std::size_t size, const char* name) {
  for (Mapping& mapping : mappings) {
    const std::byte* none = nullptr;
    if (!mapping.data.compare_exchange_strong(none, data)) continue;
    mapping.name = name;
    mapping.size = size;
    return;
  }
}

void forget(const std::byte* data) {
  for (Mapping& mapping : mappings) {
    if (mapping.data != data) continue;
    mapping.size = 0;
    mapping.data = nullptr;
    return;
  }
}

/// Calls only async-signal-safe functions (signal-safety(7)).
void on_cut_file(int, siginfo_t* info, void*) {
  const auto say = [](const char* text) {
    static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text)));
  };
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (const Mapping& mapping : mappings) {
    const auto from = reinterpret_cast<std::uintptr_t>(mapping.data.load());
    if (from == 0 || at < from || at - from >= mapping.size) continue;
    say("binosplat: ");
    say(mapping.name);
    say(" was cut short while it was read: start again, and do not change it during the run\n");
    _exit(static_cast<int>(ExitCode::bad_input));
  }
  std::signal(SIGBUS, SIG_DFL);  // not in a mapped file: the repeated fault ends the process
}

}  // namespace

void end_cleanly_on_cut_files() {
  struct sigaction action = {};
  action.sa_sigaction = on_cut_file;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

void fail_to_read(const std::filesystem::path& path, int reason) {
  if (reason == ENOMEM)
    throw Error(ExitCode::out_of_memory, fmt::format("out of memory: cannot read {}", path.string()));
  const bool address = path.string().find("://") != std::string::npos;
  fail("cannot read {}: {}", path.string(),
       address ? "it is a URL; download the file first" : std::strerror(reason));
}

MappedFile::MappedFile(const std::filesystem::path& path) : name_(path.string()) {
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
      remember(data_, size_, name_.c_str());
    }
  }
  close(file);
  if (reason != 0) fail_to_read(path, reason);
  if (S_ISDIR(status.st_mode)) fail("cannot read {}: it is a folder; name a file in it", path.string());
  if (!regular) fail("cannot read {}: it is a device or a pipe; name a file", path.string());
}

MappedFile::~MappedFile() {
  if (data_ == nullptr) return;
  forget(data_);
  munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace binosplat
