#include "app/followed.h"

#include <utility>

#include "app/detail.h"
#include "app/load_scene.h"
#include "formats/model_file.h"
#include "formats/streamed_sog.h"
#include "measure/metrics.h"
#include "scene/camera.h"

namespace binosplat::app {

namespace {

Model finest_of(const SceneOptions& options) {
  Model model = load_model(options.name);
  set_as_asked(options, model);
  return model;
}

std::vector<Picture> exact_pictures(render::Frame& frame, std::span<const shared::View> views,
                                    const render::FrameSettings& settings) {
  frame.draw(views, render::exact_of(settings));
  return frame.read_pictures();
}

}  // namespace

StreamSettings stream_settings(const SceneOptions& options, const render::FrameSettings& settings) {
  StreamSettings result{.detail = options.detail.value_or(DetailRequest{}),
                        .shares = !options.detail,
                        .all_up_to = few_gaussians};
  if (options.gpu_memory) {
    result.room = [megabytes = *options.gpu_memory, settings](std::span<const shared::View> views,
                                                              int degree) {
      const std::vector<shared::View> pair(
          2, make_view(look_at({0, 0, -1}, {0, 0, 0}, {0, -1, 0}, 60, 1280, 720)));
      return gaussians_that_fit(megabytes, settings, views.empty() ? pair : views, degree, true);
    };
  }
  return result;
}

std::unique_ptr<Stream> open_stream(const SceneOptions& options, StreamSettings settings) {
  auto stream = std::make_unique<Stream>(options.name, std::move(settings));
  set_as_asked(options, stream->model());
  return stream;
}

std::unique_ptr<Stream> open_for_frames(const SceneOptions& options, const render::FrameSettings& settings) {
  const bool asked = options.detail || options.gpu_memory;
  const bool follows = !options.lod && !is_built_in(options.name) && (asked || is_streamed_sog(options.name));
  if (!follows) return nullptr;
  StreamSettings of_stream = stream_settings(options, settings);
  of_stream.reserve = std::size_t{1} << 22;  // 0.4 GB, or 1 with all their harmonics
  return open_stream(options, std::move(of_stream));
}

std::unique_ptr<Stream> open_for_shots(const SceneOptions& options, const render::FrameSettings& settings,
                                       bool heads_turn) {
  StreamSettings of_shots = stream_settings(options, settings);
  of_shots.detail.heads_turn = heads_turn;
  if (options.detail || options.gpu_memory) of_shots.all_up_to = 0;
  return open_stream(options, std::move(of_shots));
}

ShotLevels settle_shot(Stream& stream, render::Frame& frame, stereo::DebugView& show,
                       std::span<const shared::View> views, const render::FrameSettings& settings,
                       const std::optional<glm::vec3>& background) {
  ShotLevels levels;
  std::vector<Picture> before;
  const auto before_change = [&] {
    if (background) before = exact_pictures(frame, views, settings);
    show.release();
  };
  levels.switched = stream.settle(views, settings, before_change);
  if (!before.empty())
    levels.switch_psnr = measure::psnr(before, exact_pictures(frame, views, settings), *background);
  levels.gaussians = stream.gaussians();
  levels.predicted_psnr = stream.reported_db();
  levels.left = stream.quality_left(settings.quality);
  const Stream::Times times = stream.take_times();
  levels.read_ms = times.read_ms;
  levels.upload_ms = times.upload_ms;
  return levels;
}

FinestLevels::FinestLevels(const SceneOptions& options, gl::Context& context)
    : model_(finest_of(options)), show_(std::make_shared<render::GpuModel>(context, model_)) {}

double FinestLevels::psnr(std::span<const shared::View> views, std::span<const Picture> pictures,
                          const render::FrameSettings& settings, const glm::vec3& background) {
  return measure::psnr(pictures, show_.exact(views, settings), background);
}

}  // namespace binosplat::app
