#include "lab/turns.h"

#include "lab/times.h"

namespace binosplat::lab {

std::vector<Typical> time_in_turns(gl::Context& context, const Model& model,
                                   std::span<const shared::View> views,
                                   std::span<const render::FrameSettings> settings, int frames,
                                   const std::function<void()>& progress) {
  render::Frame frame(context, model);
  std::vector<Typical> results(settings.size());
  const double weight = 1.0 / (turn_rounds * static_cast<double>(views.size()));
  for (int round = 0; round < turn_rounds; ++round) {
    for (std::size_t k = 0; k < settings.size(); ++k) {
      Typical& result = results[k];
      for (const shared::View& view : views) {
        frame.forget();
        const int settling = render::measures(settings[k].transmittance) ? render::settling_frames : 1;
        for (int n = 0; n < settling; ++n) frame.draw(std::span(&view, 1), settings[k]);
        Run run;
        for (int n = 0; n < frames; ++n) run.add(frame.draw(std::span(&view, 1), settings[k]));
        result.frame_ms += weight * run.frame_ms();
        result.pairs += weight * run.pairs();
        if (result.stages.empty()) {
          for (const std::string& stage : run.stage_names()) result.stages.push_back({stage, 0.0});
        }
        for (gl::StageTime& stage : result.stages) stage.ms += weight * run.stage_ms(stage.name);
      }
      progress();
    }
  }
  return results;
}

}  // namespace binosplat::lab
