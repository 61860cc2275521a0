#pragma once
// The photos of a scene's views, for comparisons and fits.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adagscale/calibrate.h"
#include "app/options/options.h"
#include "app/render/shots.h"
#include "base/image.h"
#include "compact/refit.h"
#include "formats/cameras/cameras_file.h"
#include "formats/cameras/view_files.h"
#include "formats/training/exposures.h"

namespace binosplat::app {

/// Photos, and the exposures that pictures get before the comparison.
struct PhotoSource {
  std::string folder;  // of photos; empty: none
  Exposures exposures = {};
};

/// The photos with the exposures of `exposure`, or if empty, of the exposure.json beside the model; logs the
/// source. Throws Error for a file without exposures, and for --exposure without photos.
PhotoSource photo_source(const std::string& scene, const std::string& photos, const std::string& exposure);
PhotoSource photos_of(const Options& options);

/// The exposure of a view's picture. Warns once if the file lacks the view.
glm::mat4x3 exposure_of(const Exposures& exposures, const std::string& view);

/// Reads a view's photo as RGB. Grey becomes three equal channels. A photo with alpha is blended over
/// `background`; the first one is logged. Throws Error unless the photo has the camera's size.
Image load_view_photo(const std::filesystem::path& file, const Camera& camera,
                      const glm::vec3& background = glm::vec3(0.0f));

/// Throws Error if there are photos but their cameras cannot be used.
void check_cameras_of(const std::string& photos, const CameraList& list);

/// Throws Error as load_view_photo() does, but reads only headers and ends of files (picture_size), so it is
/// quick. Accepts views without a photo. Checks nothing without a folder.
void check_photos(const std::string& photos, std::span<const Camera> cameras);

/// Returns a function that reads photos for a fit and removes their exposures, so that one model fits all
/// photos. The function is empty without a folder, and throws Error for an exposure that cannot be inverted.
compact::PhotoOf photo_finder(const PhotoSource& photos);

/// Throws Error unless exactly one target is set. A drop also needs photos, in their own size. The message
/// says that `command` needs `what`, such as "a bound". Checks the scene's options, too.
void check_target(const std::string& command, const std::string& what, const TargetOptions& target,
                  const Options& options);

/// A camera, with its photo and exposure if there is a folder. Throws Error if its photo is missing.
adagscale::CalibrationView with_photo(const PhotoSource& photos, const Camera& camera);

struct ViewChoice {
  std::vector<std::string> views;         // by name
  std::size_t wanted = 0;                 // if none is named: this many, evenly spaced
  std::vector<std::string> without = {};  // excludes these names
};

/// The cameras of a choice. If it names no view and there is a folder of photos, only cameras with a photo.
std::vector<Camera> photographed_cameras(const ViewChoice& choice, const std::string& photos,
                                         const Lens& lens, const CameraList& list);

/// The folder of --photos; photos_beside finds the one beside the cameras. Throws Error if there is none.
std::string photos_folder(const std::string& asked, const CameraList& list);

/// The split of a scene's cameras (formats/cameras/cameras_file.h).
inline TestSplit test_split(const CameraList& list, const std::optional<int>& every) {
  return test_split(list.source, list.cameras, every);
}

/// Chooses up to `count` training views: without test views (`every` as in test_split), unless the list is a
/// path or has fewer than eight cameras, of which one in eight would be the first alone.
ViewChoice training_choice(const CameraList& list, std::size_t count, const std::optional<int>& every);

/// The cameras of a choice, each with its photo if there is a folder.
std::vector<adagscale::CalibrationView> photographed_views(const ViewChoice& choice,
                                                           const PhotoSource& photos, const Lens& lens,
                                                           const CameraList& list);

}  // namespace binosplat::app
