#include "lab/timed_rounds.h"

#include <algorithm>

#include "base/statistics.h"

namespace binosplat::lab {

namespace {

constexpr double wake_ms = 1000.0;

/// Of value(frame), if the frame has one.
template <typename Value>
double typical(const Reports& frames, const Value& value) {
  double sum = 0.0;
  for (const bool measures : {false, true}) {
    std::vector<double> values;
    for (const render::FrameReport& frame : frames) {
      if (frame.measured == measures) values.push_back(value(frame));
    }
    const auto count = static_cast<double>(values.size());
    if (!values.empty()) sum += count * quantile(std::move(values), 0.5);
  }
  return sum / static_cast<double>(frames.size());
}

double time_of_stage(const std::vector<gl::StageTime>& stages, const std::string& name) {
  const auto found = std::ranges::find(stages, name, &gl::StageTime::name);
  return found == stages.end() ? 0.0 : found->ms;
}

}  // namespace

std::vector<std::vector<Reports>> timed_rounds(const gl::Context& context, int rounds,
                                               std::span<const Timed> all,
                                               const std::function<void()>& progress) {
  std::vector<std::vector<Reports>> reports(all.size());
  wake(context, wake_ms, [&] { all.front().draw(0); });
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k].begin(round);
      Reports& turn = reports[k].emplace_back();
      for (int n = 0; n < all[k].frames; ++n) turn.push_back(all[k].draw(n));
      progress();
    }
  }
  return reports;
}

Typical typical_of(const Reports& frames) {
  Typical all{
      .frame_ms = typical(frames, [](const render::FrameReport& f) { return f.total_ms; }),
      .pairs = typical(frames, [](const render::FrameReport& f) { return static_cast<double>(f.pairs); })};
  const auto plain = std::ranges::find(frames, false, &render::FrameReport::measured);
  for (const gl::StageTime& stage : (plain == frames.end() ? frames.front() : *plain).stages) {
    all.stages.push_back({stage.name, typical(frames, [&](const render::FrameReport& f) {
                            return time_of_stage(f.stages, stage.name);
                          })});
  }
  return all;
}

Typical mean_of(std::span<const Typical> all) {
  Typical result{.stages = all.front().stages};
  for (gl::StageTime& stage : result.stages) stage.ms = 0.0;
  const double weight = 1.0 / static_cast<double>(all.size());
  for (const Typical& one : all) {
    result.frame_ms += weight * one.frame_ms;
    result.pairs += weight * one.pairs;
    for (gl::StageTime& stage : result.stages) stage.ms += weight * time_of_stage(one.stages, stage.name);
  }
  return result;
}

std::vector<Typical> time_in_turns(gl::Context& context, const Model& model,
                                   std::span<const shared::View> views,
                                   std::span<const render::FrameSettings> settings, int frames,
                                   const std::function<void()>& progress) {
  render::Frame frame(context, model);
  std::vector<Timed> all;
  for (const render::FrameSettings& one : settings) {
    for (const shared::View& view : views) {
      const auto draw = [&](int) { return frame.draw(std::span(&view, 1), one); };
      const auto settle = [&frame, draw,
                           count = render::measures(one.transmittance) ? render::settling_frames : 1](int) {
        frame.forget();
        for (int n = 0; n < count; ++n) draw(n);
      };
      all.push_back({frames, settle, draw});
    }
  }
  const auto reports = timed_rounds(context, turn_rounds, all, progress);
  std::vector<Typical> results;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    std::vector<Typical> turns;
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (const Reports& turn : reports[k * views.size() + v]) turns.push_back(typical_of(turn));
    }
    results.push_back(mean_of(turns));
  }
  return results;
}

}  // namespace binosplat::lab
