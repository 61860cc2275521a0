#include "render/squared_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "shared/limits.h"

namespace binosplat::render {

SquaredError::SquaredError(gl::Context& context, std::span<const Picture> wanted, std::uint32_t levels)
    : dispatcher_(context),
      wanted_(context, "wanted colours"),
      sums_(context, "squared errors"),
      levels_(levels) {
  std::vector<glm::vec4> colours;
  for (const Picture& picture : wanted)
    colours.insert(colours.end(), picture.colour.begin(), picture.colour.end());
  wanted_.upload(colours);
  pixels_ = static_cast<std::uint32_t>(colours.size());
  sums_.reserve(static_cast<std::int64_t>(pixels_ / THREADS + 1) * 4);
}

SquaredError::SquaredError(gl::Context& context) : SquaredError(context, {}) {}

void SquaredError::add(const gl::Buffer& colours, std::uint32_t pixels) {
  add_window(colours, {pixels, 1}, pixels_, pixels);
}

void SquaredError::add_window(const gl::Buffer& colours, glm::uvec2 size, std::uint32_t first,
                              std::uint32_t pitch) {
  constexpr std::int64_t each = sizeof(glm::vec4);
  pixels_ = std::max(pixels_, first + (size.y - 1) * pitch + size.x);
  wanted_.grow(pixels_ * each);
  for (std::uint32_t row = 0; row < size.y; ++row) {
    const std::int64_t from = std::int64_t{row} * size.x, to = first + std::int64_t{row} * pitch;
    wanted_.copy(colours, from * each, size.x * each, to * each);
  }
  sums_.reserve(static_cast<std::int64_t>(pixels_ / THREADS + 1) * 4);
}

double SquaredError::mean(const gl::Buffer& colours) {
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("squared error");
  dispatcher_.run(dispatcher_.context().program("squared_error.comp"), gl::Work::threads(pixels_, THREADS),
                  {{"Colours", colours}, {"Wanted", wanted_}, {"Sums", sums_}},
                  {{"pixel_count", pixels_}, {"levels", levels_}});
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  const auto parts = sums_.read<float>((pixels_ + THREADS - 1) / THREADS);
  return std::accumulate(parts.begin(), parts.end(), 0.0) / (3.0 * pixels_);
}

double SquaredError::psnr(const gl::Buffer& colours) { return -10.0 * std::log10(mean(colours)); }

}  // namespace binosplat::render
