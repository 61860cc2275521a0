#pragma once
// Draws by settings: whole pictures or foveated ones, of the finest levels or of those that are needed.

#include <utility>
#include <vector>

#include "lab/bench_case.h"
#include "lab/settings.h"
#include "stereo/foveate.h"

namespace binosplat::lab {

class BenchDrawer {
 public:
  BenchDrawer(FollowingModel model, const BenchSettings& settings)
      : model_(std::move(model)), frame_(model_.model), settings_(settings) {}

  /// Whether levels follow what is drawn.
  bool follows() const { return bool(model_.bring); }
  /// To the levels that the views need.
  LevelsBrought bring(std::span<const shared::View> eyes) {
    return model_.bring ? model_.bring(eyes) : LevelsBrought{model_.model->size().gaussians};
  }
  render::FrameReport draw(std::span<const shared::View> eyes) {
    return settings_.foveation ? frame_.draw(eyes, *settings_.foveation, settings_)
                               : frame_.frame().draw(eyes, settings_);
  }
  std::vector<Picture> read_pictures() {
    return settings_.foveation ? frame_.read_pictures() : frame_.frame().read_pictures();
  }
  stereo::FoveatedFrame& foveated() { return frame_; }
  render::Frame& frame() { return frame_.frame(); }

 private:
  FollowingModel model_;
  stereo::FoveatedFrame frame_;
  BenchSettings settings_;
};

}  // namespace binosplat::lab
