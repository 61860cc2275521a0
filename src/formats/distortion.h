#pragma once
// Lenses other than pinholes. Only pinholes can be drawn; readers of cameras report distortion by LensReport.

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "formats/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Transforms a point in the picture of a pinhole with focal length 1 to the point at which the lens shows
/// it, both relative to the principal point. The function is empty for a pinhole.
using Distortion = std::function<glm::dvec2(const glm::dvec2&)>;

/// Brown's and OpenCV's distortion. The radial factor at distance r from the principal point is (1 + k[0] r^2
/// + k[1] r^4 + ...) / (1 + below[0] r^2 + ...). p1 and p2 give the tangential distortion of a tilted lens.
/// If all coefficients are zero, the lens is a pinhole.
struct BrownDistortion {
  std::array<double, 4> k{};
  std::array<double, 3> below{};
  double p1 = 0, p2 = 0;
};
Distortion distortion_of(const BrownDistortion& brown);

/// Returns the largest shift of a picture's corner, px; infinite if the lens does not reach a corner.
double corner_shift(const Camera& camera, const Distortion& distortion);

/// Collects the lenses of a file's cameras. report() gives one warning for each kind of unusual lens.
class LensReport {
 public:
  /// `remedy` ends the warning about distorted lenses, as ". Undistort ...".
  explicit LensReport(std::string file, std::string remedy = "")
      : file_(std::move(file)), remedy_(std::move(remedy)) {}

  /// Adds a camera that can be drawn.
  void add(const Camera& camera, const Distortion& distortion);
  /// Adds a camera that cannot be drawn. If no camera can be drawn, the first `why` is the text of the error.
  void add_skipped(std::string why);
  /// Warns about distorted and skipped cameras. Throws Error if all were skipped.
  void report() const;

 private:
  std::string file_, remedy_;
  std::size_t drawn_ = 0, left_out_ = 0;
  std::string first_left_out_;
  std::optional<double> farthest_;  // largest shift of a corner, px
  std::string farthest_camera_;
};

/// Returns a key's value for a camera: the camera's own or, if it has none, the file's.
using KeyOf = std::function<std::optional<JsonValue>(const char*)>;

/// Reads OpenCV's k1 to k6, p1 and p2, or nerfstudio's distortion_params.
Distortion read_distortion(const KeyOf& key);

/// Returns why a lens cannot be drawn, for an error's text: "key 'camera_model': ...". Checks camera_model,
/// camera_type, is_fisheye and the keys of instant-ngp's lenses. For lenses that can be drawn, returns "".
std::string undrawable_lens(const KeyOf& key);

}  // namespace binosplat
