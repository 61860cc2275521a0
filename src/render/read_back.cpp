#include "render/read_back.h"

#include <utility>

namespace binosplat::render {

ReadBack::Pictures::Pictures(ReadBack& of) : of_(of) {
  const std::lock_guard lock(of.mutex_);
  if (of.free_.empty()) {
    copy_ = std::make_unique<Copy>(of.context_);
  } else {
    copy_ = std::move(of.free_.back());
    of.free_.pop_back();
  }
}

// Returns the buffers for reuse. Any thread may call this, but only the context's thread may destroy buffers.
ReadBack::Pictures::~Pictures() {
  const std::lock_guard lock(of_.mutex_);
  of_.free_.push_back(std::move(copy_));
}

std::unique_ptr<ReadBack::Pictures> ReadBack::start(const Frame& frame) {
  auto pictures = std::make_unique<Pictures>(*this);
  pictures->stood_in_ = frame.stand_in_pictures();
  if (!pictures->stood_in_.empty()) return pictures;
  const FramePlan& plan = frame.plan();
  pictures->views_.assign(plan.views.begin(), plan.views.begin() + plan.requested_views);
  pictures->has_depth_ = plan.depth() != DEPTH_NONE;
  const auto copy = [&](gl::Buffer& to, const gl::Buffer& from, std::int64_t bytes) {
    to.reserve(bytes);
    to.copy(from, 0, bytes, 0);
  };
  copy(pictures->copy_->colours, frame.colours(), plan.pixel_count * std::int64_t{sizeof(glm::vec4)});
  if (pictures->has_depth_)
    copy(pictures->copy_->z_sums, frame.z_sums(), plan.pixel_count * std::int64_t{sizeof(float)});
  pictures->copy_->done.set();
  return pictures;
}

std::vector<Picture> ReadBack::Pictures::take() const {
  if (!stood_in_.empty()) return stood_in_;
  std::vector<Picture> pictures;
  for (const shared::View& view : views_) {
    Picture& picture = pictures.emplace_back();
    picture.width = static_cast<int>(view.width);
    picture.height = static_cast<int>(view.height);
    const std::size_t count = std::size_t{view.width} * view.height;
    const auto colours = copy_->colours.mapped<glm::vec4>(count, view.pixel_offset);
    picture.colour.assign(colours.begin(), colours.end());
    if (!has_depth_) {
      picture.z_sum.resize(count);
      continue;
    }
    const auto z_sums = copy_->z_sums.mapped<float>(count, view.pixel_offset);
    picture.z_sum.assign(z_sums.begin(), z_sums.end());
  }
  return pictures;
}

}  // namespace binosplat::render
