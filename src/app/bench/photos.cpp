#include "app/bench/photos.h"
#include "app/options/checks.h"

#include <algorithm>
#include <atomic>

#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "base/statistics.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "lab/bench_views.h"
#include "measure/comparison.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

void check_size(const fs::path& file, const glm::ivec2& size, const Camera& camera) {
  if (size != glm::ivec2(camera.width, camera.height))
    fail("photo {} has {} x {} px, and its view {} x {} px: draw it in its own size", file.string(), size.x,
         size.y, camera.width, camera.height);
}

}  // namespace

PhotoSource photo_source(const std::string& scene, const std::string& photos, const std::string& exposure) {
  if (photos.empty()) {
    if (!exposure.empty()) fail("--exposure {} has an effect only with --photos", exposure);
    return {};
  }
  PhotoSource source{photos};
  if (exposure == no_exposure || (exposure.empty() && is_built_in(scene))) return source;
  const auto file = exposure.empty() ? find_exposures(scene) : fs::path(exposure);
  if (!file) return source;
  protect_input(*file);
  try {
    source.exposures = Exposures(*file);
  } catch (const Error& error) {
    fail("{}; --exposure none compares without it", error.what());
  }
  if (source.exposures.changes_any()) {
    log_info(
        "{}: each picture gets the exposure that was trained for its photo before the two are compared "
        "(--exposure none: as it is drawn)",
        file->string());
  }
  return source;
}

PhotoSource photos_of(const Options& o) { return photo_source(o.scene.name, o.photos, o.exposure); }

glm::mat4x3 exposure_of(const Exposures& exposures, const std::string& view) {
  static std::atomic<bool> said = false;
  if (exposures.changes_any() && !exposures.has(view) && !said.exchange(true)) {
    log_warning("{} has no exposure of view {}: it is compared as it is drawn, and so are others like it",
                exposures.file().string(), view);
  }
  return exposures.of(view);
}

Image load_view_photo(const fs::path& file, const Camera& camera, const glm::vec3& background) {
  Image photo = load_image(file);
  check_size(file, {photo.width, photo.height}, camera);
  static std::atomic<bool> said = false;
  if (measure::is_see_through(photo) && !said.exchange(true)) {
    log_info("photo {} has alpha: photos with alpha are compared over the background {:g},{:g},{:g}",
             file.string(), background.r, background.g, background.b);
  }
  return photo.channels == 3 ? photo : measure::composite_over(background, photo);
}

void check_cameras_of(const std::string& photos, const CameraList& list) {
  if (!photos.empty() && !list.hints.unusable.empty())
    fail("--photos {}: the cameras beside the model cannot be used: {}; name their file with --cameras",
         photos, list.hints.unusable);
}

void check_photos(const std::string& photos, std::span<const Camera> cameras) {
  if (photos.empty()) return;
  for (const Camera& camera : cameras) {
    const auto file = find_view_photo(photos, camera);
    if (file) check_size(*file, picture_size(*file), camera);
  }
}

compact::PhotoOf photo_finder(const PhotoSource& photos) {
  if (photos.folder.empty()) return {};
  return [photos](const Camera& camera) -> std::optional<Image> {
    const auto file = find_view_photo(photos.folder, camera);
    if (!file) return std::nullopt;
    const auto back = inverse_exposure(exposure_of(photos.exposures, camera.name));
    if (!back)
      fail(
          "{}: the exposure of {} is singular (it mixes its colours into fewer than three), so nothing can "
          "be fitted to its photo; remove it, or give --exposure none",
          photos.exposures.file().string(), camera.name);
    return exposed(load_view_photo(*file, camera), *back);
  };
}

void check_target(const std::string& command, const std::string& what, const TargetOptions& target,
                  const Options& options) {
  check(options.scene);
  if (target.max_drop.has_value() == target.quality.has_value())
    fail("{} needs {}: --photos DIR --max-drop DB, or --quality DB against the exact pictures", command,
         what);
  if (target.max_drop.has_value() != !options.photos.empty())
    fail("--max-drop and --photos go together: a drop in dB needs photos");
  if (options.camera.lens.size && target.max_drop)
    fail("--size with --photos: a drop is measured in the photos' own size");
}

adagscale::CalibrationView with_photo(const PhotoSource& photos, const Camera& camera) {
  adagscale::CalibrationView view{camera, {}};
  if (photos.folder.empty()) return view;
  const auto file = find_view_photo(photos.folder, camera);
  if (!file) fail("--photos {}: there is no photo of view {}", photos.folder, camera.name);
  view.photo = load_view_photo(*file, camera);
  view.exposure = exposure_of(photos.exposures, camera.name);
  return view;
}

std::vector<Camera> photographed_cameras(const ViewChoice& choice, const std::string& photos,
                                         const Lens& lens, const CameraList& list) {
  const std::vector<std::string> without = view_names(choice.without, list);
  const bool named = !choice.views.empty();
  check_cameras_of(photos, list);
  if (!photos.empty()) check_photos_unique(photos, list.cameras);
  std::vector<Camera> cameras = chosen_cameras(choice.views, lens, list);
  std::erase_if(cameras, [&](const Camera& camera) {
    return std::find(without.begin(), without.end(), camera.name) != without.end() ||
           (!photos.empty() && !named && !find_view_photo(photos, camera));
  });
  if (!photos.empty() && cameras.empty() && without.empty())
    fail("--photos {}: there is no photo of any view", photos);
  if (named) return cameras;
  std::vector<Camera> spread;
  for (const std::size_t i : spread_evenly(cameras.size(), choice.wanted)) spread.push_back(cameras[i]);
  return spread;
}

std::string photos_folder(const std::string& asked, const CameraList& list) {
  check_cameras_of(asked, list);
  if (asked != photos_beside) return asked;
  const auto found = list.listed ? find_photos(list.source) : std::nullopt;
  if (!found)
    fail("--photos {}: there is no folder of photos beside the cameras of {}", photos_beside, list.source);
  return found->string();
}

ViewChoice training_choice(const CameraList& list, std::size_t count, const std::optional<int>& every) {
  ViewChoice choice{{}, count};
  if (!list.path && list.listed && (every || list.cameras.size() >= 8))
    choice.without = test_split(list, every).test;
  return choice;
}

std::vector<adagscale::CalibrationView> photographed_views(const ViewChoice& choice,
                                                           const PhotoSource& photos, const Lens& lens,
                                                           const CameraList& list) {
  std::vector<adagscale::CalibrationView> views;
  for (const Camera& camera : photographed_cameras(choice, photos.folder, lens, list))
    views.push_back(with_photo(photos, camera));
  return views;
}

}  // namespace binosplat::app
