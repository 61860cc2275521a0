#pragma once
// How a fuzzer's bytes become a file for the readers, and what every reader owes whatever the bytes are: a
// sound result, or an Error whose text names the file.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace binosplat::fuzz {

/// What a fuzzer does with each input; NAME.cpp defines it.
void target(std::span<const std::byte> bytes);

/// Calls `read` with a path under which MappedFile finds `bytes`, without a copy, so that a reader that
/// leaves them is caught at the first byte. Error is the only exception that it may throw; whatever else
/// leaves `read` ends the process.
void feed(std::span<const std::byte> bytes, const std::function<void(const std::filesystem::path&)>& read);

/// The same, and the file can be opened by name as well.
void feed_file(std::span<const std::byte> bytes,
               const std::function<void(const std::filesystem::path&)>& read);

/// Ends the process as a finding unless `sound`.
void demand(bool sound, const char* what);

}  // namespace binosplat::fuzz
