#pragma once
// Lenses that are not quite pinholes. Pictures are drawn by pinholes only, so what a lens bends is left out,
// and every reader of cameras says so in the same words: DrawnLenses.

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "formats/json_file.h"
#include "scene/camera.h"

namespace binosplat {

/// Where a lens puts what a pinhole of focal length 1 has at a place, both from the principal point. Empty: a
/// pinhole.
using Distortion = std::function<glm::dvec2(const glm::dvec2&)>;

/// Brown's and OpenCV's, with r the distance from the principal point: (1 + k[0] r^2 + k[1] r^4 + ...) /
/// (1 + below[0] r^2 + ...), and the shift of a lens that stands askew. A pinhole where all are 0.
struct BrownDistortion {
  std::array<double, 4> k{};
  std::array<double, 3> below{};
  double p1 = 0, p2 = 0;
};
Distortion distortion_of(const BrownDistortion& brown);

/// How far the farthest of the picture's corners lies from where the pinhole draws it, in px; infinite for a
/// corner that the lens does not reach.
double corner_shift(const Camera& camera, const Distortion& distortion);

/// What the lenses of a file are drawn as. Every camera is noted; finish() reports each kind of lens in one
/// warning.
class DrawnLenses {
 public:
  /// `remedy` follows what is said of lenses that are bent, as ". Undistort ...".
  explicit DrawnLenses(std::string file, std::string remedy = "")
      : file_(std::move(file)), remedy_(std::move(remedy)) {}

  /// A camera that is drawn.
  void add(const Camera& camera, const Distortion& distortion);
  /// One that cannot be, with the whole text of the error that it is where no other can.
  void leave_out(std::string why);
  /// Warns of what was bent or left out. Throws Error where that is all there was.
  void finish() const;

 private:
  std::string file_, remedy_;
  std::size_t drawn_ = 0, left_out_ = 0;
  std::string first_left_out_;
  std::optional<double> farthest_;  // corner, px
  std::string farthest_camera_;
};

/// The value of a key, for a camera or for all of a file.
using KeyOf = std::function<std::optional<JsonValue>(const char*)>;

/// k1 to k6, p1 and p2 as OpenCV has them, or nerfstudio's distortion_params.
Distortion read_distortion(const KeyOf& key);

/// What makes a lens none that a plane holds: the keys camera_model, camera_type and is_fisheye, and those of
/// instant-ngp's lenses. Where one does, "key 'camera_model': ..." for the text of an error; else "".
std::string undrawable_lens(const KeyOf& key);

}  // namespace binosplat
