#pragma once
// --detail: levels of detail that follow what is drawn.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/scene_options.h"
#include "base/image.h"
#include "render/frame.h"
#include "scene/model_parts.h"
#include "stereo/show.h"
#include "stream/level_sample.h"
#include "stream/sight.h"
#include "stream/streamed_sog.h"

namespace binosplat::app {

/// Which levels a shot was drawn with, and what that took.
struct ShotLevels {
  std::size_t gaussians = 0;  // of the model
  bool switched = false;      // other levels than the shot before
  double read_ms = 0.0;       // for the files, where they had to be read
  double upload_ms = 0.0;     // for the GPU
  std::optional<double>
      switch_psnr;  // dB, between the shot with the levels before and with these, both exact
  std::optional<double> finest_psnr;     // dB, against the exact picture of the finest levels
  std::optional<double> predicted_psnr;  // the same by the errors of the levels, of the worse eye
  double left = 0.0;                     // dB of settings.quality, for what the frame leaves out of them
};

/// What views of a run need (stream/streamed_sog.h): --detail, or the finest, or what --quality leaves to
/// levels, and --gpu-memory for the model and their frame.
DetailNeed detail_need(const SceneOptions& options, const render::FrameSettings& settings,
                       const StreamedSog& scene, std::span<const shared::View> views);

class FollowedLevels {
 public:
  /// Opens the scene, for frames of such settings: levels share their quality where no --detail is asked for
  /// and there are more than a few_gaussians, or little memory: a sample would read as many as there are.
  /// With `report` it says what a switch changes, in pictures
  /// before `background`. Shots are those of a head that turns, or single pictures, which do not depend on
  /// those before them. Throws Error where it is no streamed SOG.
  FollowedLevels(const SceneOptions& options, const render::FrameSettings& settings, bool report,
                 const glm::vec3& background, bool heads_turn)
      : options_(options),
        settings_(settings),
        report_(report),
        background_(background),
        heads_turn_(heads_turn),
        scene_(options.name),
        parts_(scene_.parts()),
        shares_(scene_.finest() > few_gaussians || options.gpu_memory) {}

  /// The coarsest levels, by which cameras are made up where there are none.
  Model coarsest();
  /// Of the model that there is.
  std::size_t gaussians() const { return parts_.gaussians(); }
  /// Whether they know what they lose.
  bool has_errors() const { return scene_.has_errors(); }
  /// Of the finest levels.
  std::size_t finest() const { return scene_.finest(); }

  /// Brings the model to the levels that the views need, before there is a frame of it.
  void bring(gl::Context& context, Model& model, std::span<const shared::View> views);

  /// The same with a frame and maps of the model. For dB it looks what the views show, by the levels that
  /// there are, before it chooses, up to three times.
  ShotLevels follow(Model& model, render::Frame& frame, stereo::Show& show,
                    std::span<const shared::View> views, const render::FrameSettings& settings);

  /// PSNR of pictures of these views against those of the finest levels, drawn exactly; all are of one mean.
  double against_finest(gl::Context& context, std::span<const shared::View> views,
                        std::span<const Picture> pictures, const render::FrameSettings& settings);

 private:
  DetailNeed need(std::span<const shared::View> views) const {
    DetailNeed need = detail_need(options_, settings_, scene_, views);
    if (shares_) need = scene_.sharing(need, settings_.quality);
    need.heads_turn = heads_turn_;
    need.found = found_.to_choose_by();
    return need;
  }
  bool goes_by_db() const {
    return options_.detail ? options_.detail->db.has_value()
                           : shares_ && settings_.quality > 0.0f && has_errors();
  }
  /// Brings the model, and what there is of it on the GPU (by dB it must be there), to what the views need;
  /// whether that was other levels. `changing` is called before the first of them is read.
  template <typename Changing>
  bool settle(Model& model, const std::shared_ptr<render::GpuModel>& gpu_model,
              std::span<const shared::View> views, const render::FrameSettings& settings,
              const Changing& changing);
  void read(Model& model);
  /// Finds what the levels chosen lose in the first view, by a picture with a sample of parts at their
  /// finest. What it returns is what both pictures show; of no parts where none was tried out.
  DetailSeen try_sample(Model& model, Sight& sight, std::span<const shared::View> views,
                        const render::FrameSettings& settings);
  /// What the views are taken to have: never more than the last sample alone lost. None where no dB are gone
  /// by.
  std::optional<double> told_psnr() const;
  DetailSeen look_at(Sight& sight, std::span<const shared::View> views,
                     const render::FrameSettings& settings) const;
  /// As if there were nothing yet.
  void forget(Model& model);
  SceneOptions options_;
  render::FrameSettings settings_;
  bool report_;
  glm::vec3 background_;
  bool heads_turn_;
  StreamedSog scene_;
  ModelParts parts_;
  bool shares_;  // levels and frames a quality, where no --detail was asked for
  LevelsFound found_;
  unsigned samples_ = 0;
  double lost_ = 0.0;                       // by the last sample, squared and meaned
  std::vector<shared::View> brought_;       // what bring() was for, until the first shot
  double read_ms_ = 0.0, upload_ms_ = 0.0;  // since the last shot
  std::optional<Model> finest_;
  std::optional<stereo::Show> show_finest_;
};

}  // namespace binosplat::app
