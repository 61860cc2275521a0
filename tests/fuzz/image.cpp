// Pictures: load_image() with PNG, JPEG and OpenEXR, whose libraries are not instrumented.

#include "formats/pictures/image_file.h"
#include "fuzz/input.h"

namespace binosplat::fuzz {

namespace {

/// The guarantees of base/image.h.
void check(const Image& image) {
  demand(image.width >= 1 && image.height >= 1, "a picture without pixels");
  demand(image.channels == 1 || image.channels == 3 || image.channels == 4,
         "an impossible number of channels");
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  demand(image.data.size() == pixels * static_cast<std::size_t>(image.channels), "values missing");
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  feed_file(bytes, [](const std::filesystem::path& path) { check(load_image(path)); });
}

}  // namespace binosplat::fuzz
