#include "app/models/split.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "app/bench/empty_views.h"
#include "app/bench/photos.h"
#include "app/models/load_scene.h"
#include "app/models/model_files.h"
#include "app/open_context.h"
#include "app/options/parse.h"
#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/statistics.h"
#include "lab/bench_views.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

CameraList needed_cameras(const std::string& command, const Options& o) {
  CameraList list = listed_cameras(o.scene, o.camera);
  if (!list.listed && !is_built_in(o.scene.name) && !std::filesystem::exists(o.scene.name))
    fail_to_read(o.scene.name, ENOENT);
  if (!list.listed)
    fail("{} needs the cameras that the pictures are of: {}; name their file with --cameras", command,
         why_no_cameras(o.scene, list.hints));
  if (!o.photos.empty()) check_photos_unique(o.photos, list.cameras);
  check_photos(o.photos, chosen_cameras({}, o.camera.lens, list));
  return list;
}

compact::ViewSplit split_views(const std::string& command, const Options& o, const PhotoSource& photos,
                               const CameraList& list, const ValidationLimit& limit) {
  compact::ViewSplit views;
  std::vector<Camera> cameras = chosen_cameras({}, o.camera.lens, list);
  const auto take = [&](const std::vector<std::string>& names, const char* option,
                        std::vector<adagscale::CalibrationView>& into) {
    if (names.empty()) return;
    for (const Camera& camera : chosen_cameras(names, o.camera.lens, list, option)) {
      into.push_back(with_photo(photos, camera));
      if (std::erase_if(cameras, [&](const Camera& other) { return other.name == camera.name; }) == 0)
        fail("{} {}: the view is named twice: a view has one use", option, camera.name);
    }
  };
  take(o.split.tests, "--test", views.test);
  take(o.split.validation, "--validation", views.validation);
  if (cameras.size() + (views.validation.empty() ? 0 : 1) < 2)
    fail("{}: {} cameras for {}, which needs at least two: one for training, one to validate", list.source,
         cameras.size(), command);
  if (!views.validation.empty()) {
    views.training = std::move(cameras);
    return views;
  }
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (o.photos.empty() || find_view_photo(o.photos, cameras[i])) candidates.push_back(i);
  }
  if (candidates.empty()) fail("--photos {}: there is no photo of any view", o.photos);
  const std::size_t wanted = std::max<std::size_t>(limit(candidates.size(), cameras.size()), 1);
  std::vector<bool> validation(cameras.size(), false);
  for (const std::size_t k : spread_evenly(candidates.size(), wanted)) validation[candidates[k]] = true;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (validation[i]) {
      views.validation.push_back(with_photo(photos, cameras[i]));
    } else {
      views.training.push_back(cameras[i]);
    }
  }
  return views;
}

void add_own_size(const Options& o, const CameraList& list, compact::ViewSplit& views) {
  if (!o.camera.lens.size) return;
  bool larger = false;
  const auto in_own_size = [&](const std::vector<adagscale::CalibrationView>& of) {
    std::vector<adagscale::CalibrationView> own;
    for (const adagscale::CalibrationView& view : of) {
      own.push_back({chosen_cameras({view.camera.name}, {}, list)[0], {}});
      const Camera& camera = own.back().camera;
      larger = larger || camera.width > view.camera.width || camera.height > view.camera.height;
    }
    return own;
  };
  std::vector<adagscale::CalibrationView> validation = in_own_size(views.validation),
                                          test = in_own_size(views.test);
  if (!larger) return;
  const Camera &small = views.validation[0].camera, &own = validation[0].camera;
  log_info("--size: measured at {} x {} px, and at the cameras' own {} x {}, which takes longer", small.width,
           small.height, own.width, own.height);
  views.validation_own = std::move(validation);
  views.test_own = std::move(test);
}

}  // namespace

SplitScene open_split(const std::string& command, const Options& o, ModelFormat format,
                      const ValidationLimit& limit) {
  SplitScene scene{photos_of(o)};
  const CameraList list = needed_cameras(command, o);
  scene.model = load_scene(o.scene, {}, list.cameras);
  refuse_scaffold(scene.model, o.scene.name);
  bring_into_axes(scene.model, row_of(format).axes);
  scene.views = split_views(command, o, scene.photos, list, limit);
  scene.views.near_plane = near_plane_of(o.camera, list, scene.model);
  scene.context = open_context(o.context);
  remove_empty_views(command, *scene.context, scene.model, scene.views);
  add_own_size(o, list, scene.views);
  return scene;
}

}  // namespace binosplat::app
