#include "formats/colmap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "formats/colmap_records.h"
#include "formats/distortion.h"
#include "formats/lens.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// A lens that is a pinhole with distortion (src/colmap/sensor/models.h in COLMAP). Its first parameters are
/// the focal lengths and the principal point, and the others give the distortion. Even without distortion a
/// fisheye is no such lens: its distances from the centre are proportional to angles.
struct PlaneLens {
  std::size_t focal_lengths;
  Distortion distortion;
};

/// Fitzgibbon's division model: a pinhole shows a point at u / (1 + k u^2) if this lens shows it at u.
Distortion division(double k) {
  if (k == 0.0) return {};
  return [k](const glm::dvec2& at) { return 2.0 / (1.0 + std::sqrt(1.0 - 4.0 * k * glm::dot(at, at))) * at; };
}

/// Devernay and Faugeras: the distance from the centre is proportional to the angle.
Distortion field_of_view(double omega) {
  if (omega == 0.0) return {};
  return [omega](const glm::dvec2& at) {
    const double r = glm::length(at);
    return r > 0.0 ? std::atan(2.0 * r * std::tan(0.5 * omega)) / (r * omega) * at : at;
  };
}

/// Khomutenko's enhanced unified model.
Distortion unified(double alpha, double beta) {
  if (alpha == 0.0 || beta == 0.0) return {};
  return [alpha, beta](const glm::dvec2& at) {
    return at / (alpha * std::sqrt(beta * glm::dot(at, at) + 1.0) + 1.0 - alpha);
  };
}

std::optional<PlaneLens> plane_lens(const ColmapLens& lens) {
  const std::string_view name = colmap_model_name(lens.model);
  const auto last = [&](std::size_t from_end) { return lens.parameters[lens.parameters.size() - from_end]; };
  if (name == "SIMPLE_PINHOLE") return PlaneLens{1, {}};
  if (name == "PINHOLE") return PlaneLens{2, {}};
  if (name == "SIMPLE_RADIAL") return PlaneLens{1, distortion_of({.k = {last(1)}})};
  if (name == "RADIAL") return PlaneLens{1, distortion_of({.k = {last(2), last(1)}})};
  if (name == "OPENCV")
    return PlaneLens{2, distortion_of({.k = {last(4), last(3)}, .p1 = last(2), .p2 = last(1)})};
  if (name == "FULL_OPENCV")
    return PlaneLens{2, distortion_of({.k = {last(8), last(7), last(4)},
                                       .below = {last(3), last(2), last(1)},
                                       .p1 = last(6),
                                       .p2 = last(5)})};
  if (name == "FOV") return PlaneLens{2, field_of_view(last(1))};
  if (name == "SIMPLE_DIVISION") return PlaneLens{1, division(last(1))};
  if (name == "DIVISION") return PlaneLens{2, division(last(1))};
  if (name == "EUCM") return PlaneLens{2, unified(last(2), last(1))};
  return std::nullopt;
}

Camera camera_of(const fs::path& file, const ColmapImage& image, const ColmapLens& lens,
                 std::size_t focal_lengths) {
  const std::string where = fmt::format("{}: camera {}", file.string(), lens.id);
  if (!std::ranges::all_of(lens.parameters, [](double value) { return std::isfinite(value); }))
    fail("{}: its parameters must be finite", where);
  const auto pixels = [](std::uint64_t n) {
    return static_cast<int>(std::min<std::uint64_t>(n, std::numeric_limits<int>::max()));
  };
  Camera camera;
  camera.name = image.name;
  camera.width = pixels(lens.width);
  camera.height = pixels(lens.height);
  const std::size_t second = focal_lengths - 1;
  camera.fx = lens.parameters[0];
  camera.fy = lens.parameters[second];
  camera.cx = lens.parameters[second + 1];
  camera.cy = lens.parameters[second + 2];
  check_lens(where, camera);

  // World to camera is R(q) p + t, so the rows of R are the camera's axes.
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
  const std::string undistorting = fmt::format(
      "colmap image_undistorter --image_path IMAGES --input_path {} --output_path OUT", folder.string());
  std::vector<Camera> cameras;
  LensReport lens_report(lens_file.string(), ". Undistort pictures and cameras: " + undistorting);
  for (const ColmapImage& image : binary ? colmap_images(image_file) : colmap_images_text(image_file)) {
    const auto lens = lenses.find(image.lens);
    if (lens == lenses.end()) {
      fail("{}: image {} refers to camera {}, which {} does not have", image_file.string(), image.id,
           image.lens, lens_file.string());
    }
    const auto plane = plane_lens(lens->second);
    if (!plane) {
      lens_report.add_skipped(
          fmt::format("{}: camera {} has a lens of the model {}, which is not a pinhole. Undistort pictures "
                      "and cameras: {}",
                      lens_file.string(), lens->first, colmap_model_name(lens->second.model), undistorting));
      continue;
    }
    cameras.push_back(camera_of(lens_file, image, lens->second, plane->focal_lengths));
    lens_report.add(cameras.back(), plane->distortion);
  }
  lens_report.report();
  if (cameras.empty()) fail("{} holds no images", image_file.string());
  std::ranges::stable_sort(cameras, {}, &Camera::name);
  return cameras;
}

}  // namespace binosplat
