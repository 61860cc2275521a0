#pragma once
// The photos that a model was trained on, by the names of its views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "app/shots.h"
#include "base/image.h"
#include "lab/calibrate.h"
#include "lab/refit.h"

namespace binosplat::app {

/// Reads a view's photo as RGB: grey in three equal channels, and what has alpha before the background of the
/// pictures that it is compared with, which is said once. Throws Error unless it has the camera's size.
Image load_view_photo(const std::filesystem::path& file, const Camera& camera,
                      const glm::vec3& background = glm::vec3(0.0f));

/// Throws Error as load_view_photo() does, but as far as the headers and ends of the cameras' photos tell
/// (picture_size): quick, before a model is read. Views without a photo are no error here; no folder, none to
/// check.
void check_photos(const std::string& photos, std::span<const Camera> cameras);

/// The photos of a folder for a fit; none where `photos` is empty.
lab::PhotoOf photo_finder(const std::string& photos);

/// What pictures may lose: --max-drop against the photos, or --quality against the exact pictures.
struct TargetOptions {
  std::optional<double> max_drop, quality;  // dB

  lab::CalibrationTarget target() const;
};

/// Throws Error unless there is one of the two, with what it needs; `command` needs `what`, as in "a bound".
void check_target(const std::string& command, const std::string& what, const TargetOptions& target,
                  const MeasuredOptions& options);

/// A camera; with a folder of photos its photo, too. Throws Error where there is none.
lab::CalibrationView with_photo(const std::string& photos, const Camera& camera);

/// Which views of a scene are taken.
struct ViewChoice {
  std::vector<std::string> views;         // by name
  std::size_t wanted = 0;                 // of all, evenly spread, where none is named
  std::vector<std::string> without = {};  // those called so are left out
};

/// The cameras of a choice: with a folder of photos only those count, of all, that have one.
std::vector<Camera> photographed_cameras(const ViewChoice& choice, const std::string& photos,
                                         const Lens& lens, const CameraList& list);

/// Each with its photo, where there is a folder of them.
std::vector<lab::CalibrationView> photographed_views(const ViewChoice& choice, const std::string& photos,
                                                     const Lens& lens, const CameraList& list);

}  // namespace binosplat::app
