#include "app/models/level_options.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "app/models/load_scene.h"
#include "formats/models/streamed_sog.h"
#include "render/halves.h"
#include "render/memory.h"
#include "render/scattered_upload.h"
#include "scene/axes.h"
#include "scene/camera.h"

namespace binosplat::app {

namespace {

/// Bytes of the model and of a first frame. For a stream (`in_parts`), buffers have room for all Gaussians,
/// and the memory of uploads is added.
std::int64_t bytes_for(render::FramePlan plan, std::uint32_t gaussians, bool in_parts) {
  plan.gaussian_count = in_parts ? 0 : gaussians;
  plan.gaussian_capacity = gaussians;
  plan.models.front().size.capacity = gaussians;
  const render::MemoryNeeds needs = render::memory_needs(plan);
  if (!in_parts) return needs.model + needs.frame;
  const int precision = plan.settings.precision;
  // Each record of an upload also stores its target index.
  const std::int64_t bytes_of_one = render::gaussian_bytes(precision) +
                                    render::harmonic_bytes(plan.models.front().degree, precision) + 2 * 4;
  const auto uploads = static_cast<std::int64_t>(
      std::bit_ceil(std::min<std::size_t>(gaussians, render::ScatteredUpload::records_at_once)));
  return needs.model + needs.frame + uploads * bytes_of_one;
}

// An eye pair of the usual size, for use before the views are known.
std::vector<shared::View> default_views(const Lens& lens = {}, std::size_t count = 2) {
  const Camera camera = look_at({0, 0, -1}, {0, 0, 0}, {0, -1, 0}, 60, 1280, 720);
  return std::vector<shared::View>(count, make_view(sized(lens, camera)));
}

/// Settings of a stream. Without --detail, levels may spend half of the error of --quality, in models of more
/// than few_gaussians. --gpu-memory limits the Gaussians.
StreamSettings stream_settings(const SceneOptions& options, const render::FrameSettings& settings) {
  StreamSettings result{.detail = options.detail.value_or(DetailRequest{}),
                        .shares_quality = !options.detail,
                        .finest_up_to = few_gaussians};
  if (options.gpu_memory) {
    result.max_in_memory = [megabytes = *options.gpu_memory, settings](std::span<const shared::View> views,
                                                                       int degree) {
      const std::vector<shared::View> usual = default_views();
      return gaussians_that_fit(megabytes, settings, views.empty() ? usual : views, degree, true);
    };
  }
  return result;
}

}  // namespace

std::size_t gaussians_that_fit(double megabytes, render::FrameSettings settings,
                               std::span<const shared::View> views, int degree, bool in_parts) {
  settings.depth_table = {1.0f, {1.0f}};  // a placeholder: not measured yet
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

DetailBudget detail_budget(const Options& options, const CameraList& list) {
  const ModelAxes axes{options.scene.axes.empty() ? Model().axes.letters : options.scene.axes};
  std::vector<Shot> shots;
  if (const CameraOptions& camera = options.camera; list.listed || camera.eye) {
    shots = make_shots(camera.views, camera.lens, options.rig,
                       list.listed ? list : eye_camera(camera, list.hints),
                       camera.near_plane.value_or(near_default), axes);
  }
  DetailBudget budget;
  std::vector<shared::View> widest;  // views of the shot with the most pixels
  std::uint64_t max_pixels = 0;
  for (const Shot& shot : shots) {
    std::uint64_t pixels = 0;
    for (const Eye& eye : shot.eyes) {
      budget.eyes.push_back(into_axes(eye.camera, axes).position);
      pixels += std::uint64_t{eye.view.width} * eye.view.height;
    }
    if (pixels > max_pixels) widest = views_of(shot);
    max_pixels = std::max(max_pixels, pixels);
  }
  if (shots.empty()) widest = default_views(options.camera.lens, options.rig.one_picture() ? 1 : 2);
  budget.gaussians = [megabytes = *options.scene.gpu_memory, settings = settings_of(options.drawing),
                      widest](int degree) {
    return gaussians_that_fit(megabytes, settings, widest, degree, false);
  };
  return budget;
}

OpenedModel<Stream> open_for_frames(const SceneOptions& options, const render::FrameSettings& settings,
                                    std::span<const Camera> cameras) {
  const bool asked = options.detail || options.gpu_memory;
  const bool follows = !options.lod && !is_built_in(options.name) &&
                       (asked || (options.format.empty() && is_streamed_sog(options.name)));
  if (!follows) return {.whole = load_scene(options, {}, cameras)};
  StreamSettings of_stream = stream_settings(options, settings);
  of_stream.reserve = std::size_t{1} << 22;  // Gaussians: 0.4 GB, or 1 GB with harmonics of degree 3
  auto stream = std::make_unique<Stream>(options.name, std::move(of_stream));
  apply_options(options, stream->model());
  return {std::move(stream)};
}

std::unique_ptr<PictureStream> open_for_shots(const SceneOptions& options,
                                              const render::FrameSettings& settings, bool heads_turn) {
  StreamSettings of_shots = stream_settings(options, settings);
  of_shots.detail.heads_turn = heads_turn;
  if (options.detail || options.gpu_memory) of_shots.finest_up_to = 0;
  auto stream = std::make_unique<PictureStream>(options.name, std::move(of_shots));
  apply_options(options, stream->model());
  return stream;
}

}  // namespace binosplat::app
