#pragma once
// Recognises files by their first bytes.

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
  tiff,
  heif,
  jpeg_xl,
  gzip,
  zip,
  zstd,
  xz,
  glb,
  openusd,
  rad,
  git_lfs,
  html,
  json,
  text,
  unknown
};

Content content_of(std::span<const std::byte> bytes);

/// Describes a content: "a PNG picture", "a git-LFS pointer, ... (fetch the file with: git lfs pull)".
std::string_view describe(Content content);

/// Quotes a part of a file for an error: at most 40 characters, non-printable and non-ASCII ones as '?'.
std::string quoted(std::string_view text);

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace binosplat
