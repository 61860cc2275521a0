#include "study/analyses.h"

#include <fmt/core.h>

#include "study/bench.h"
#include "study/contributions.h"
#include "study/settings.h"
#include "study/turns.h"

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

// The float64 analysis takes seconds a view.
constexpr std::size_t contribution_views = 3;

/// The systems that differ in their tile test alone; those with a threshold follow from the targets.
const struct {
  const char* name;
  int tiles;
} exact_systems[] = {{"3D-GS", TILES_AABB},
                     {"GSCore", TILES_OBB},
                     {"Speedy-Splat", TILES_SNUG},
                     {"FlashGS, AdR-Gaussian", TILES_ELLIPSE}};
const struct {
  const char* name;
  int th, transmittance;
} threshold_systems[] = {{"AdaGScale", TH_PERIPHERAL, TRANSMITTANCE_DEPTH},
                         {"binosplat", TH_SQUARED, TRANSMITTANCE_LAST}};

ordered_json cost_json(const Calibrator::Cost& cost, const std::vector<CalibrationView>& views) {
  return {{"mean_db", cost.mean_db},
          {"worst_db", cost.worst_db},
          {"worst_view", views[cost.worst_view].camera.name},
          {"pairs_removed", cost.pairs_removed}};
}

void add_times(const Typical& times, ordered_json& into) {
  into["frame_ms"] = times.frame_ms;
  into["pairs"] = times.pairs;
  into["stages_ms"] = ordered_json::object();
  for (const gl::StageTime& stage : times.stages) into["stages_ms"][stage.name] = stage.ms;
}

ordered_json names_of(const std::vector<CalibrationView>& views) {
  ordered_json names = ordered_json::array();
  for (const CalibrationView& view : views) names.push_back(view.camera.name);
  return names;
}

/// `views` as the tester sees them, in the model's axes.
std::vector<ContributionView> some_of(const std::vector<CalibrationView>& views, const Calibrator& tester) {
  std::vector<ContributionView> some;
  for (const std::size_t i : spread_evenly(views.size(), contribution_views))
    some.push_back({views[i].camera.name, tester.views()[i], views[i].photo});
  return some;
}

/// The threshold systems at the middle target, as the entries of the targets have them.
ordered_json from_targets(const ordered_json& targets, const std::vector<double>& all) {
  ordered_json systems = ordered_json::array();
  for (const auto& system : threshold_systems) {
    for (const ordered_json& entry : targets) {
      const ordered_json& s = entry["settings"];
      if (entry["target_db"] != all[all.size() / 2] || s["th"] != th_choices[system.th].name ||
          s["transmittance"] != transmittance_choices[system.transmittance].name)
        continue;
      ordered_json& added = systems.emplace_back(entry);
      added["name"] = fmt::format("{}, {:g} dB", system.name, all[all.size() / 2]);
    }
  }
  return systems;
}

}  // namespace

ordered_json analyse(gl::Context& context, const Model& model,
                     const std::vector<CalibrationView>& calibration,
                     const std::vector<CalibrationView>& test, const AnalysisSettings& settings,
                     const std::function<void(const std::string&, std::size_t, std::size_t)>& progress) {
  const bool drop = settings.kind == CalibrationTarget::Kind::drop;
  Calibrator calibrator(context, model, calibration, settings.near_plane, settings.kind);
  Calibrator tester(context, model, test, settings.near_plane, settings.kind);
  const render::DepthTable table = calibrator.depth_table();

  ordered_json json = {{"format", "binosplat study"},
                       {"version", 1},
                       {"device", context.renderer()},
                       {"scene", settings.scene},
                       {"gaussians", model.count()},
                       {"target", drop ? "drop" : "quality"},
                       {"views", {{"calibration", names_of(calibration)}, {"test", names_of(test)}}},
                       {"width", test.front().camera.width},
                       {"height", test.front().camera.height}};
  if (drop)
    json["photo_db"] = {{"calibration", calibrator.exact_photo_db()}, {"test", tester.exact_photo_db()}};
  json["depth_table"] = {{"far", table.far}, {"upper", table.upper}};

  const auto some = some_of(test, tester);
  std::size_t done = 0;
  json["contributions"] =
      contributions(model, some, table, [&] { progress("contributions", ++done, some.size()); });

  std::vector<render::FrameSettings> all;
  json["systems"] = ordered_json::array();
  for (const auto& system : exact_systems) {
    all.push_back({.tiles = system.tiles});
    ordered_json& entry = json["systems"].emplace_back(cost_json(tester.cost(all.back()), test));
    entry["name"] = system.name;
    entry["settings"] = to_json(all.back());
  }

  std::vector<render::FrameSettings> rules = calibrated_settings();
  json["targets"] = ordered_json::array();
  done = 0;
  for (const double target : settings.targets) {
    for (render::FrameSettings& rule : rules) {
      rule.depth_table = table;
      const CalibrationEntry found = calibrator.find(rule, target);
      rule.loss = static_cast<float>(found.loss);
      ordered_json& entry = json["targets"].emplace_back(cost_json(tester.cost(rule), test));
      entry["target_db"] = target;
      entry["reached_db"] = found.reached_db;
      entry["name"] = describe_family(rule);
      entry["settings"] = to_json(rule);
      all.push_back(rule);
      if (!(found.loss > 0.0)) rule.loss = 1e-3f;  // where the next search begins
      progress("losses", ++done, settings.targets.size() * rules.size());
    }
  }

  done = 0;
  const std::vector<Typical> times = time_in_turns(context, model, tester.views(), all, settings.frames, [&] {
    progress("timing", ++done, turn_rounds * all.size());
  });
  const std::size_t exact = json["systems"].size();
  for (std::size_t k = 0; k < times.size(); ++k)
    add_times(times[k], k < exact ? json["systems"][k] : json["targets"][k - exact]);
  for (ordered_json& system : from_targets(json["targets"], settings.targets))
    json["systems"].push_back(std::move(system));
  return json;
}

}  // namespace binosplat::study
