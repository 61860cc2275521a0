#include "fuzz/input.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/parallel.h"

namespace binosplat {

namespace {

std::span<const std::byte> current;

}  // namespace

// Replaces src/base/mapped_file.cpp, which the linker omits because of these definitions. A sanitizer cannot
// see reads past the end of a mapped file within its last page, but it sees those past `current`.
MappedFile::MappedFile(const std::filesystem::path&) : data_(current.data()), size_(current.size()) {}
MappedFile::~MappedFile() { data_ = nullptr; }

namespace fuzz {

namespace {

void feed_as(const std::filesystem::path& path, std::span<const std::byte> bytes,
             const std::function<void(const std::filesystem::path&)>& read) {
  // With one thread, the same input always takes the same path.
  static const auto one_thread = without_helpers();
  current = bytes;
  try {
    read(path);
  } catch (const Error& error) {
    demand(std::string(error.what()).find(path.string()) != std::string::npos,
           "an error that does not name its file");
  }
}

}  // namespace

void feed(std::span<const std::byte> bytes, const std::function<void(const std::filesystem::path&)>& read) {
  feed_as("fuzzed.bin", bytes, read);
}

void feed_file(std::span<const std::byte> bytes,
               const std::function<void(const std::filesystem::path&)>& read) {
  static const int file = memfd_create("fuzzed", MFD_CLOEXEC);
  demand(ftruncate(file, 0) == 0 && pwrite(file, bytes.data(), bytes.size(), 0) == std::ssize(bytes),
         "no file in memory");
  feed_as("/proc/self/fd/" + std::to_string(file), bytes, read);
}

void demand(bool sound, const char* what) {
  if (sound) return;
  std::fprintf(stderr, "fuzzing found: %s\n", what);
  std::abort();
}

}  // namespace fuzz
}  // namespace binosplat

// libFuzzer defines the name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  binosplat::fuzz::target({reinterpret_cast<const std::byte*>(data), size});
  return 0;
}
