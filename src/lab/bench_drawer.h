#pragma once
// Draws frames with bench settings: whole or foveated, at fixed levels or levels that follow the views.

#include <utility>
#include <vector>

#include "lab/bench_settings.h"
#include "lab/bench_views.h"
#include "stereo/drawing.h"

namespace binosplat::lab {

class BenchDrawer {
 public:
  BenchDrawer(FollowingModel model, const BenchSettings& settings)
      : model_(std::move(model)), drawing_(model_.model), settings_(settings) {}

  bool follows() const { return bool(model_.load_levels); }
  LoadedLevels load_levels(std::span<const shared::View> eyes) {
    return model_.load_levels ? model_.load_levels(eyes) : LoadedLevels{model_.model->size().gaussians};
  }
  Report draw(std::span<const shared::View> eyes) { return drawing_.draw(eyes, settings_); }
  std::vector<Picture> read_pictures() { return drawing_.read_pictures(); }
  const std::vector<stereo::FoveatedEye>& parts() const { return drawing_.parts(); }
  render::Frame& frame() { return drawing_.frame(); }

 private:
  FollowingModel model_;
  stereo::Drawing drawing_;
  BenchSettings settings_;
};

}  // namespace binosplat::lab
