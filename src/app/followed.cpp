#include "app/followed.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "app/detail.h"
#include "app/load_scene.h"
#include "base/clock.h"
#include "formats/model_file.h"
#include "measure/metrics.h"
#include "scene/camera.h"

namespace binosplat::app {

namespace {

// Parts by which it is found what levels lose: of a picture, or of each of a turning head's.
constexpr std::size_t sample_of_one = 96, sample_of_many = 12;

std::vector<Picture> exact(render::Frame& frame, std::span<const shared::View> views,
                           const render::FrameSettings& settings) {
  frame.draw(views, render::exact_of(settings));
  return frame.read_pictures();
}

}  // namespace

DetailNeed detail_need(const SceneOptions& options, const render::FrameSettings& settings,
                       const StreamedSog& scene, std::span<const shared::View> views) {
  DetailNeed need = options.detail.value_or(DetailNeed{.shares = true});
  if (options.gpu_memory) {
    const std::vector<shared::View> pair(
        2, make_view(look_at({0, 0, -1}, {0, 0, 0}, {0, -1, 0}, 60, 1280, 720)));
    need.most = gaussians_that_fit(*options.gpu_memory, settings, views.empty() ? pair : views,
                                   scene.like().degree, true);
    need.most -= std::min(need.most, scene.spare());
  }
  return need;
}

Model FollowedLevels::coarsest() {
  Model model = scene_.like();
  set_as_asked(options_, model);
  scene_.choose({}, {});
  read(model);
  return model;
}

void FollowedLevels::bring(gl::Context& context, Model& model, std::span<const shared::View> views) {
  std::shared_ptr<render::GpuModel> gpu_model;
  if (goes_by_db()) gpu_model = std::make_shared<render::GpuModel>(context, model, settings_.precision);
  parts_.take_changes();
  settle(model, gpu_model, views, settings_, [] {});
  parts_.take_changes();
  brought_.assign(views.begin(), views.end());
}

template <typename Changing>
bool FollowedLevels::settle(Model& model, const std::shared_ptr<render::GpuModel>& gpu_model,
                            std::span<const shared::View> views, const render::FrameSettings& settings,
                            const Changing& changing) {
  if (options_.gpu_memory) {
    const std::size_t most = need(views).most;
    model.room = std::min(most, scene_.finest()) + scene_.spare();
  }
  std::optional<render::Sight> sight;  // not longer than this: it takes the memory of a small frame
  if (goes_by_db()) sight.emplace(gpu_model);
  bool switched = false;
  const auto change = [&] {
    if (!switched) changing();
    switched = true;
    read(model);
    if (!gpu_model) return;
    const auto start = Clock::now();
    if (heads_turn_) {
      gpu_model->reload(parts_.take_changes());
    } else {
      gpu_model->reload();
    }
    upload_ms_ += ms_since(start);
  };
  if (!heads_turn_) {
    scene_.choose({}, {});
    if (sight || choose(nullptr, views, settings)) forget(model);
    if (sight && scene_.choose({}, {})) change();  // what is looked at is the coarsest
  }
  const auto choose_and_change = [&](int looks) {
    for (int look = 0; look < looks; ++look) {
      if (!choose(sight ? &*sight : nullptr, views, settings)) break;
      change();
    }
  };
  choose_and_change(sight ? looks_most : 1);
  if (!sight || views.empty()) return switched;
  const PartsTrial trial = sight->trial(settings);
  try_sample(model, views.front(), trial);
  choose_and_change(1);
  try_sample(model, views.front(), trial);  // those of the first are no longer there by chance
  return switched;
}

void FollowedLevels::try_sample(Model& model, const shared::View& view, const PartsTrial& trial) {
  const auto parts =
      sample_of(*scene_.choice(), scene_.chosen(), heads_turn_ ? sample_of_many : sample_of_one, samples_++);
  PartModels finest = scene_.finest_of(parts);
  if (options_.gpu_memory) keep_what_fits(finest, model, parts_);
  if (finest.parts.empty()) return;
  trial.keep(view);
  const PartModels before = exchange(finest, model, parts_, trial);
  const double all = scene_.choice()->error_of(scene_.chosen(), 0, 1);
  found_.note(loss_of(*scene_.choice(), all, scene_.chosen(), finest.parts, trial.differs(view)));
  exchange(before, model, parts_, trial);
}

void FollowedLevels::read(Model& model) {
  const auto start = Clock::now();
  scene_.read([&](const StreamedSog::Piece& piece) { parts_.replace(model, piece.part, piece.model); });
  read_ms_ += ms_since(start);
}

void FollowedLevels::forget(Model& model) {
  scene_.forget();
  found_ = {};
  samples_ = 0;
  parts_ = ModelParts(scene_.parts());
  model.resize(0);
}

bool FollowedLevels::choose(render::Sight* sight, std::span<const shared::View> views,
                            const render::FrameSettings& settings) {
  DetailSeen seen;
  if (sight != nullptr) seen = {sight->look(views, settings, parts_), scene_.chosen()};
  DetailNeed needed = need(views);
  needed.heads_turn = heads_turn_;
  needed.found = found_.factor();
  return scene_.choose(views, needed, seen);
}

ShotLevels FollowedLevels::follow(Model& model, render::Frame& frame, stereo::Show& show,
                                  std::span<const shared::View> views,
                                  const render::FrameSettings& settings) {
  ShotLevels levels;
  std::vector<Picture> before;
  const auto changing = [&] {
    if (report_ && heads_turn_) before = exact(frame, views, settings);
    show.release();
  };
  const auto brought = std::exchange(brought_, {});
  if (!std::ranges::equal(std::as_bytes(std::span(brought)), std::as_bytes(views)))
    levels.switched = settle(model, frame.model(), views, settings, changing);
  if (!before.empty()) levels.switch_psnr = measure::psnr(before, exact(frame, views, settings), background_);
  levels.gaussians = parts_.gaussians();
  levels.predicted_psnr = scene_.predicted_psnr(found_.factor());
  levels.left = settings.quality;
  if (settings.quality > 0.0f && levels.predicted_psnr)
    levels.left = left_of(settings.quality, *levels.predicted_psnr, *levels.predicted_psnr);
  levels.read_ms = std::exchange(read_ms_, 0.0);
  levels.upload_ms = std::exchange(upload_ms_, 0.0);
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
