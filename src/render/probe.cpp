#include <bit>

#include "render/stages.h"

namespace binosplat::render {

void probe(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers) {
  if (!shape.probe) return;
  const glm::vec3& background = shape.settings.background;
  const shared::View& strip = shape.views.back();
  const shared::View& view = shape.views[shape.probe->view];
  const std::uint32_t pixels = strip.width * strip.height;
  dispatcher.run(dispatcher.context().program("probe.comp"), gl::Work::threads(pixels, THREADS),
                 {{"Colours", buffers.colours}, {"FrameCounters", buffers.counters}},
                 {{"pixel_count", pixels},
                  {"exact_first", strip.pixel_offset},
                  {"judged_first", view.pixel_offset + shape.probe->first_row * view.width},
                  {"background_r", std::bit_cast<std::uint32_t>(background.r)},
                  {"background_g", std::bit_cast<std::uint32_t>(background.g)},
                  {"background_b", std::bit_cast<std::uint32_t>(background.b)}});
}

double probed_error(const FrameShape& shape, const shared::Counters& counters) {
  const double sum = (static_cast<double>(counters.probe_high) * 0x1p32 + counters.probe_low) / PROBE_SCALE;
  const shared::View& strip = shape.views.back();
  return sum / (3.0 * strip.width * strip.height);
}

}  // namespace binosplat::render
