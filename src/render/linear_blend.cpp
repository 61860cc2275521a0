#include "render/linear_blend.h"

#include <stdexcept>

#include "render/stages.h"

namespace binosplat::render {

LinearBlend::LinearBlend(std::shared_ptr<GpuModel> model)
    : frame_(model),
      dispatcher_(model->context()),
      colours_(model->context(), "colours by slot"),
      sums_(model->context(), "sums of the transposed blend") {}

template <typename Record>
void LinearBlend::run(const Record& record) {
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  record();
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  throw_if_truncated(dispatcher_.context(), frame_.buffers().counters.read<shared::Counters>(1).front());
}

void LinearBlend::set_view(const shared::View& view, const FrameSettings& settings,
                           const DebugOptions& debug) {
  frame_.draw_until(Stage::sort, std::span(&view, 1), exact_of(settings), debug);
  drawn_ = frame_.buffers().read_drawn(frame_.plan(), 0);
}

void LinearBlend::set_colours(std::span<const glm::vec3> colours) {
  if (colours.size() != drawn_.size()) throw std::logic_error("a colour for each Gaussian drawn");
  std::vector<glm::vec4> by_slot(slots());
  for (std::size_t k = 0; k < drawn_.size(); ++k) by_slot[drawn_[k].slot] = glm::vec4(colours[k], 0.0f);
  colours_.upload(by_slot);
  run([&] {
    recolour(dispatcher_, slots(), colours_, frame_.buffers());
    blend(dispatcher_, frame_.plan(), false, {}, frame_.buffers());
  });
}

std::vector<glm::vec4> LinearBlend::read_picture() {
  return frame_.buffers().pictures.colours.read<glm::vec4>(
      static_cast<std::size_t>(frame_.plan().pixel_count));
}

// Returns four sums per slot.
template <typename Record>
std::vector<std::int64_t> LinearBlend::sums(const Record& record) {
  sums_.reserve_zeros(std::int64_t{slots()} * 4 * 8);
  run(record);
  return sums_.read<std::int64_t>(std::size_t{4} * slots());
}

std::vector<glm::dvec4> LinearBlend::transposed(float largest) {
  const double scale = TRANSPOSED_SCALE / static_cast<double>(largest);
  const std::vector<std::int64_t> by_slot = sums([&] {
    blend_transposed(dispatcher_, frame_.plan(), frame_.buffers(), static_cast<float>(scale), sums_);
  });
  std::vector<glm::dvec4> found(drawn_.size());
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    const std::int64_t* const of = &by_slot[std::size_t{4} * drawn_[k].slot];
    found[k] = glm::dvec4(of[0], of[1], of[2], of[3]) / scale;
  }
  return found;
}

std::vector<double> LinearBlend::changes() {
  const std::vector<std::int64_t> by_slot = sums([&] {
    blend(dispatcher_, frame_.plan(), false, {}, frame_.buffers());
    blend_changes(dispatcher_, frame_.plan(), frame_.buffers(), sums_);
  });
  std::vector<double> found;
  for (const DrawnGaussian& drawn : drawn_)
    found.push_back(static_cast<double>(by_slot[std::size_t{4} * drawn.slot]) / CHANGE_SCALE);
  return found;
}

}  // namespace binosplat::render
