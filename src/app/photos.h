#pragma once
// The photos of a scene's views, for comparisons and fits.

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

/// Photos, and the exposures that pictures get before the comparison.
struct PhotoSource {
  std::string folder;  // of photos; empty: none
  Exposures exposures = {};
};

/// The photos of --photos with the exposures of --exposure. If that is empty, uses the exposure.json beside
/// the model. Logs the source. Throws Error for a file without exposures, and for --exposure without photos.
PhotoSource photo_source(const std::string& scene, const std::string& photos, const std::string& exposure);
PhotoSource photos_of(const MeasuredOptions& options);

/// The exposure of a view's picture. Warns once if the file lacks the view.
glm::mat4x3 exposure_of(const Exposures& exposures, const std::string& view);

/// Reads a view's photo as RGB. Grey becomes three equal channels; a photo with alpha is put before
/// `background`, which is logged once. Throws Error unless it has the camera's size.
Image load_view_photo(const std::filesystem::path& file, const Camera& camera,
                      const glm::vec3& background = glm::vec3(0.0f));

/// Throws Error if there are photos but their cameras cannot be used.
void check_cameras_of(const std::string& photos, const CameraList& list);

/// Throws Error as load_view_photo() does, but reads only headers and ends of files (picture_size), so it is
/// quick. Accepts views without a photo. Checks nothing without a folder.
void check_photos(const std::string& photos, std::span<const Camera> cameras);

/// Finds photos for a fit, with inverted exposures, so that one model fits all of them. Empty without a
/// folder. The finder throws Error for an exposure that cannot be inverted.
compact::PhotoOf photo_finder(const PhotoSource& photos);

/// The allowed loss: --max-drop against photos, or --quality against exact pictures.
struct TargetOptions {
  std::optional<double> max_drop, quality;  // dB

  CalibrationTarget target() const;
};

/// Throws Error unless exactly one target is set, with what it needs. `command` needs `what`, as in "a
/// bound".
void check_target(const std::string& command, const std::string& what, const TargetOptions& target,
                  const MeasuredOptions& options);

/// A camera, with its photo and exposure if there is a folder. Throws Error if its photo is missing.
lab::CalibrationView with_photo(const PhotoSource& photos, const Camera& camera);

/// A choice of views.
struct ViewChoice {
  std::vector<std::string> views;         // by name
  std::size_t wanted = 0;                 // if none is named: this many, evenly spaced
  std::vector<std::string> without = {};  // excludes these names
};

/// The cameras of a choice. With a folder of photos, unnamed choices take only cameras that have one.
std::vector<Camera> photographed_cameras(const ViewChoice& choice, const std::string& photos,
                                         const Lens& lens, const CameraList& list);

/// The folder of --photos; photos_beside finds the one beside the cameras. Throws Error if there is none.
std::string photos_folder(const std::string& asked, const CameraList& list);

/// Test views, which calibrations must not use, and training views, by name.
struct HeldOut {
  std::vector<std::string> test, training;
  std::string how;  // how they were separated, for the log
};

/// Every `every`th view in the order of names is a test view, as is usual in the field. Without a number:
/// every 8th, or the first views of a cameras.json of INRIA's trainer. That file lists test views by name,
/// then training views by name.
HeldOut hold_out(const CameraList& list, const std::optional<int>& every);

/// Adds --test-every.
void add_hold_out_option(CLI::App& sub, std::optional<int>& every);

/// The cameras of a choice, each with its photo if there is a folder.
std::vector<lab::CalibrationView> photographed_views(const ViewChoice& choice, const PhotoSource& photos,
                                                     const Lens& lens, const CameraList& list);

}  // namespace binosplat::app
