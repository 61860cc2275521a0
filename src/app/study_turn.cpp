// binosplat study --turn.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/photos.h"
#include "app/study_parts.h"
#include "base/progress.h"
#include "lab/turning.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

// Of a device that draws on the CPU fewer.
lab::TurningSettings settings_for(const gl::Context& context, const StudyOptions& options) {
  lab::TurningSettings settings;
  const glm::ivec2 some =
      context.software() ? glm::ivec2(16, 12) : glm::ivec2(settings.columns, settings.rows);
  const glm::ivec2 rays = options.rays.value_or(some);
  settings.columns = rays.x;
  settings.rows = rays.y;
  return settings;
}

constexpr double metres_a_frame = 1.5 / 90.0;

/// A head that moves is seen in pictures of no more than so many pixels a side: what is compared is not
/// drawn.
constexpr int moving_side_max = 640;

Lens lens_for_moving(const Camera& camera) {
  const double scale = std::min(1.0, double{moving_side_max} / std::max(camera.width, camera.height));
  Lens lens;
  lens.size = glm::ivec2(glm::max(glm::round(scale * glm::dvec2(camera.width, camera.height)), 1.0));
  return lens;
}

lab::PerspectiveViews views_for(const gl::Context& context, const StudyOptions& options,
                                const Studied& studied) {
  const ModelAxes& axes = studied.model->axes;
  const Camera& camera = studied.shots.front().eyes.front().camera;
  const CameraList& list = studied.list;
  const stereo::RigSettings rig = rig_settings(options.rig, list.known, studied.near_plane);
  lab::PerspectiveViews views;
  Camera head = sized(lens_for_moving(camera), camera);
  for (int n = 0; n < (context.software() ? 9 : 16); ++n) {
    views.path.push_back(make_view(into_axes(head, axes), studied.near_plane));
    head.position += metres_a_frame * rig.units_per_metre * head.rotation[0];
  }
  if (!options.rig.one_picture()) {
    const stereo::EyePair eyes = stereo::make_rig(into_axes(camera, axes), rig);
    views.eyes.assign(eyes.views.begin(), eyes.views.end());
  }
  if (options.photos.empty()) return views;
  for (const lab::CalibrationView& one : photographed_views(photos_of_a_turn, photos_of(options), {}, list))
    views.photos.push_back(
        {make_view(into_axes(one.camera, axes), studied.near_plane), *one.photo, one.exposure});
  return views;
}

}  // namespace

void study_turn(gl::Context& context, const StudyOptions& options, const Studied& studied) {
  const Camera& camera = studied.shots.front().eyes.front().camera;
  lab::TurningStudy study{options.scene.name, lab::device_text(context),      camera.name, camera.width,
                          camera.height,      settings_for(context, options), {}};
  render::Frame frame(context, *studied.model);
  const lab::PerspectiveViews views = views_for(context, options, studied);
  Progress progress("turning", lab::turning_steps(study.settings) + lab::perspective_steps(views));
  std::size_t done = 0;
  const auto step = [&] { progress.update(++done); };
  lab::measure_turning(study, frame, into_axes(camera, studied.model->axes), studied.near_plane, step);
  study.numbers = lab::measure_perspectives(frame, views, step);
  fmt::print("{}, {} of {}: {} x {} rays over {:g} degrees, pictures of {} x {} px\n", study.device,
             study.view, study.scene, study.settings.columns, study.settings.rows,
             study.settings.field_degrees, study.width, study.height);
  fmt::print("PSNR against the head that is not turned, along the same rays\n\n");
  print_table(lab::turning_table(study));
  fmt::print(
      "\nAgainst {} photos; what the eyes do not share of the difference from distance and tangent; frames "
      "of "
      "a head that\nmoves sideways at 1.5 m/s, 90 a second, warped to one another by depth\n\n",
      views.photos.size());
  print_table(lab::perspectives_table(study.numbers));
  save(options, lab::to_json(study), lab::turning_page(study));
}

}  // namespace binosplat::app
