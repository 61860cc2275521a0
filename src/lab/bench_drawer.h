#pragma once
// Draws frames with bench settings: whole or foveated, at fixed levels or levels that follow the views.

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

  bool follows() const { return bool(model_.load_levels); }
  LoadedLevels load_levels(std::span<const shared::View> eyes) {
    return model_.load_levels ? model_.load_levels(eyes) : LoadedLevels{model_.model->size().gaussians};
  }
  Report draw(std::span<const shared::View> eyes) {
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
