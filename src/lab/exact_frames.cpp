#include "lab/exact_frames.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace binosplat::lab {

namespace {

bool equal_views(const std::vector<shared::View>& a, const std::vector<shared::View>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(shared::View)) == 0;
}

}  // namespace

ExactFrames::ExactFrames(std::shared_ptr<render::GpuModel> model, std::int64_t bytes_max)
    : model_(std::move(model)), bytes_max_(bytes_max), bytes_(model_->context()) {}

gl::Buffer* ExactFrames::room_for(const std::vector<shared::View>& views) {
  const std::int64_t bytes = BytePictures::bytes(views);
  if (bytes * static_cast<std::int64_t>(taken_ + 1) > bytes_max_) return nullptr;
  if (taken_ == buffers_.size())
    buffers_.push_back(std::make_unique<gl::Buffer>(model_->context(), "exact pictures"));
  return buffers_[taken_++].get();
}

void ExactFrames::draw(render::Frame& frame, const MotionPath& path) {
  segments_.clear();
  poses_.clear();
  taken_ = 0;
  for (const MotionSegment& segment : path.segments) {
    auto& of_segment = segments_.emplace_back();
    for (const std::vector<shared::View>& views : segment.frames) {
      if (of_segment.empty() || !equal_views(poses_.back().views, views)) {
        Pose& pose = poses_.emplace_back(Pose{views});
        pose.pairs = static_cast<double>(frame.draw(views).pairs);
        pose.pictures = room_for(views);
        if (pose.pictures != nullptr) bytes_.keep(frame, views, *pose.pictures);
      }
      of_segment.push_back(poses_.size() - 1);
    }
  }
}

std::size_t ExactFrames::left_out() const {
  return static_cast<std::size_t>(
      std::count_if(poses_.begin(), poses_.end(), [](const Pose& pose) { return pose.pictures == nullptr; }));
}

std::vector<double> ExactFrames::psnr(const render::Frame& drawn, std::size_t segment, std::size_t n) {
  const Pose& exact = pose(segment, n);
  const gl::Buffer* wanted = exact.pictures;
  if (wanted == nullptr) {
    if (!again_) {
      again_ = std::make_unique<render::Frame>(model_);
      again_pictures_ = std::make_unique<gl::Buffer>(model_->context(), "exact pictures drawn again");
    }
    again_->draw(exact.views);
    bytes_.keep(*again_, exact.views, *again_pictures_);
    wanted = again_pictures_.get();
  }
  std::vector<double> db = bytes_.errors(drawn, exact.views, *wanted);
  for (double& value : db) value = -10.0 * std::log10(value);
  return db;
}

}  // namespace binosplat::lab
