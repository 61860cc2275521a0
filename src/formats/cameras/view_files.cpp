#include "formats/cameras/view_files.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/path_questions.h"
#include "base/text.h"

namespace binosplat {

namespace fs = std::filesystem;

namespace {

/// Endings of photos, readable ones first. Errors of load_image() name what the others are.
constexpr std::string_view photo_endings[] = {
    ".jpg",  ".JPG",  ".Jpg",  ".jpeg", ".JPEG", ".Jpeg", ".png",  ".PNG",  ".Png",  ".exr",  ".EXR",
    ".Exr",  ".webp", ".WEBP", ".Webp", ".tif",  ".TIF",  ".Tif",  ".tiff", ".TIFF", ".Tiff", ".heic",
    ".HEIC", ".Heic", ".heif", ".HEIF", ".Heif", ".avif", ".AVIF", ".Avif", ".jxl",  ".JXL",  ".Jxl"};

std::string without_ending(std::string name) {
  const std::string lower = lowered(name);
  for (const std::string_view ending : photo_endings) {
    if (lower.size() > ending.size() && lower.ends_with(ending)) name.resize(name.size() - ending.size());
  }
  return name;
}

/// Splits a name into folders and file, and omits "..".
fs::path parts_of(std::string name) {
  std::ranges::replace(name, '\\', '/');
  fs::path parts;
  for (const fs::path& part : fs::path(name).lexically_normal().relative_path()) {
    if (part != "..") parts /= part;
  }
  return parts;
}

bool is_last(const fs::path& parts) { return parts.parent_path().empty(); }

fs::path without_first(const fs::path& parts) { return parts.lexically_relative(*parts.begin()); }

/// Returns a picture of this name, with or without an ending.
std::optional<fs::path> picture_at(const fs::path& name) {
  if (is_file(name)) return name;
  for (const std::string_view ending : photo_endings) {
    fs::path path = name;
    if (is_file(path += ending)) return path;
  }
  return std::nullopt;
}

/// Returns the picture at a path below `folder`. The path `parts` may begin with the last parts of `folder`.
std::optional<fs::path> picture_in(const fs::path& folder, const fs::path& parts) {
  const fs::path whole = fs::absolute(folder / ".").lexically_normal().parent_path();
  for (fs::path above = whole;; above = above.parent_path()) {
    const fs::path inside = (above / parts).lexically_relative(whole);
    if (!inside.empty() && *inside.begin() != "..") {
      if (auto picture = picture_at(folder / inside)) return picture;
    }
    if (!above.has_relative_path()) return std::nullopt;
  }
}

}  // namespace

std::string stem_of(std::string name) {
  name = without_ending(std::move(name));
  std::ranges::replace_if(
      name, [](char c) { return c == '/' || c == '\\'; }, '_');
  if (name.empty()) name = "view";
  if (name[0] == '.') name[0] = '_';
  return name;
}

void set_short_names(std::span<Camera> cameras) {
  std::map<std::string, int> counts;
  const auto count_of = [&](const fs::path& end) -> int& { return counts[without_ending(end.string())]; };
  for (const Camera& camera : cameras) {
    fs::path end = parts_of(camera.name);
    for (++count_of(end); !is_last(end); ++count_of(end)) end = without_first(end);
  }
  for (Camera& camera : cameras) {
    const fs::path whole = parts_of(camera.name);
    fs::path shortest = whole;
    for (fs::path end = whole; !is_last(end);) {
      end = without_first(end);
      if (count_of(end) == 1) shortest = end;
    }
    camera.short_name = shortest.string();
  }
}

std::optional<fs::path> find_view_photo(const fs::path& folder, const std::string& view,
                                        const std::string& short_name) {
  const bool is_whole = fs::path(view).is_absolute();
  if (!is_whole) {
    if (auto photo = picture_at(folder / view)) return photo;
  }
  if (auto photo = picture_at(folder / stem_of(view))) return photo;
  for (fs::path end = parts_of(view);; end = without_first(end)) {
    if (auto photo = picture_in(folder, end)) return photo;
    if (short_name.empty() || end == short_name || is_last(end)) break;
  }
  return is_whole ? picture_at(view) : std::nullopt;
}

void check_photos_unique(const fs::path& folder, std::span<const Camera> views) {
  std::map<fs::path, std::string> taken;
  for (const Camera& view : views) {
    const auto photo = find_view_photo(folder, view);
    if (!photo) continue;
    const auto [other, is_new] = taken.emplace(fs::canonical(*photo), view.name);
    if (!is_new)
      fail("photo {} matches the views '{}' and '{}': name each photo like its view, with the ending", *photo,
           other->second, view.name);
  }
}

}  // namespace binosplat
