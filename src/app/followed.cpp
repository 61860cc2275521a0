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

// Gaussians by whose finest levels it is found what levels lose: of a picture, or of each of a turning
// head's.
constexpr std::size_t sample_of_one = 1 << 17, sample_of_many = 1 << 14;
// Samples of a picture: levels that one finds to miss what was asked for by more than this become finer, and
// each further miss asks for so much more than what was asked for.
constexpr int samples_most = 8;
constexpr double misses_db = 1.0, more_db = 3.0;

std::vector<Picture> exact_pictures(render::Frame& frame, std::span<const shared::View> views,
                                    const render::FrameSettings& settings) {
  frame.draw(views, render::exact_of(settings));
  return frame.read_pictures();
}

/// Takes of `other` what shows more than `seen` does.
void show_more(DetailSeen& seen, const DetailSeen& other) {
  for (std::size_t v = 0; v < seen.by_view.size(); ++v) {
    for (std::size_t p = 0; p < seen.by_view[v].size(); ++p)
      if (other.by_view[v][p].area > seen.by_view[v][p].area) seen.by_view[v][p] = other.by_view[v][p];
  }
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
  std::optional<Sight> sight;  // not longer than this: it takes the memory of a small frame
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
    if (sight || scene_.choose(views, need(views))) forget(model);
    if (sight && scene_.choose({}, {})) change();  // what is looked at is the coarsest
  }
  for (int look = 0; look < (sight ? looks_most : 1); ++look) {
    const DetailSeen seen = sight ? look_at(*sight, views, settings) : DetailSeen();
    if (!scene_.choose(views, need(views), seen)) break;
    change();
  }
  lost_ = 0.0;
  if (!sight || views.empty()) return switched;
  for (int sample = 1; sample <= samples_most; ++sample) {
    const DetailSeen seen = try_sample(model, *sight, views, settings);
    DetailNeed finer = need(views);
    const bool keeps = sample > 1 && told_psnr() > *finer.db - misses_db;
    if (keeps || seen.drawn.empty() || sample == samples_most) break;
    *finer.db += more_db * (sample - 1);
    if (!scene_.choose(views, finer, seen)) break;
    change();
  }
  return switched;
}

// Where the sample is all that is not at its finest, a part counts as seen as much as in the picture that
// shows more of it: it may hide others, or reach into the picture, at one of both levels only, and what is
// lost there would be predicted to be nothing. Of fewer parts that would be told too often of those in the
// sample.
DetailSeen FollowedLevels::try_sample(Model& model, Sight& sight, std::span<const shared::View> views,
                                      const render::FrameSettings& settings) {
  const std::vector<std::size_t> levels = scene_.chosen();
  const std::size_t most = (heads_turn_ ? sample_of_many : sample_of_one) * scene_.parts() / scene_.finest();
  PartModels finest =
      scene_.finest_of(sample_of(*scene_.choice(), levels, std::max<std::size_t>(most, 1), samples_++));
  if (options_.gpu_memory) keep_what_fits(finest, model, parts_);
  if (finest.parts.empty()) return {};
  const PartsTrial trial = sight.trial(settings);
  trial.keep(views.front());
  DetailSeen seen = look_at(sight, views, settings);
  const PartModels before = exchange(finest, model, parts_, trial);
  lost_ = trial.differs(views.front());
  const auto finest_already = static_cast<std::size_t>(std::ranges::count(levels, 0u));
  if (finest.parts.size() + finest_already == levels.size()) show_more(seen, look_at(sight, views, settings));
  exchange(before, model, parts_, trial);
  LevelsChosen chosen = *scene_.chooser().choose(views, need(views), seen);
  chosen.levels = levels;
  scene_.choose(std::make_shared<LevelsChosen>(std::move(chosen)));
  const DetailChoice& choice = *scene_.choice();
  found_.note(loss_of(choice, choice.error_of(levels, 0, 1), levels, finest.parts, lost_));
  return seen;
}

std::optional<double> FollowedLevels::told_psnr() const {
  const auto predicted = scene_.predicted_psnr(found_.factor());
  return predicted && lost_ > 0.0 ? std::min(*predicted, psnr_of_error(lost_)) : predicted;
}

DetailSeen FollowedLevels::look_at(Sight& sight, std::span<const shared::View> views,
                                   const render::FrameSettings& settings) const {
  return {sight.look(views, settings, parts_), scene_.chosen()};
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

ShotLevels FollowedLevels::follow(Model& model, render::Frame& frame, stereo::Show& show,
                                  std::span<const shared::View> views,
                                  const render::FrameSettings& settings) {
  ShotLevels levels;
  std::vector<Picture> before;
  const auto changing = [&] {
    if (report_ && heads_turn_) before = exact_pictures(frame, views, settings);
    show.release();
  };
  const auto brought = std::exchange(brought_, {});
  if (!std::ranges::equal(std::as_bytes(std::span(brought)), std::as_bytes(views)))
    levels.switched = settle(model, frame.model(), views, settings, changing);
  if (!before.empty())
    levels.switch_psnr = measure::psnr(before, exact_pictures(frame, views, settings), background_);
  levels.gaussians = parts_.gaussians();
  levels.predicted_psnr = told_psnr();
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
