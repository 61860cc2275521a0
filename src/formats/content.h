#pragma once
// What a file is, by its first bytes.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace binosplat {

enum class Content {
  empty,
  ply,
  spz,
  png,
  jpeg,
  exr,
  webp,
  gzip,
  zip,
  zstd,
  xz,
  glb,
  usda,
  usdc,
  git_lfs,
  html,
  json,
  text,
  unknown
};

Content content_of(std::span<const std::byte> bytes);

/// For the end of an error's text: "a PNG picture", "a git-LFS pointer, ... (fetch the file with: git lfs
/// pull)".
std::string_view describe(Content content);

/// A piece of a file for the text of an error: 40 characters at most, what is not printable ASCII as '?'.
std::string quoted(std::string_view text);

/// The bytes as characters.
inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace binosplat
