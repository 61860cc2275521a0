#include "app/drawing.h"

#include <algorithm>

#include "base/choices.h"
#include "base/log.h"
#include "measure/twins.h"
#include "shared/axes.h"

namespace binosplat::app {

namespace {

gl::Backend backend_of(const std::string& name) {
  if (name == "device") return gl::Backend::device;
  if (name == "osmesa") return gl::Backend::osmesa;
  return name == "surfaceless" ? gl::Backend::surfaceless : gl::Backend::automatic;
}

}  // namespace

std::unique_ptr<gl::Context> open_context(const RenderOptions& options) {
  auto context = gl::Context::open(backend_of(options.backend), options.device);
  log_info("drawing with {} ({}, OpenGL {})", context->renderer(), context->backend(), context->version());
  return context;
}

render::FrameSettings settings_of(const RenderOptions& options) {
  render::FrameSettings settings;
  settings.tiles = find_choice("--tiles", options.tiles, tiles_choices);
  settings.th = find_choice("--th", threshold_name(options), th_choices);
  settings.loss = options.loss.value_or(0.0f);
  settings.transmittance = find_choice("--transmittance", options.transmittance, transmittance_choices);
  settings.quality = options.quality.value_or(0.0f);
  settings.decode =
      options.decode.empty() ? DECODE_EYES : find_choice("--decode", options.decode, decode_choices);
  settings.tile_size = options.tile == "auto" ? TILE_SIZE_DEFAULT : std::stoi(options.tile);
  settings.precision = find_choice("--precision", options.precision, precision_choices);
  settings.background = options.background.value_or(settings.background);
  return settings;
}

render::Workings workings_of(const RenderOptions& options) {
  render::Workings workings;
  const auto* const found =
      std::find(render::stage_names.begin(), render::stage_names.end(), options.reference_until);
  if (found != render::stage_names.end()) {
    workings.stand_in =
        measure::reference_until(static_cast<render::Stage>(found - render::stage_names.begin()));
  }
  return workings;
}

}  // namespace binosplat::app
