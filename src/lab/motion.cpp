#include "lab/motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/log.h"
#include "base/statistics.h"
#include "lab/bench.h"  // spread_evenly
#include "lab/exact_frames.h"
#include "lab/fields.h"
#include "lab/settings.h"
#include "lab/wake.h"
#include "measure/depth_table.h"
#include "render/frame.h"

namespace binosplat::lab {

namespace {

constexpr std::size_t table_views = 16;

using nlohmann::ordered_json;
using Tell = std::function<void(const std::string&, std::size_t, std::size_t)>;

MotionPath without_stops(MotionPath path) {
  for (MotionSegment& segment : path.segments) {
    segment.frames.resize(segment.frames.size() - segment.stop);
    segment.stop = 0;
  }
  return path;
}

void summarise(const MotionPath& path, MovedPass& pass) {
  pass.lead = summary_of(frames_of(path, pass.frames, MotionPart::lead));
  pass.moving = summary_of(frames_of(path, pass.frames, MotionPart::moving));
  pass.stop = summary_of(frames_of(path, pass.frames, MotionPart::stop));
}

/// The frames of one model, along one path after the other.
class Drive {
 public:
  Drive(gl::Context& context, const Model& model, const MotionSettings& settings, const Tell& tell)
      : settings_(settings),
        tell_(tell),
        frame_(context, model),
        exact_(frame_.model(), settings.exact_bytes) {}

  /// Bounds by depth, for the rules that use them.
  void measure_table(const std::vector<MotionPath>& paths);
  MotionResult along(const MotionPath& path, const std::vector<Variant>& rules);

 private:
  render::FrameSettings settings_of(const Variant& variant, float request) const {
    render::FrameSettings settings = variant.settings();
    settings.depth_table = table_;
    settings.depth = Depth::none;
    if (!render::is_exact(variant.th)) settings.quality = request;
    return settings;
  }
  MovedPass judged(const MotionPath& path, const Variant& variant, float request);
  MovedPass exact_pass(const MotionPath& path) const;
  void bring_to_target(const MotionPath& path, MovedRule& rule);
  void time(MotionResult& result);

  const MotionSettings& settings_;
  const Tell& tell_;
  render::Frame frame_;
  ExactFrames exact_;
  render::DepthTable table_;
};

void Drive::measure_table(const std::vector<MotionPath>& paths) {
  std::vector<shared::View> ends, chosen;
  for (const MotionPath& path : paths) {
    for (const MotionSegment& segment : path.segments) {
      for (const auto* views : {&segment.frames.front(), &segment.frames.back()})
        ends.insert(ends.end(), views->begin(), views->end());
    }
  }
  for (const std::size_t k : spread_evenly(ends.size(), table_views)) chosen.push_back(ends[k]);
  table_ = measure::measure_depth_table(frame_, chosen);
}

MovedPass Drive::judged(const MotionPath& path, const Variant& variant, float request) {
  MovedPass pass{request, {}, {}, {}, {}};
  const render::FrameSettings settings = settings_of(variant, request);
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    frame_.start_over();
    auto& frames = pass.frames.emplace_back();
    for (std::size_t n = 0; n < path.segments[s].frames.size(); ++n) {
      const render::FrameReport report = frame_.draw(path.segments[s].frames[n], settings);
      frames.push_back({.view_db = exact_.psnr(frame_, s, n),
                        .told_db = report.quality,
                        .pairs = static_cast<double>(report.pairs),
                        .exact_pairs = exact_.pairs(s, n),
                        .tolerance = report.tolerance,
                        .drawn = report.attempts});
    }
  }
  summarise(path, pass);
  return pass;
}

MovedPass Drive::exact_pass(const MotionPath& path) const {
  MovedPass pass;
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    auto& frames = pass.frames.emplace_back();
    for (std::size_t n = 0; n < path.segments[s].frames.size(); ++n) {
      const std::vector<double> equal(path.segments[s].frames[n].size(),
                                      std::numeric_limits<double>::infinity());
      frames.push_back({.view_db = equal,
                        .told_db = std::numeric_limits<double>::infinity(),
                        .pairs = exact_.pairs(s, n),
                        .exact_pairs = exact_.pairs(s, n)});
    }
  }
  return pass;
}

void Drive::bring_to_target(const MotionPath& path, MovedRule& rule) {
  const MotionPath moving = without_stops(path);
  const auto off = [&](const MovedPass& pass) { return std::abs(pass.moving.true_db - settings_.target); };
  const auto value = [&](double request) {
    MovedPass pass = judged(moving, rule.variant, static_cast<float>(request));
    const double db = pass.moving.true_db;
    if (off(pass) < off(rule.at_target())) rule.equal = std::move(pass);
    return db;
  };
  const FoundRequest found = find_request(value, {.target = settings_.target,
                                                  .start = settings_.quality,
                                                  .start_value = rule.asked.moving.true_db,
                                                  .within = settings_.equal_within});
  rule.compared = true;
  rule.evaluations = found.evaluations;
  if (!found.reached)
    rule.problem = fmt::format("not within {} dB of {:g} dB", settings_.equal_within, settings_.target);
}

// What is timed: frames drawn without a word, and where their times go.
struct TimedMotion {
  const MotionPath* path;
  render::FrameSettings settings;
  MovedPass* into;
  std::vector<std::vector<std::vector<double>>> ms;  // by segment, frame and round
  std::size_t differs = 0;  // frames that made other pairs than when they were judged
};

void draw_segment(render::Frame& frame, TimedMotion& timed, std::size_t s) {
  const MotionSegment& segment = timed.path->segments[s];
  frame.start_over();
  for (std::size_t n = 0; n < segment.frames.size(); ++n) {
    const render::FrameReport report = frame.draw(segment.frames[n], timed.settings);
    timed.ms[s][n].push_back(report.total_ms);
    timed.differs += static_cast<double>(report.pairs) != timed.into->frames[s][n].pairs;
  }
}

void Drive::time(MotionResult& result) {
  const MotionPath moving = without_stops(result.path);
  std::vector<TimedMotion> all = {{&result.path, settings_of({.th = TH_TAU}, 0.0f), &result.exact, {}, 0}};
  for (MovedRule& rule : result.rules) {
    all.push_back({&result.path, settings_of(rule.variant, rule.asked.request), &rule.asked, {}, 0});
    if (rule.equal)
      all.push_back({&moving, settings_of(rule.variant, rule.equal->request), &*rule.equal, {}, 0});
  }
  const std::size_t segments = result.path.segments.size();
  for (TimedMotion& timed : all) {
    for (const MotionSegment& segment : timed.path->segments) timed.ms.emplace_back(segment.frames.size());
  }
  // It slept while sums were read.
  wake(frame_.model()->context(), 1000.0, [&] { frame_.draw(result.path.segments.front().frames.front()); });
  std::size_t done = 0;
  for (int round = 0; round < settings_.rounds; ++round) {
    for (std::size_t s = 0; s < segments; ++s) {
      for (TimedMotion& timed : all) {
        draw_segment(frame_, timed, s);
        tell_(result.path.name + ": timing", ++done, settings_.rounds * segments * all.size());
      }
    }
  }
  for (const TimedMotion& timed : all) {
    for (std::size_t s = 0; s < segments; ++s) {
      for (std::size_t n = 0; n < timed.ms[s].size(); ++n)
        timed.into->frames[s][n].ms = quantile(timed.ms[s][n], 0.5);
    }
    summarise(*timed.path, *timed.into);
    if (timed.differs > 0)
      log_warning("{}: {} frames timed are not those that were judged", result.path.name, timed.differs);
  }
}

MotionResult Drive::along(const MotionPath& path, const std::vector<Variant>& rules) {
  exact_.draw(frame_, path);
  if (exact_.left_out() > 0)
    log_info("{}: {} exact frames have no room and are drawn again for each rule", path.name,
             exact_.left_out());
  MotionResult result{path, exact_pass(path), {}};
  std::size_t done = 0;
  for (const Variant& variant : rules) {
    MovedRule& rule = result.rules.emplace_back(MovedRule{variant, judged(path, variant, settings_.quality)});
    if (settings_.equal) bring_to_target(path, rule);
    tell_(path.name + ": rules", ++done, rules.size());
  }
  time(result);
  return result;
}

// The pass of the rule that `rule` is compared with; none where it is not among them.
const MovedRule* one_of(const MotionResult& result, const MovedRule& rule) {
  const auto found = std::find_if(result.rules.begin(), result.rules.end(), [&](const MovedRule& other) {
    return other.variant.th == rule.variant.th && other.variant.transmittance == TRANSMITTANCE_ONE;
  });
  return found == result.rules.end() ? nullptr : &*found;
}

std::optional<double> share(double value, double of) {
  return of > 0.0 ? std::optional(value / of) : std::nullopt;
}

ordered_json pass_json(const MovedPass& pass, const MovedShares& shares) {
  return object("request_db", pass.request, "moving", to_json(pass.moving), "lead", to_json(pass.lead),
                "stop", to_json(pass.stop), "ms_of_exact", shares.ms_of_exact.value_or(NAN), "ms_of_one",
                shares.ms_of_one.value_or(NAN), "pairs_of_one", shares.pairs_of_one.value_or(NAN), "segments",
                to_json(pass.frames));
}

ordered_json path_json(const MotionResult& result) {
  ordered_json json = {{"name", result.path.name}, {"motion", result.path.motion}};
  for (const MotionSegment& segment : result.path.segments)
    json["lengths"].push_back(object("lead", segment.lead, "moving", segment.moving(), "stop", segment.stop));
  json["exact"] = object("moving", to_json(result.exact.moving), "segments", to_json(result.exact.frames));
  for (const MovedRule& rule : result.rules) {
    ordered_json settings = to_json(rule.variant.settings());
    settings.erase("tolerance");  // each frame chooses its own
    json["rules"].push_back(object("name", rule.variant.name(), "settings", settings, "asked",
                                   pass_json(rule.asked, shares(result, rule, false))));
    if (!rule.compared) continue;
    ordered_json& at_target = json["rules"].back()["at_target"] =
        pass_json(rule.at_target(), shares(result, rule, true));
    FieldWriter{at_target}("evaluations", rule.evaluations, "problem", rule.problem);
  }
  return json;
}

}  // namespace

std::vector<MotionResult> measure_motion(gl::Context& context, const Model& model,
                                         const std::vector<MotionPath>& paths, std::vector<Variant> rules,
                                         const MotionSettings& settings, const Tell& progress) {
  std::erase_if(rules, [](const Variant& rule) { return render::is_exact(rule.th); });
  Drive drive(context, model, settings, progress);
  const auto by_depth = [](const Variant& rule) { return rule.transmittance == TRANSMITTANCE_DEPTH; };
  if (std::any_of(rules.begin(), rules.end(), by_depth)) drive.measure_table(paths);
  std::vector<MotionResult> results;
  for (const MotionPath& path : paths) results.push_back(drive.along(path, rules));
  return results;
}

MovedShares shares(const MotionResult& result, const MovedRule& rule, bool at_target) {
  const auto moving = [&](const MovedRule& of) { return (at_target ? of.at_target() : of.asked).moving; };
  const MotionSummary of_rule = moving(rule);
  const MovedRule* one = one_of(result, rule);
  const MotionSummary of_one = one == nullptr ? MotionSummary{} : moving(*one);
  return {share(of_rule.ms, result.exact.moving.ms), share(of_rule.ms, of_one.ms),
          share(of_rule.pairs, of_one.pairs)};
}

ordered_json to_json(const MotionStudy& s) {
  ordered_json json = object("format", "binosplat motion", "version", 1, "device", s.device, "scene", s.scene,
                             "gaussians", s.gaussians, "eyes", s.eyes, "width", s.width, "height", s.height,
                             "frames_per_second", s.frames_per_second, "units_per_metre", s.units_per_metre,
                             "metre_source", s.metre_source, "quality_db", s.settings.quality, "target_db",
                             s.settings.target, "equal_pictures_db", equal_db, "rounds", s.settings.rounds);
  for (const MotionResult& result : s.paths) json["paths"].push_back(path_json(result));
  return json;
}

}  // namespace binosplat::lab
