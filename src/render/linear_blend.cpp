#include "render/linear_blend.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "render/stages.h"

namespace binosplat::render {

namespace {

/// GaussianInView::radius. Computed from Q and det C2, because the smaller eigenvalue of Q may be lost to
/// rounding.
float radius_of(const shared::Splat& splat, const shared::View& view, Projection projection) {
  if (splat.depth < 0.0f) return std::numeric_limits<float>::infinity();
  const glm::dvec4 q = splat.conic, lens = view.lens;
  const double largest = 0.5 * (q.x + q.z + std::hypot(q.x - q.z, 2.0 * q.y));
  double ray = 1.0;  // |d|^2 in the splat's middle
  if (projection == Projection::tangent)
    ray += std::pow((splat.mean.x + 0.5 - lens.z) / lens.x, 2) +
           std::pow((splat.mean.y + 0.5 - lens.w) / lens.y, 2);
  return static_cast<float>(3.0 * q.w * std::sqrt(ray * largest));
}

}  // namespace

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
  set_lists(view, exact_of(settings), debug);
}

void LinearBlend::set_lists(const shared::View& view, const FrameSettings& settings,
                            const DebugOptions& debug) {
  frame_.draw_until(Stage::sort, std::span(&view, 1), settings, debug);
  plan_ = frame_.plan();
  plan_.settings.threshold = Threshold::exact;
  drawn_ = frame_.buffers().read_drawn(plan_, 0);
}

std::vector<GaussianInView> LinearBlend::measure(const shared::View& view, const FrameSettings& settings) {
  FrameSettings in_full = settings;
  in_full.precision = PRECISION_FULL;
  set_lists(view, in_full, {});
  FrameBuffers& buffers = frame_.buffers();
  const auto count = buffers.counters.read<shared::Counters>(1).front().tile_pairs;
  const auto values = buffers.lists.tile_values.read<std::uint32_t>(count);
  std::vector<std::int32_t> tiles(slots());
  const auto in_each = static_cast<std::int32_t>(
      settings.tiles == TILES_ALL ? plan_.views[0].tiles_x * plan_.views[0].tiles_y : 1);
  for (const glm::uvec2& range : buffers.lists.tile_ranges.read<glm::uvec2>(plan_.tile_count())) {
    for (std::uint32_t k = range.x; k < range.y; ++k) tiles[values[k]] += in_each;
  }
  const auto splats = buffers.projected.splats.read<shared::Splat>(slots());
  run([&] { blend_debug_view(dispatcher_, plan_, SHOW_TRANSMITTANCE, buffers); });  // measures max(T)
  const auto largest = buffers.pictures.debug_transmittance.read<float>(slots());
  set_picture(std::vector<glm::vec4>(static_cast<std::size_t>(plan_.pixel_count), {1, 0, 0, 0}));
  const std::vector<glm::dvec4> sums = transposed(1.0f);
  std::vector<GaussianInView> found;
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    const auto [index, slot] = drawn_[k];
    found.push_back({index, radius_of(splats[slot], view, plan_.perspective.projection), tiles[slot],
                     largest[slot], sums[k].x});
  }
  return found;
}

void LinearBlend::set_colours(std::span<const glm::vec3> colours) {
  if (colours.size() != drawn_.size()) throw std::logic_error("a colour for each Gaussian drawn");
  std::vector<glm::vec4> by_slot(slots());
  for (std::size_t k = 0; k < drawn_.size(); ++k) by_slot[drawn_[k].slot] = glm::vec4(colours[k], 0.0f);
  colours_.upload(by_slot);
  run([&] {
    recolour(dispatcher_, slots(), colours_, frame_.buffers());
    blend(dispatcher_, plan_, false, {}, frame_.buffers());
  });
}

std::vector<glm::vec4> LinearBlend::read_picture() {
  return frame_.buffers().pictures.colours.read<glm::vec4>(static_cast<std::size_t>(plan_.pixel_count));
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
  const std::vector<std::int64_t> by_slot =
      sums([&] { blend_transposed(dispatcher_, plan_, frame_.buffers(), static_cast<float>(scale), sums_); });
  std::vector<glm::dvec4> found(drawn_.size());
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    const std::int64_t* const of = &by_slot[std::size_t{4} * drawn_[k].slot];
    found[k] = glm::dvec4(of[0], of[1], of[2], of[3]) / scale;
  }
  return found;
}

std::vector<double> LinearBlend::changes() {
  const std::vector<std::int64_t> by_slot = sums([&] {
    blend(dispatcher_, plan_, false, {}, frame_.buffers());
    blend_changes(dispatcher_, plan_, frame_.buffers(), sums_);
  });
  std::vector<double> found;
  for (const DrawnGaussian& drawn : drawn_)
    found.push_back(static_cast<double>(by_slot[std::size_t{4} * drawn.slot]) / CHANGE_SCALE);
  return found;
}

}  // namespace binosplat::render
