// binosplat study --turn.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/study_parts.h"
#include "base/progress.h"
#include "scene/axes.h"
#include "stereo/rig.h"
#include "study/turning.h"

namespace binosplat::app {

namespace {

// Of a device that draws on the CPU fewer.
study::TurningSettings settings_for(const gl::Context& context) {
  return context.software() ? study::TurningSettings{.columns = 16, .rows = 12} : study::TurningSettings{};
}

void print(const study::TurningStudy& study) {
  fmt::print("{}, {} of {}: {} x {} rays over {:g} degrees, pictures of {} x {} px\n\n", study.device,
             study.view, study.scene, study.settings.columns, study.settings.rows,
             study.settings.field_degrees, study.width, study.height);
  fmt::print("PSNR in dB against the head that is not turned, along the same rays\n\n");
  fmt::print("| order, projection | about | {:g} degrees | off by over 5/255 |\n",
             fmt::join(study.settings.degrees, " | "));
  fmt::print("|---|---|");
  for (std::size_t k = 0; k <= study.settings.degrees.size(); ++k) fmt::print("---|");
  const std::size_t each = study.settings.degrees.size();
  for (std::size_t k = 0; k < study.turns.size(); ++k) {
    const study::Turned& turn = study.turns[k];
    if (k % each == 0) {
      fmt::print("\n| {}, {} | {} |", order_choices[turn.seen.order].name,
                 projection_choices[turn.seen.projection].name, turn.about);
    }
    fmt::print(" {} |", turn.rays == 0             ? std::string("no ray in both")
                        : std::isinf(turn.psnr_db) ? std::string("equal")
                                                   : fmt::format("{:.1f}", turn.psnr_db));
    if (k % each == each - 1)
      fmt::print(" {:.1f} % |", 100.0 * study.turns[k - (each > 1 ? 1 : 0)].share_beyond);
  }
  fmt::print("\n\nThe last column is of {:g} degrees.\n", study.settings.degrees[each > 1 ? each - 2 : 0]);
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
  print(study);
  save(options, study::to_json(study), study::turning_page(study));
}

}  // namespace binosplat::app
