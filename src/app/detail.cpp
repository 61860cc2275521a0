#include "app/detail.h"

#include <algorithm>
#include <bit>

#include "render/halves.h"
#include "render/memory.h"
#include "render/scatter.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

std::vector<Shot> known_shots(const RenderOptions& options, const CameraList& list, const ModelAxes& axes) {
  const CameraOptions& camera = options.camera;
  if (!list.listed && !camera.eye) return {};
  const double near_plane = camera.near_plane.value_or(near_default);
  return make_shots(camera.views, camera.lens, options.rig,
                    list.listed ? list : eye_camera(camera, list.known), near_plane, axes);
}

/// Bytes that a frame starts with, those of the model included; of one whose parts come later, which has room
/// for so many, those of their uploads, too.
std::int64_t bytes_for(render::FramePlan plan, std::uint32_t gaussians, bool in_parts) {
  plan.gaussian_count = in_parts ? 0 : gaussians;
  plan.gaussian_room = gaussians;
  const render::MemoryNeeds needs = render::memory_needs(plan);
  if (!in_parts) return needs.model + needs.frame;
  const int precision = plan.settings.precision;
  // Each of both with its place.
  const std::int64_t bytes_of_one =
      render::gaussian_bytes(precision) + render::harmonic_bytes(plan.degree, precision) + 2 * 4;
  const auto uploads = static_cast<std::int64_t>(
      std::bit_ceil(std::min<std::size_t>(gaussians, render::Scatter::records_at_once)));
  return needs.model + needs.frame + uploads * bytes_of_one;
}

}  // namespace

std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts) {
  settings.depth_table = {1.0f, {1.0f}};  // not measured yet
  const double bytes = 1e6 * megabytes;
  Model model;
  model.degree = degree;
  const render::FramePlan plan = render::make_plan(views, settings, model);
  std::uint32_t fits = 0;
  for (std::uint32_t step = 1u << 30; step > 0; step /= 2) {
    if (static_cast<double>(bytes_for(plan, fits + step, in_parts)) <= bytes) fits += step;
  }
  return fits;
}

DetailBudget detail_budget(const RenderOptions& options, const CameraList& list) {
  const ModelAxes axes{options.scene.axes.empty() ? Model().axes.letters : options.scene.axes};
  const std::vector<Shot> shots = known_shots(options, list, axes);
  DetailBudget budget;
  std::vector<shared::View> widest;  // the shot of the most pixels
  std::uint64_t most_pixels = 0;
  for (const Shot& shot : shots) {
    std::uint64_t pixels = 0;
    for (const Eye& eye : shot.eyes) {
      budget.eyes.push_back(into_axes(eye.camera, axes).position);
      pixels += std::uint64_t{eye.view.width} * eye.view.height;
    }
    if (pixels > most_pixels) widest = views_of(shot);
    most_pixels = std::max(most_pixels, pixels);
  }
  if (shots.empty()) {
    Camera camera = look_at({0, 0, -1}, {0, 0, 0}, {0, -1, 0}, 60, 1280, 720);
    widest.assign(options.rig.one_picture() ? 1 : 2, make_view(sized(options.camera.lens, camera)));
  }
  budget.gaussians = [megabytes = *options.scene.gpu_memory, settings = settings_of(options.drawing),
                      widest](int degree) {
    return gaussians_that_fit(megabytes, settings, widest, degree, false);
  };
  return budget;
}

}  // namespace binosplat::app
