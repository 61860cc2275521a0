#include "render/squared_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "shared/limits.h"

namespace binosplat::render {

namespace {

constexpr std::uint32_t max_groups = 2048;  // the CPU reads back one sum per work group

}  // namespace

SquaredError::SquaredError(gl::Context& context, std::span<const Picture> wanted, std::uint32_t levels,
                           const glm::mat4x3& exposure)
    : dispatcher_(context),
      wanted_(context, "wanted colours"),
      sums_(context, "squared errors"),
      exposure_(context, "exposure"),
      levels_(levels) {
  std::vector<glm::vec4> colours;
  for (const Picture& picture : wanted)
    colours.insert(colours.end(), picture.colour.begin(), picture.colour.end());
  wanted_.upload(colours);
  const glm::mat3x4 rows = glm::transpose(exposure);
  exposure_.upload(std::vector<glm::vec4>{rows[0], rows[1], rows[2]});
  pixels_ = static_cast<std::uint32_t>(colours.size());
}

SquaredError::SquaredError(gl::Context& context) : SquaredError(context, {}) {}

void SquaredError::add(const gl::Buffer& colours, std::uint32_t pixels) {
  constexpr std::int64_t size = sizeof(glm::vec4);
  wanted_.grow((pixels_ + pixels) * size);
  wanted_.copy(colours, 0, pixels * size, pixels_ * size);
  pixels_ += pixels;
}

double SquaredError::mean(const gl::Buffer& colours) {
  const std::uint32_t groups = std::min<std::uint32_t>((pixels_ + THREADS - 1) / THREADS, max_groups);
  sums_.reserve(std::int64_t{max_groups} * 4);
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("squared error");
  dispatcher_.run(dispatcher_.context().program("squared_error.comp"), gl::DispatchSize::of_groups(groups),
                  {{"Colours", colours}, {"Wanted", wanted_}, {"Sums", sums_}, {"Exposure", exposure_}},
                  {{"pixel_count", pixels_}, {"group_count", groups}, {"levels", levels_}});
  dispatcher_.end_frame();
  const auto parts = sums_.read<float>(groups);
  return std::accumulate(parts.begin(), parts.end(), 0.0) / (3.0 * pixels_);
}

double SquaredError::psnr(const gl::Buffer& colours) { return -10.0 * std::log10(mean(colours)); }

}  // namespace binosplat::render
