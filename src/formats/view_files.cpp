#include "formats/view_files.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "base/error.h"
#include "base/text.h"

namespace binosplat {

namespace fs = std::filesystem;

std::string stem_of(std::string name) {
  const std::string lower = lowered(name);
  for (const std::string_view ending : {".png", ".jpg", ".jpeg"}) {
    if (lower.size() > ending.size() && lower.ends_with(ending)) name.resize(name.size() - ending.size());
  }
  std::replace(name.begin(), name.end(), '/', '_');
  if (name.empty()) name = "view";
  if (name[0] == '.') name[0] = '_';
  return name;
}

std::optional<fs::path> find_view_photo(const fs::path& folder, const std::string& view) {
  if (fs::is_regular_file(folder / view)) return folder / view;
  for (const std::string& name : {view, stem_of(view)}) {
    for (const char* ending : {".jpg", ".jpeg", ".png", ".exr", ".JPG", ".JPEG", ".PNG", ".EXR"}) {
      if (fs::is_regular_file(folder / (name + ending))) return folder / (name + ending);
    }
  }
  return std::nullopt;
}

void check_photos_apart(const fs::path& folder, std::span<const Camera> views) {
  std::map<fs::path, std::string> taken;
  for (const Camera& view : views) {
    const auto photo = find_view_photo(folder, view.name);
    if (!photo) continue;
    const auto [other, is_new] = taken.emplace(fs::canonical(*photo), view.name);
    if (!is_new)
      fail("{} would be the photo of both views '{}' and '{}': name photos as their views, with the ending",
           photo->string(), other->second, view.name);
  }
}

}  // namespace binosplat
