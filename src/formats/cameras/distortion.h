#pragma once
// Lenses other than pinholes. Only pinholes can be drawn; readers of cameras report distortion by LensReport.

#include <functional>
#include <optional>
#include <string>

#include "formats/containers/json_file.h"

namespace binosplat {

/// Collects the lenses of a file's cameras. report() gives one warning for each kind of unusual lens.
class LensReport {
 public:
  /// `remedy` ends the warning about distorted lenses, as ". Undistort ...".
  explicit LensReport(std::string file, std::string remedy = "")
      : file_(std::move(file)), remedy_(std::move(remedy)) {}

  /// Adds a camera that can be drawn, though without its distortion.
  void add(bool distorted);
  /// Adds a camera that cannot be drawn. If no camera can be drawn, the first `why` is the text of the error.
  void add_skipped(std::string why);
  /// Warns about distorted and skipped cameras. Throws Error if all were skipped.
  void report() const;

 private:
  std::string file_, remedy_;
  std::size_t drawn_ = 0, left_out_ = 0;
  std::string first_left_out_;
  bool distorted_ = false;
};

/// Returns a key's value for a camera: the camera's own or, if it has none, the file's.
using KeyOf = std::function<std::optional<JsonValue>(const char*)>;

/// Whether any of OpenCV's k1 to k6, p1 and p2, or of nerfstudio's distortion_params is not zero.
bool has_distortion(const KeyOf& key);

/// Returns why a lens cannot be drawn, for an error's text: "key 'camera_model': ...". Checks camera_model,
/// camera_type, is_fisheye and the keys of instant-ngp's lenses. For lenses that can be drawn, returns "".
std::string undrawable_lens(const KeyOf& key);

}  // namespace binosplat
