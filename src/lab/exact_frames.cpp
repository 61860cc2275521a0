#include "lab/exact_frames.h"

#include <cmath>
#include <cstring>

#include "base/log.h"

namespace binosplat::lab {

namespace {

bool equal_views(const std::vector<shared::View>& a, const std::vector<shared::View>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(shared::View)) == 0;
}

}  // namespace

ExactFrames::ExactFrames(std::shared_ptr<render::GpuModel> model, const render::FrameSettings& settings,
                         std::span<const Stretch> stretches, std::int64_t bytes_max)
    : settings_(render::exact_of(settings)),
      frame_(std::move(model)),
      bytes_(frame_.model()->context()),
      again_(frame_.model()->context(), "exact pictures drawn again") {
  std::int64_t bytes = 0;
  std::size_t left_out = 0;
  for (const Stretch& stretch : stretches) {
    std::vector<std::size_t>& of_stretch = poses_of_.emplace_back();
    for (const std::vector<shared::View>& views : stretch.frames) {
      if (of_stretch.empty() || !equal_views(poses_.back().views, views)) {
        Pose& pose = poses_.emplace_back(Pose{views, 0.0, nullptr});
        pose.pairs = static_cast<double>(frame_.draw(views, settings_).pairs);
        bytes += BytePictures::bytes(views);
        if (bytes <= bytes_max) {
          pose.pictures = std::make_unique<gl::Buffer>(frame_.model()->context(), "exact pictures");
          bytes_.keep(frame_, views, *pose.pictures);
        } else {
          ++left_out;
        }
      }
      of_stretch.push_back(poses_.size() - 1);
    }
  }
  if (left_out > 0) log_info("{} exact frames do not fit into memory: each setting redraws them", left_out);
}

std::vector<double> ExactFrames::psnr(const render::Frame& drawn, std::size_t stretch, std::size_t n) {
  const Pose& exact = pose(stretch, n);
  const gl::Buffer* wanted = exact.pictures.get();
  if (wanted == nullptr) {
    frame_.draw(exact.views, settings_);
    bytes_.keep(frame_, exact.views, again_);
    wanted = &again_;
  }
  std::vector<double> db = bytes_.errors(drawn, exact.views, *wanted);
  for (double& value : db) value = -10.0 * std::log10(value);
  return db;
}

}  // namespace binosplat::lab
