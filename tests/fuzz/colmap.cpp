// COLMAP's cameras and images files. The first byte chooses binary or text.

#include "formats/cameras/colmap_records.h"

#include <cmath>

#include "fuzz/input.h"

namespace binosplat::fuzz {

namespace {

void check(const std::vector<ColmapImage>& images) {
  for (const ColmapImage& image : images) {
    demand(std::abs(glm::length(image.rotation) - 1.0) < 1e-9, "a rotation not of unit length");
    for (int c = 0; c < 3; ++c)
      demand(std::isfinite(image.translation[c]), "a translation that is not finite");
  }
}

void check(const std::map<std::uint32_t, ColmapLens>& lenses) {
  for (const auto& [id, lens] : lenses) {
    demand(id == lens.id, "a lens under another's number");
    demand(lens.model != nullptr && lens.parameters.size() >= 2, "a lens of no model");
  }
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  feed(bytes.subspan(1), [&](const std::filesystem::path& path) {
    switch (std::to_integer<int>(bytes[0]) % 4) {
      case 0:
        return check(colmap_lenses(path));
      case 1:
        return check(colmap_lenses_text(path));
      case 2:
        return check(colmap_images(path));
      default:
        return check(colmap_images_text(path));
    }
  });
}

}  // namespace binosplat::fuzz
