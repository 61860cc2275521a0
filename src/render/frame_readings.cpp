// Reads back the results of the last frame.

#include <algorithm>
#include <span>

#include "base/error.h"
#include "render/frame.h"
#include "render/stages.h"

namespace binosplat::render {

std::vector<Picture> Frame::read_pictures() const {
  if (!stand_in_pictures_.empty()) return stand_in_pictures_;
  if (!plan_.canvases.empty()) fail("the pictures are on the caller's canvases: read them there");
  const auto pixels = static_cast<std::size_t>(plan_.pixel_count);
  const auto colours = buffers_.pictures.colours.read<glm::vec4>(pixels);
  const bool has_depth = plan_.depth() != DEPTH_NONE;
  std::vector<float> z_sums;
  if (has_depth) z_sums = buffers_.pictures.z_sums.read<float>(pixels);
  std::vector<Picture> pictures;
  for (const shared::View& view : std::span(plan_.views).first(plan_.requested_views)) {
    Picture& picture = pictures.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height));
    std::copy_n(colours.begin() + view.pixel_offset, picture.colour.size(), picture.colour.begin());
    if (has_depth)
      std::copy_n(z_sums.begin() + view.pixel_offset, picture.z_sum.size(), picture.z_sum.begin());
  }
  return pictures;
}

std::vector<Image> Frame::read_debug_view(int what) {
  if (!stand_in_pictures_.empty())
    fail("`show` {} needs the GPU's lists: `reference_until` must end before blend", show_choices[what].name);
  blend_debug_view(dispatcher_, plan_, what, buffers_);
  throw_if_truncated(dispatcher_.context(), buffers_.counters.read<shared::Counters>(1).front());
  const auto values = buffers_.pictures.debug_values.read<float>(static_cast<std::size_t>(plan_.pixel_count));
  std::vector<Image> images;
  for (const shared::View& view : std::span(plan_.views).first(plan_.requested_views)) {
    Image& image = images.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height), 1);
    std::copy_n(values.begin() + view.pixel_offset, image.data.size(), image.data.begin());
  }
  return images;
}

std::vector<MeasuredGaussian> Frame::read_measured(std::uint32_t v) const {
  if (!measuring_.measures || !is_plain() || drawn_.front().uploads != model_->uploads()) return {};
  const shared::View& view = plan_.views.at(v);
  const std::vector<DrawnGaussian> drawn = buffers_.read_drawn(plan_, v);
  const auto largest =
      buffers_.transmittance.measured.read<float>(buffers_.slots, std::size_t{v} * buffers_.slots);
  std::vector<MeasuredGaussian> measured;
  for (const auto& [i, slot] : drawn) {
    const glm::vec3 p = model_->model().position[i] - glm::vec3(view.anchor);
    const float depth = plan_.perspective.projection == Projection::tangent
                            ? glm::length(p - glm::vec3(view.eye))
                            : glm::dot(glm::vec3(view.row_z), p) + view.row_z.w;
    measured.push_back({i, depth, largest[slot]});
  }
  return measured;
}

}  // namespace binosplat::render
