#include <algorithm>

#include "render/stages.h"

namespace binosplat::render {

namespace {

// The number of the picture's pixels in the sampled tiles along an axis.
std::uint32_t pixels_along(std::uint32_t tiles, std::uint32_t first, std::uint32_t pitch,
                           std::uint32_t picture) {
  std::uint32_t pixels = 0;
  for (std::uint32_t k = 0; k < tiles; ++k)
    pixels += std::min(std::uint32_t{TILE_SIZE}, picture - (first + k * pitch));
  return pixels;
}

}  // namespace

void probe(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers) {
  if (!plan.probe) return;
  const shared::View& exact = plan.views.back();
  dispatcher.run(dispatcher.context().program("probe.comp"),
                 gl::DispatchSize::threads(
                     std::uint64_t{exact.tiles_x} * exact.tiles_y * TILE_SIZE * TILE_SIZE, THREADS),
                 {{"Frame", buffers.parameters},
                  {"Views", buffers.views},
                  {"Colours", buffers.pictures.colours},
                  {"Ranges", buffers.lists.tile_ranges},
                  {"FrameCounters", buffers.counters}});
}

ProbeResult probe_result(const FramePlan& plan, const shared::Counters& counters) {
  const auto sum_of = [](std::uint32_t low, std::uint32_t high) {
    return (high * 0x1p32 + low) / PROBE_SCALE;
  };
  const double sum = sum_of(counters.probe_low, counters.probe_high);
  const double squares = sum_of(counters.probe_squares_low, counters.probe_squares_high);
  const shared::View& exact = plan.views.back();
  const double pixels =
      static_cast<double>(pixels_along(exact.tiles_x, exact.shift_x, exact.pitch, exact.width)) *
      pixels_along(exact.tiles_y, exact.shift_y, exact.pitch, exact.height);
  const double parts = std::max(1.0, pixels / THREADS);
  const double unevenness = sum > 0.0 ? std::max(0.0, parts * squares / (sum * sum) - 1.0) : 0.0;
  return {.squared_error = sum / (3.0 * pixels),
          .unevenness = unevenness,
          .tiles = static_cast<double>(exact.tiles_x) * exact.tiles_y,
          .pairs = static_cast<double>(plan.exact ? counters.probe_pairs : counters.probed_pairs),
          .exact_pairs = static_cast<double>(plan.exact ? counters.probed_pairs : counters.probe_pairs)};
}

}  // namespace binosplat::render
