// What can be read of the last frame.

#include <algorithm>
#include <span>

#include "base/error.h"
#include "render/frame.h"
#include "render/stages.h"

namespace binosplat::render {

std::vector<Picture> Frame::read_pictures() {
  if (!pictures_stood_in_.empty()) return pictures_stood_in_;
  const auto pixels = static_cast<std::size_t>(shape_.pixel_count);
  const auto colours = buffers_.colours.read<glm::vec4>(pixels);
  const auto z_sums = buffers_.z_sums.read<float>(pixels);
  std::vector<Picture> pictures;
  for (const shared::View& view : std::span(shape_.views).first(shape_.asked)) {
    Picture& picture = pictures.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height));
    std::copy_n(colours.begin() + view.pixel_offset, picture.colour.size(), picture.colour.begin());
    std::copy_n(z_sums.begin() + view.pixel_offset, picture.z_sum.size(), picture.z_sum.begin());
  }
  return pictures;
}

std::vector<Image> Frame::read_shown(int what) {
  if (!pictures_stood_in_.empty())
    fail("--show {}: the GPU does not walk the lists of --reference-until blend", show_choices[what].name);
  show(dispatcher_, shape_, buffers_, what);
  const auto shown = buffers_.shown.read<float>(static_cast<std::size_t>(shape_.pixel_count));
  std::vector<Image> images;
  for (const shared::View& view : std::span(shape_.views).first(shape_.asked)) {
    Image& image = images.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height), 1);
    std::copy_n(shown.begin() + view.pixel_offset, image.data.size(), image.data.begin());
  }
  return images;
}

// What was measured in a view, a T a slot: take(Gaussian, T) of those drawn.
template <typename T, typename Take>
void Frame::read_drawn(std::uint32_t v, const Take& take) const {
  const DrawnBuffers& drawn = *buffers_.drawn[shape_.views.at(v).order_group];
  const auto count = drawn.arguments.read<shared::DispatchArguments>(1).front().count;
  const auto indices = drawn.indices.read<std::uint32_t>(count);
  const std::size_t views = shape_.view_count();
  const auto coverages = buffers_.coverages.read<std::uint32_t>(count * views);
  const auto measured = buffers_.measured.read<T>(count, std::size_t{v} * shape_.slots);
  for (std::size_t slot = 0; slot < count; ++slot) {
    if (coverages[slot * views + v] != 0) take(indices[slot], measured[slot]);
  }
}

std::vector<MeasuredGaussian> Frame::read_measured(std::uint32_t v) const {
  if (!shape_.records || uploads_ != model_->uploads()) return {};
  const shared::View& view = shape_.views.at(v);
  std::vector<MeasuredGaussian> measured;
  read_drawn<float>(v, [&](std::uint32_t i, float most) {
    const glm::vec3 p = model_->model().position[i] - glm::vec3(view.anchor);
    const float depth = shape_.perspective.projection == PROJECTION_TANGENT
                            ? glm::length(p - glm::vec3(view.eye))
                            : glm::dot(glm::vec3(view.row_z), p) + view.row_z.w;
    measured.push_back({i, depth, most});
  });
  return measured;
}

std::vector<WeighedGaussian> Frame::read_weights(std::uint32_t v) const {
  if (!shape_.settings.weigh || uploads_ != model_->uploads()) return {};
  std::vector<WeighedGaussian> weights;
  read_drawn<std::uint64_t>(v, [&](std::uint32_t i, std::uint64_t steps) {
    weights.push_back({i, static_cast<double>(steps) / WEIGHT_SCALE});
  });
  return weights;
}

}  // namespace binosplat::render
