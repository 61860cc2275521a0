#include "formats/whole.h"

#include <zlib.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/picture_readers.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

std::uint32_t number_at(std::string_view text, std::size_t at, bool big_endian) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number = number << 8 | static_cast<unsigned char>(text[big_endian ? at + i : at + 3 - i]);
  return number;
}

/// Chunks of LENGTH NAME DATA SUM, behind a signature.
bool is_whole_png(std::string_view text) {
  for (std::size_t at = 8, length = 0; at + 12 <= text.size(); at += 12 + length) {
    length = number_at(text, at, true);
    if (length > text.size() - at - 12) return false;
    const std::string_view summed = text.substr(at + 4, 4 + length);
    if (crc32_z(0, reinterpret_cast<const Bytef*>(summed.data()), summed.size()) !=
        number_at(text, at + 8 + length, true))
      return false;
    if (summed == "IEND") return true;
  }
  return false;
}

bool is_whole_webp(std::string_view text) {
  return text.size() > 12 && number_at(text, 4, false) <= text.size() - 8;
}

/// Whether all files that strings in `json` name are there, whole.
bool names_whole_pictures(const nlohmann::json& json, const fs::path& folder) {
  if (json.is_string()) {
    const auto& name = json.get_ref<const std::string&>();
    return !name.ends_with(".webp") || is_whole(folder / name);
  }
  return !json.is_structured() || std::ranges::all_of(json, [&](const nlohmann::json& item) {
    return names_whole_pictures(item, folder);
  });
}

}  // namespace

bool is_whole(const fs::path& path) {
  try {
    const MappedFile file(path);
    const std::string_view text = as_text(file.bytes());
    switch (content_of(file.bytes())) {
      case Content::png:
        return is_whole_png(text);
      case Content::exr:
        return is_whole_exr(path, file.bytes());
      case Content::webp:
        return is_whole_webp(text);
      default:
        return nlohmann::json::accept(text);
    }
  } catch (const Error&) {
    return false;
  }
}

bool is_whole_sog(const fs::path& meta) {
  try {
    const MappedFile file(meta);
    const auto json = nlohmann::json::parse(as_text(file.bytes()), nullptr, false);
    return json.is_object() && names_whole_pictures(json, meta.parent_path());
  } catch (const Error&) {
    return false;
  }
}

}  // namespace binosplat
