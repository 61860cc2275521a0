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
#include "lab/timed_rounds.h"
#include "measure/depth_table.h"
#include "render/frame.h"

namespace binosplat::lab {

namespace {

constexpr std::size_t table_views = 16;

using nlohmann::ordered_json;
using ProgressOf = std::function<void(const std::string&, std::size_t, std::size_t)>;

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
  Drive(gl::Context& context, const Model& model, const MotionSettings& settings, const ProgressOf& progress)
      : settings_(settings),
        progress_(progress),
        frame_(context, model),
        exact_(frame_.model(), settings.exact_bytes) {}

  /// Bounds by depth, for the rules that use them.
  void measure_table(const std::vector<MotionPath>& paths);
  MotionResult along(const MotionPath& path, const std::vector<Rule>& rules);

 private:
  render::FrameSettings settings_of(const Rule& rule, float request) const {
    render::FrameSettings settings = rule.settings();
    settings.depth_table = table_;
    settings.depth = Depth::none;
    if (!render::is_exact(rule.th)) settings.quality = request;
    return settings;
  }
  MovedPass judged(const MotionPath& path, const Rule& rule, float request);
  MovedPass exact_pass(const MotionPath& path) const;
  void bring_to_target(const MotionPath& path, MovedRule& rule);
  void time(MotionResult& result);

  const MotionSettings& settings_;
  const ProgressOf& progress_;
  render::Frame frame_;
  ExactFrames exact_;
  DepthTable table_;
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

MovedPass Drive::judged(const MotionPath& path, const Rule& rule, float request) {
  MovedPass pass{request, {}, {}, {}, {}};
  const render::FrameSettings settings = settings_of(rule, request);
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    frame_.start_over();
    auto& frames = pass.frames.emplace_back();
    for (std::size_t n = 0; n < path.segments[s].frames.size(); ++n) {
      const render::FrameReport report = frame_.draw(path.segments[s].frames[n], settings);
      frames.push_back({.view_db = exact_.psnr(frame_, s, n),
                        .reported_db = report.quality,
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
                        .reported_db = std::numeric_limits<double>::infinity(),
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
    MovedPass pass = judged(moving, rule, static_cast<float>(request));
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

void Drive::time(MotionResult& result) {
  const MotionPath moving = without_stops(result.path);
  struct Pass {
    const MotionPath* path;
    render::FrameSettings settings;
    MovedPass* into;
  };
  std::vector<Pass> passes = {{&result.path, settings_of({.th = TH_TAU}, 0.0f), &result.exact}};
  for (MovedRule& rule : result.rules) {
    passes.push_back({&result.path, settings_of(rule, rule.asked.request), &rule.asked});
    if (rule.equal) passes.push_back({&moving, settings_of(rule, rule.equal->request), &*rule.equal});
  }
  // Segment by segment, pass after pass.
  std::vector<Timed> all;
  for (std::size_t s = 0; s < result.path.segments.size(); ++s) {
    for (const Pass& pass : passes) {
      const auto& frames = pass.path->segments[s].frames;
      all.push_back({static_cast<int>(frames.size()), [this](int) { frame_.start_over(); },
                     [&](int n) { return frame_.draw(frames[static_cast<std::size_t>(n)], pass.settings); }});
    }
  }
  std::size_t done = 0, differs = 0;
  const auto rounds = timed_rounds(frame_.model()->context(), settings_.rounds, all, [&] {
    progress_(result.path.name + ": timing", ++done, settings_.rounds * all.size());
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& frames = passes[k % passes.size()].into->frames[k / passes.size()];
    for (std::size_t n = 0; n < frames.size(); ++n) {
      std::vector<double> ms;
      for (const Reports& turn : rounds[k]) {
        ms.push_back(turn[n].total_ms);
        differs += static_cast<double>(turn[n].pairs) != frames[n].pairs;
      }
      frames[n].ms = quantile(std::move(ms), 0.5);
    }
  }
  for (const Pass& pass : passes) summarise(*pass.path, *pass.into);
  if (differs > 0)
    log_warning("{}: {} frames timed are not those that were judged", result.path.name, differs);
}

MotionResult Drive::along(const MotionPath& path, const std::vector<Rule>& rules) {
  exact_.draw(frame_, path);
  if (exact_.left_out() > 0)
    log_info("{}: {} exact frames have no room and are drawn again for each rule", path.name,
             exact_.left_out());
  MotionResult result{path, exact_pass(path), {}};
  std::size_t done = 0;
  for (const Rule& rule : rules) {
    MovedRule& moved = result.rules.emplace_back(MovedRule{rule, judged(path, rule, settings_.quality)});
    if (settings_.equal) bring_to_target(path, moved);
    progress_(path.name + ": rules", ++done, rules.size());
  }
  time(result);
  return result;
}

// The pass of the rule that `rule` is compared with; none where it is not among them.
const MovedRule* one_of(const MotionResult& result, const MovedRule& rule) {
  const auto found = std::find_if(result.rules.begin(), result.rules.end(), [&](const MovedRule& other) {
    return other.th == rule.th && other.transmittance == TRANSMITTANCE_ONE;
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
    ordered_json settings = to_json(rule.settings());
    settings.erase("tolerance");  // each frame chooses its own
    json["rules"].push_back(object("name", rule.name(), "settings", settings, "asked",
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
                                         const std::vector<MotionPath>& paths, std::vector<Rule> rules,
                                         const MotionSettings& settings, const ProgressOf& progress) {
  std::erase_if(rules, [](const Rule& rule) { return render::is_exact(rule.th); });
  Drive drive(context, model, settings, progress);
  const auto by_depth = [](const Rule& rule) { return rule.transmittance == TRANSMITTANCE_DEPTH; };
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
