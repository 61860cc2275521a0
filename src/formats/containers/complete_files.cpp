#include "formats/containers/complete_files.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>

#include "base/error.h"
#include "formats/containers/bytes.h"
#include "formats/containers/opened_file.h"
#include "formats/models/files_of_model.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

/// Checks the size in the header, which is the number of bytes after it.
bool is_whole_webp(std::span<const std::byte> bytes) {
  return bytes.size() > 12 && load_number<std::uint32_t>(&bytes[4]) <= bytes.size() - 8;
}

}  // namespace

bool is_complete(const fs::path& path) {
  try {
    const OpenedFile file(path);
    switch (file.content) {
      case Content::png:
        return is_whole_png(file.bytes(), true);
      case Content::exr:
        return is_whole_exr(path, file.bytes());
      case Content::webp:
        return is_whole_webp(file.bytes());
      default:
        return nlohmann::json::accept(as_text(file.bytes()));
    }
  } catch (const Error&) {
    return false;
  }
}

bool is_whole_sog(const fs::path& meta) {
  try {
    const OpenedFile file(meta);
    return file.json().is_object() && std::ranges::all_of(pictures_of_sog(meta, file.json()), is_complete);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace binosplat
