#pragma once
// The photos that a model was trained on, by the names of its views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/cli.h"
#include "app/measured_options.h"
#include "app/shots.h"
#include "base/image.h"
#include "compact/refit.h"
#include "formats/exposures.h"
#include "lab/calibrate.h"

namespace binosplat::app {

/// What views are compared with, and what becomes of their pictures before that.
struct PhotoSource {
  std::string folder;  // of photos; empty: none
  Exposures exposures = {};
};

/// The photos of --photos, and the exposures of --exposure: of a file, none, or where the option is empty
/// those of the exposure.json beside the model. Says whose are taken. Throws Error for a file that holds
/// none, and for --exposure without photos.
PhotoSource photo_source(const std::string& scene, const std::string& photos, const std::string& exposure);
PhotoSource photos_of(const MeasuredOptions& options);

/// The exposure of a view's picture; says once where there are exposures, and none for this view.
glm::mat4x3 exposure_of(const Exposures& exposures, const std::string& view);

/// Reads a view's photo as RGB: grey in three equal channels, and what has alpha before the background of the
/// pictures that it is compared with, which is said once. Throws Error unless it has the camera's size.
Image load_view_photo(const std::filesystem::path& file, const Camera& camera,
                      const glm::vec3& background = glm::vec3(0.0f));

/// Throws Error where there are photos, and the cameras that they should be of cannot be used.
void check_cameras_of(const std::string& photos, const CameraList& list);

/// Throws Error as load_view_photo() does, but as far as the headers and ends of the cameras' photos tell
/// (picture_size): quick, before a model is read. Views without a photo are no error here; no folder, none to
/// check.
void check_photos(const std::string& photos, std::span<const Camera> cameras);

/// The photos of a folder for a fit, with their exposures taken back, so that a model fits all of them at
/// once; none where there is no folder. Throws Error, when asked for a photo, for an exposure that cannot be
/// taken back.
compact::PhotoOf photo_finder(const PhotoSource& photos);

/// What pictures may lose: --max-drop against the photos, or --quality against the exact pictures.
struct TargetOptions {
  std::optional<double> max_drop, quality;  // dB

  CalibrationTarget target() const;
};

/// Throws Error unless there is one of the two, with what it needs; `command` needs `what`, as in "a bound".
void check_target(const std::string& command, const std::string& what, const TargetOptions& target,
                  const MeasuredOptions& options);

/// A camera; with a folder of photos its photo and exposure, too. Throws Error where there is no photo.
lab::CalibrationView with_photo(const PhotoSource& photos, const Camera& camera);

/// Which views of a scene are taken.
struct ViewChoice {
  std::vector<std::string> views;         // by name
  std::size_t wanted = 0;                 // of all, evenly spread, where none is named
  std::vector<std::string> without = {};  // those called so are left out
};

/// The cameras of a choice: with a folder of photos only those count, of all, that have one.
std::vector<Camera> photographed_cameras(const ViewChoice& choice, const std::string& photos,
                                         const Lens& lens, const CameraList& list);

/// The folder of photos that --photos names, or with photos_beside the one beside the cameras. Throws Error
/// where there is none.
std::string photos_folder(const std::string& asked, const CameraList& list);

/// Views for tests, which no calibration may see, and all others, by name.
struct HeldOut {
  std::vector<std::string> test, training;
  std::string how;  // they were told apart, for people
};

/// Every `every`th view by the order of names is for tests, as the field holds them out; without a number
/// every 8th, or the views that a cameras.json of INRIA's trainer lists first: it has those for tests by
/// name, and then the others by name.
HeldOut hold_out(const CameraList& list, const std::optional<int>& every);

/// --hold-out.
void add_hold_out_option(CLI::App& sub, std::optional<int>& every);

/// Each with its photo, where there is a folder of them.
std::vector<lab::CalibrationView> photographed_views(const ViewChoice& choice, const PhotoSource& photos,
                                                     const Lens& lens, const CameraList& list);

}  // namespace binosplat::app
