#include "study/turns.h"

namespace binosplat::study {

std::vector<Times> time_in_turns(gl::Context& context, const Model& model,
                                 std::span<const shared::View> views,
                                 std::span<const render::FrameSettings> settings, int frames,
                                 const std::function<void()>& progress) {
  render::Frame frame(context, model);
  std::vector<Times> times(settings.size());
  for (int round = 0; round < turn_rounds; ++round) {
    for (std::size_t k = 0; k < settings.size(); ++k) {
      for (const shared::View& view : views) {
        frame.forget();
        const int settling = render::measures(settings[k].transmittance) ? render::settling_frames : 1;
        for (int n = 0; n < settling; ++n) frame.draw(std::span(&view, 1), settings[k]);
        for (int n = 0; n < frames; ++n) times[k].add(frame.draw(std::span(&view, 1), settings[k]));
      }
      progress();
    }
  }
  return times;
}

}  // namespace binosplat::study
