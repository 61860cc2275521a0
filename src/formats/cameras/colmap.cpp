#include "formats/cameras/colmap.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <span>

#include "base/error.h"
#include "base/path_questions.h"
#include "formats/cameras/colmap_records.h"
#include "formats/cameras/distortion.h"
#include "formats/cameras/lens.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

Camera camera_of(const fs::path& file, const ColmapImage& image, const ColmapLens& lens) {
  const std::string where = fmt::format("{}: camera {}", file, lens.id);
  const auto pixels = [](std::uint64_t n) {
    return static_cast<int>(std::min<std::uint64_t>(n, std::numeric_limits<int>::max()));
  };
  Camera camera;
  camera.name = image.name;
  camera.width = pixels(lens.width);
  camera.height = pixels(lens.height);
  const std::size_t second = lens.model->focal_lengths - 1;
  camera.fx = lens.parameters[0];
  camera.fy = lens.parameters[second];
  camera.cx = lens.parameters[second + 1];
  camera.cy = lens.parameters[second + 2];
  check_lens(where, camera);

  // World to camera is R(q) p + t, so the rows of R are the camera's axes.
  const glm::dvec4& q = image.rotation;
  camera.rotation = glm::transpose(glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w)));
  camera.position = -(camera.rotation * image.translation);
  return camera;
}

}  // namespace

bool is_colmap(const fs::path& folder) {
  return (is_file(folder / "cameras.bin") && is_file(folder / "images.bin")) ||
         (is_file(folder / "cameras.txt") && is_file(folder / "images.txt"));
}

std::vector<Camera> load_colmap(const fs::path& folder) {
  const bool binary = is_file(folder / "cameras.bin") && is_file(folder / "images.bin");
  const fs::path lens_file = folder / (binary ? "cameras.bin" : "cameras.txt");
  const fs::path image_file = folder / (binary ? "images.bin" : "images.txt");
  const std::map<std::uint32_t, ColmapLens> lenses =
      binary ? colmap_lenses(lens_file) : colmap_lenses_text(lens_file);
  const std::string undistorting =
      fmt::format("colmap image_undistorter --image_path IMAGES --input_path {} --output_path OUT", folder);
  std::vector<Camera> cameras;
  LensReport lens_report(lens_file.string(), ". Undistort pictures and cameras: " + undistorting);
  for (const ColmapImage& image : binary ? colmap_images(image_file) : colmap_images_text(image_file)) {
    const auto lens = lenses.find(image.lens);
    if (lens == lenses.end()) {
      fail("{}: image {} refers to camera {}, which {} does not have", image_file, image.id, image.lens,
           lens_file);
    }
    const ColmapModel& model = *lens->second.model;
    if (model.focal_lengths == 0) {
      lens_report.add_skipped(
          fmt::format("{}: camera {} has a lens of the model {}, which is not a pinhole. Undistort pictures "
                      "and cameras: {}",
                      lens_file, lens->first, model.name, undistorting));
      continue;
    }
    if (!std::ranges::all_of(lens->second.parameters, [](double value) { return std::isfinite(value); })) {
      lens_report.add_skipped(
          fmt::format("{}: camera {}: its parameters must be finite", lens_file, lens->first));
      continue;
    }
    cameras.push_back(camera_of(lens_file, image, lens->second));
    const auto distortion = std::span(lens->second.parameters).subspan(model.focal_lengths + 2);
    lens_report.add(std::ranges::any_of(distortion, [](double value) { return value != 0.0; }));
  }
  lens_report.report();
  if (cameras.empty()) fail("{} holds no images", image_file);
  std::ranges::stable_sort(cameras, {}, &Camera::name);
  return cameras;
}

}  // namespace binosplat
