#include "formats/colmap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "formats/colmap_records.h"
#include "formats/lens.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

[[noreturn]] void fail_lens(const fs::path& file, const ColmapLens& lens) {
  const std::string_view name = colmap_model_name(lens.model);
  if (name.empty())
    fail("{}: camera {} has the model {}, which is not known (0 to 17 are)", file.string(), lens.id,
         lens.model);
  fail(
      "{}: camera {} has a lens of the model {}; only SIMPLE_PINHOLE and PINHOLE can be drawn. Undistort "
      "pictures and "
      "cameras: colmap image_undistorter --image_path IMAGES --input_path {} --output_path OUT",
      file.string(), lens.id, name, file.parent_path().string());
}

Camera camera_of(const fs::path& file, const ColmapImage& image, const ColmapLens& lens) {
  constexpr int simple_pinhole = 0, pinhole = 1;
  if (lens.model != simple_pinhole && lens.model != pinhole) fail_lens(file, lens);
  const auto pixels = [](std::uint64_t n) {
    return static_cast<int>(std::min<std::uint64_t>(n, std::numeric_limits<int>::max()));
  };
  Camera camera;
  camera.name = image.name;
  camera.width = pixels(lens.width);
  camera.height = pixels(lens.height);
  const std::size_t second = lens.model == pinhole ? 1 : 0;
  camera.fx = lens.parameters[0];
  camera.fy = lens.parameters[second];
  camera.cx = lens.parameters[second + 1];
  camera.cy = lens.parameters[second + 2];
  check_lens(fmt::format("{}: camera {}", file.string(), lens.id), camera);

  // World to camera is R(q) p + t: the rows of R are the camera's axes.
  const glm::dvec4& q = image.rotation;
  const double w = q.x, x = q.y, y = q.z, z = q.w;
  camera.rotation = glm::dmat3({1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)});
  camera.position = -(camera.rotation * image.translation);
  return camera;
}

}  // namespace

bool is_colmap(const fs::path& folder) {
  return (is_there(folder / "cameras.bin") && is_there(folder / "images.bin")) ||
         (is_there(folder / "cameras.txt") && is_there(folder / "images.txt"));
}

std::vector<Camera> load_colmap(const fs::path& folder) {
  const bool binary = is_there(folder / "cameras.bin") && is_there(folder / "images.bin");
  const fs::path lens_file = folder / (binary ? "cameras.bin" : "cameras.txt");
  const fs::path image_file = folder / (binary ? "images.bin" : "images.txt");
  const std::map<std::uint32_t, ColmapLens> lenses =
      binary ? colmap_lenses(lens_file) : colmap_lenses_text(lens_file);
  std::vector<Camera> cameras;
  for (const ColmapImage& image : binary ? colmap_images(image_file) : colmap_images_text(image_file)) {
    const auto lens = lenses.find(image.lens);
    if (lens == lenses.end()) {
      fail("{}: image {} was taken with camera {}, which {} does not have", image_file.string(), image.id,
           image.lens, lens_file.string());
    }
    cameras.push_back(camera_of(lens_file, image, lens->second));
  }
  if (cameras.empty()) fail("{} holds no images", image_file.string());
  std::sort(cameras.begin(), cameras.end(), [](const Camera& a, const Camera& b) { return a.name < b.name; });
  return cameras;
}

}  // namespace binosplat
