#pragma once
// How a fuzzer's bytes become a file for the readers, and what every reader owes whatever the bytes are: a
// sound result, or an Error whose text names the file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace binosplat::fuzz {

/// Calls `read` with a path under which MappedFile finds `bytes`, without a copy, so that a reader that
/// leaves them is caught at the first byte. Error is the only exception that it may throw; whatever else
/// leaves `read` ends the process.
void feed(std::span<const std::byte> bytes, const std::function<void(const std::filesystem::path&)>& read);

/// The same, and the file can be opened by name as well.
void feed_file(std::span<const std::byte> bytes,
               const std::function<void(const std::filesystem::path&)>& read);

/// Ends the process as a finding unless `sound`.
void demand(bool sound, const char* what);

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const std::byte*>(data), size};
}

}  // namespace binosplat::fuzz
