#include <algorithm>
#include <bit>

#include "render/stages.h"

namespace binosplat::render {

namespace {

// Of the tiles along an axis, those of the picture.
std::uint32_t pixels_along(std::uint32_t tiles, std::uint32_t first, std::uint32_t pitch, std::uint32_t side,
                           std::uint32_t picture) {
  std::uint32_t pixels = 0;
  for (std::uint32_t k = 0; k < tiles; ++k) pixels += std::min(side, picture - (first + k * pitch));
  return pixels;
}

}  // namespace

void probe(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (!shape.probe) return;
  const glm::vec3& background = shape.settings.background;
  const shared::View& exact = shape.views.back();
  const auto side = static_cast<std::uint32_t>(shape.settings.tile_size);
  dispatcher.run(
      dispatcher.context().program("probe.comp", {{"TILE_SIZE", std::to_string(side)}}),
      gl::Work::threads(std::uint64_t{exact.tiles_x} * exact.tiles_y * side * side, THREADS),
      {{"Views", buffers.views}, {"Colours", buffers.colours}, {"FrameCounters", buffers.counters}},
      {{"probe", shape.view_count() - 1},
       {"probed", shape.probe->view},
       {"background_r", std::bit_cast<std::uint32_t>(background.r)},
       {"background_g", std::bit_cast<std::uint32_t>(background.g)},
       {"background_b", std::bit_cast<std::uint32_t>(background.b)}});
}

double probed_error(const FrameShape& shape, const shared::Counters& counters) {
  const double sum = (static_cast<double>(counters.probe_high) * 0x1p32 + counters.probe_low) / PROBE_SCALE;
  const shared::View& exact = shape.views.back();
  const auto side = static_cast<std::uint32_t>(shape.settings.tile_size);
  const double across = pixels_along(exact.tiles_x, exact.shift_x, exact.pitch, side, exact.width);
  return sum / (3.0 * across * pixels_along(exact.tiles_y, exact.shift_y, exact.pitch, side, exact.height));
}

}  // namespace binosplat::render
