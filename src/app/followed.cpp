#include "app/followed.h"

#include <utility>

#include "app/detail.h"
#include "app/load_scene.h"
#include "base/clock.h"
#include "formats/model_file.h"
#include "measure/metrics.h"

namespace binosplat::app {

namespace {

std::vector<Picture> exact(render::Frame& frame, std::span<const shared::View> views,
                           const render::FrameSettings& settings) {
  frame.draw(views, render::exact_of(settings));
  return frame.read_pictures();
}

}  // namespace

DetailNeed detail_need(const SceneOptions& options, const render::FrameSettings& settings,
                       const StreamedSog& scene, std::span<const shared::View> views) {
  DetailNeed need = options.detail.value_or(DetailNeed{});
  if (options.gpu_memory)
    need.most = gaussians_that_fit(*options.gpu_memory, settings, views, scene.degree());
  return need;
}

Model FollowedLevels::coarsest() {
  scene_.choose({}, {});
  Model model = scene_.read();
  set_as_asked(options_, model);
  return model;
}

void FollowedLevels::bring(Model& model, std::span<const shared::View> views) {
  if (scene_.choose(views, detail_need(options_, settings_, scene_, views))) read(model);
}

void FollowedLevels::read(Model& model) {
  const auto start = Clock::now();
  model = scene_.read();
  set_as_asked(options_, model);
  read_ms_ += ms_since(start);
}

ShotLevels FollowedLevels::follow(Model& model, render::Frame& frame, stereo::Show& show,
                                  std::span<const shared::View> views,
                                  const render::FrameSettings& settings) {
  ShotLevels levels;
  if (scene_.choose(views, detail_need(options_, settings_, scene_, views))) {
    levels.switched = true;
    std::vector<Picture> before;
    if (report_) before = exact(frame, views, settings);
    read(model);
    show.release();
    const auto start = Clock::now();
    frame.model()->reload();
    levels.upload_ms = ms_since(start);
    if (report_) levels.switch_psnr = measure::psnr(before, exact(frame, views, settings), background_);
  }
  levels.gaussians = model.count();
  levels.predicted_psnr = scene_.predicted_psnr();
  levels.read_ms = std::exchange(read_ms_, 0.0);
  return levels;
}

double FollowedLevels::against_finest(gl::Context& context, std::span<const shared::View> views,
                                      std::span<const Picture> pictures,
                                      const render::FrameSettings& settings) {
  if (!finest_) {
    finest_ = load_model(options_.name);
    set_as_asked(options_, *finest_);
    show_finest_.emplace(std::make_shared<render::GpuModel>(context, *finest_));
  }
  return measure::psnr(pictures, show_finest_->exact(views, settings), background_);
}

}  // namespace binosplat::app
