#include "app/photos.h"

#include "base/error.h"
#include "formats/image_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

std::optional<fs::path> find_view_photo(const fs::path& folder, const Shot& shot) {
  if (fs::is_regular_file(folder / shot.name)) return folder / shot.name;
  for (const std::string& name : {shot.name, shot.stem}) {
    for (const char* ending : {".jpg", ".jpeg", ".png", ".JPG", ".JPEG", ".PNG"}) {
      if (fs::is_regular_file(folder / (name + ending))) return folder / (name + ending);
    }
  }
  return std::nullopt;
}

Image load_view_photo(const fs::path& file, const Camera& camera) {
  Image photo = load_image(file);
  if (photo.channels != 3 || photo.width != camera.width || photo.height != camera.height)
    fail("photo {} has {} x {} px and {} channels; its view has {} x {} px and 3: draw it in its own size",
         file.string(), photo.width, photo.height, photo.channels, camera.width, camera.height);
  return photo;
}

}  // namespace binosplat::app
