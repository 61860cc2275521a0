// binosplat study --turn.

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/study_parts.h"
#include "base/progress.h"
#include "scene/axes.h"
#include "study/turning.h"

namespace binosplat::app {

namespace {

// Of a device that draws on the CPU fewer.
study::TurningSettings settings_for(const gl::Context& context) {
  return context.software() ? study::TurningSettings{.columns = 16, .rows = 12} : study::TurningSettings{};
}

}  // namespace

void study_turn(gl::Context& context, const StudyOptions& options, const Studied& studied) {
  const Camera& camera = studied.shots.front().eyes.front().camera;
  study::TurningStudy study{options.scene.name, context.renderer(),    camera.name, camera.width,
                            camera.height,      settings_for(context), {}};
  render::Frame frame(context, *studied.model);
  Progress progress("turning", study::turning_steps(study.settings));
  std::size_t done = 0;
  study.turns = study::measure_turning(frame, into_axes(camera, studied.model->axes), studied.near_plane,
                                       study.settings, [&] { progress.update(++done); });
  fmt::print("{}, {} of {}: {} x {} rays over {:g} degrees, pictures of {} x {} px\n", study.device,
             study.view, study.scene, study.settings.columns, study.settings.rows,
             study.settings.field_degrees, study.width, study.height);
  fmt::print("PSNR against the head that is not turned, along the same rays\n\n");
  print_table(study::turning_table(study));
  save(options, study::to_json(study), study::turning_page(study));
}

}  // namespace binosplat::app
