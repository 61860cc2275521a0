#include "app/photos.h"

#include "base/error.h"
#include "formats/image_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

std::optional<fs::path> find_view_photo(const std::string& folder, const Shot& shot) {
  for (const std::string& name : {shot.name, shot.stem + ".jpg", shot.stem + ".png", shot.stem + ".JPG",
                                  shot.stem + ".jpeg", shot.stem + ".PNG", shot.stem + ".JPEG"}) {
    if (fs::is_regular_file(fs::path(folder) / name)) return fs::path(folder) / name;
  }
  return std::nullopt;
}

Image load_view_photo(const fs::path& file, const Camera& camera) {
  Image photo = load_image(file);
  if (photo.channels != 3 || photo.width != camera.width || photo.height != camera.height)
    fail("photo {} has {} x {} px and {} channels; its view has {} x {} px and 3", file.string(), photo.width,
         photo.height, photo.channels, camera.width, camera.height);
  return photo;
}

}  // namespace binosplat::app
