#include "render/linear_blend.h"

#include <array>
#include <stdexcept>

#include "render/stages.h"

namespace binosplat::render {

LinearBlend::LinearBlend(std::shared_ptr<GpuModel> model)
    : frame_(std::move(model)),
      dispatcher_(frame_.model()->context()),
      colours_(frame_.model()->context(), "colours by slot"),
      sums_(frame_.model()->context(), "sums of the transposed blend") {}

void LinearBlend::set_view(const shared::View& view, const FrameSettings& settings,
                           const Workings& workings) {
  frame_.draw_until(Stage::ranges, std::span(&view, 1), exact_of(settings), workings);
  drawn_ = frame_.buffers().read_drawn(frame_.shape(), 0);
}

template <typename Record>
void LinearBlend::run(const Record& record) {
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  record();
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  refuse_cut(dispatcher_.context(), frame_.buffers().counters.read<shared::Counters>(1).front());
}

void LinearBlend::set_colours(std::span<const glm::vec3> colours) {
  if (colours.size() != drawn_.size()) throw std::logic_error("a colour for each Gaussian drawn");
  const std::uint32_t slots = drawn_.empty() ? 0 : drawn_.back().slot + 1;
  std::vector<glm::vec4> by_slot(slots);
  for (std::size_t k = 0; k < drawn_.size(); ++k) by_slot[drawn_[k].slot] = glm::vec4(colours[k], 0.0f);
  colours_.upload(by_slot);
  run([&] {
    recolour(dispatcher_, slots, colours_, frame_.buffers());
    blend(dispatcher_, frame_.shape(), frame_.buffers());
  });
}

std::vector<glm::vec4> LinearBlend::read_picture() {
  return frame_.buffers().colours.read<glm::vec4>(static_cast<std::size_t>(frame_.shape().pixel_count));
}

std::vector<glm::dvec4> LinearBlend::transposed(float largest) {
  const std::size_t slots = drawn_.empty() ? 0 : drawn_.back().slot + 1;
  const double scale = TRANSPOSED_SCALE / static_cast<double>(largest);
  sums_.reserve_zeros(static_cast<std::int64_t>(slots) * 4 * 8);
  run([&] {
    blend_transposed(dispatcher_, frame_.shape(), frame_.buffers(), static_cast<float>(scale), sums_);
  });
  const auto sums = sums_.read<std::int64_t>(4 * slots);
  std::vector<glm::dvec4> found(drawn_.size());
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    for (int c = 0; c < 4; ++c) {
      const std::int64_t steps = sums[4 * drawn_[k].slot + static_cast<std::size_t>(c)];
      found[k][c] = static_cast<double>(steps) / scale;
    }
  }
  return found;
}

}  // namespace binosplat::render
