#pragma once
// Presents a fuzzer's bytes as a file to the readers. For any bytes, each reader must return a valid result
// or throw an Error whose text names the file.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace binosplat::fuzz {

/// Called with each input. NAME.cpp defines the function for fuzz_NAME.
void target(std::span<const std::byte> bytes);

/// Calls `read` with a path for which MappedFile returns `bytes` without a copy, so that the address
/// sanitizer reports the first read outside. `read` may throw Error only; any other exception ends the
/// process.
void feed(std::span<const std::byte> bytes, const std::function<void(const std::filesystem::path&)>& read);

/// Like feed(), but the file can also be opened by name.
void feed_file(std::span<const std::byte> bytes,
               const std::function<void(const std::filesystem::path&)>& read);

/// Ends the process, which counts as a finding, unless `sound`.
void demand(bool sound, const char* what);

}  // namespace binosplat::fuzz
