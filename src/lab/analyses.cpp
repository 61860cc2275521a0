#include "lab/analyses.h"

#include <fmt/core.h>

#include "lab/bench.h"
#include "lab/fields.h"
#include "lab/settings.h"
#include "render/frame.h"

namespace binosplat::lab {

static void fields(const auto& io, const AnalysedSystem& s) {
  io("mean_db", s.mean_db, "worst_db", s.worst_db, "worst_view", s.worst_view, "pairs_removed",
     s.pairs_removed, "target_db", s.target_db, "reached_db", s.reached_db, "name", s.name, "settings",
     named(s.settings), "frame_ms", s.times.frame_ms, "pairs", s.times.pairs, "stages_ms", s.times.stages);
}

static void fields(const auto& io, const SkippingCurve::Point& p) {
  io("share", p.share, "psnr_db", p.psnr_db, "drop_db", p.drop_db);
}

static void fields(const auto& io, const SkippingCurve& c) { io("by", c.by, "points", c.points); }

static void fields(const auto& io, const Spread& s) {
  io("median", s.median, "p90", s.p90, "largest", s.largest);
}

static void fields(const auto& io, const DepthBin& b) {
  io("from", b.from, "to", b.to, "gaussians", b.gaussians, "light", b.transmittance, "upper", b.bound);
}

namespace {

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
  const char *name, *rule;
} threshold_systems[] = {{"AdaGScale", "peripheral, depth"},
                         {"AdaGScale, table fitted to the scene", "peripheral, depth, fitted"},
                         {"binosplat", "squared, last"}};

/// A system without its times.
AnalysedSystem system_of(const std::string& name, const render::FrameSettings& settings, Calibrator& tester,
                         const std::vector<CalibrationView>& views) {
  const Calibrator::Cost cost = tester.cost(settings);
  const std::string& worst = views[cost.worst_view].camera.name;
  return {cost.mean_db, cost.worst_db, worst, cost.pairs_removed, {}, {}, name, settings, {}};
}

std::vector<std::string> names_of(const std::vector<CalibrationView>& views) {
  std::vector<std::string> names;
  for (const CalibrationView& view : views) names.push_back(view.camera.name);
  return names;
}

/// `views` as the tester sees them, in the model's axes.
std::vector<ContributionView> some_of(const std::vector<CalibrationView>& views, const Calibrator& tester) {
  std::vector<ContributionView> some;
  for (const std::size_t i : spread_evenly(views.size(), contribution_views))
    some.push_back({views[i].camera.name, tester.views()[i], views[i].photo, views[i].exposure});
  return some;
}

/// A rule with its name; of the rules by depth the paper's has the table as the paper measures it.
struct AnalysedRule {
  std::string name;
  render::FrameSettings settings;
};

std::vector<AnalysedRule> analysed_rules(const Analysis& analysis, const std::vector<Rule>& wanted) {
  std::vector<AnalysedRule> rules;
  for (render::FrameSettings rule : calibrated_settings(wanted)) {
    rule.depth_table = analysis.depth_table;
    rules.push_back({describe_family(rule), rule});
    if (rule.th != TH_PERIPHERAL || rule.transmittance != TRANSMITTANCE_DEPTH) continue;
    rule.depth_table = analysis.fitted_table;
    rules.push_back({rules.back().name + ", fitted", rule});
  }
  return rules;
}

/// Every rule at every target, with the tolerance that `finder` finds in its views, as the tester sees it.
std::vector<AnalysedSystem> at_targets(Calibrator& finder, Calibrator& tester,
                                       const std::vector<CalibrationView>& test,
                                       std::vector<AnalysedRule> rules, const std::vector<double>& targets,
                                       const std::function<void()>& done) {
  std::vector<AnalysedSystem> all;
  for (const double target : targets) {
    for (auto& [name, settings] : rules) {
      const CalibrationEntry found = finder.find(settings, target);
      settings.tolerance = static_cast<float>(found.tolerance);
      AnalysedSystem& entry = all.emplace_back(system_of(name, settings, tester, test));
      entry.target_db = target;
      entry.reached_db = found.reached_db;
      if (!(found.tolerance > 0.0)) settings.tolerance = 1e-3f;  // where the next search begins
      done();
    }
  }
  return all;
}

/// The threshold systems at the middle target, as the entries of the targets have them.
std::vector<AnalysedSystem> from_targets(const std::vector<AnalysedSystem>& targets, double middle) {
  std::vector<AnalysedSystem> systems;
  for (const auto& system : threshold_systems) {
    for (const AnalysedSystem& entry : targets) {
      if (entry.target_db != middle || entry.name != system.rule) continue;
      systems.emplace_back(entry).name = fmt::format("{}, {:g} dB", system.name, middle);
    }
  }
  return systems;
}

}  // namespace

Analysis analyse(gl::Context& context, const Model& model, const std::vector<CalibrationView>& calibration,
                 const std::vector<CalibrationView>& test, const AnalysisSettings& settings,
                 const std::function<void(const std::string&, std::size_t, std::size_t)>& progress) {
  Calibrator calibrator(context, model, calibration, settings.near_plane, settings.kind, {settings.keep});
  Calibrator tester(context, model, test, settings.near_plane, settings.kind, {settings.keep});
  Analysis analysis{.device = device_text(context),
                    .scene = settings.scene,
                    .gaussians = model.count(),
                    .kind = settings.kind,
                    .calibration_views = names_of(calibration),
                    .test_views = names_of(test),
                    .width = test.front().camera.width,
                    .height = test.front().camera.height,
                    .calibration_photo_db = calibrator.exact_photo_db(),
                    .test_photo_db = tester.exact_photo_db(),
                    .depth_table = calibrator.depth_table({.far = settings.far}),
                    .fitted_table = calibrator.depth_table()};

  const auto some = some_of(test, tester);
  std::size_t done = 0;
  analysis.contributions = contributions(model, some, analysis.depth_table, analysis.fitted_table,
                                         [&] { progress("contributions", ++done, some.size()); });

  for (const auto& system : exact_systems)
    analysis.systems.push_back(system_of(system.name, {.tiles = system.tiles}, tester, test));

  const std::vector<AnalysedRule> rules = analysed_rules(analysis, settings.rules);
  done = 0;
  const auto one_more = [&] { progress("tolerances", ++done, 2 * settings.targets.size() * rules.size()); };
  analysis.found = at_targets(calibrator, tester, test, rules, settings.targets, one_more);
  analysis.tuned = at_targets(tester, tester, test, rules, settings.targets, one_more);

  std::vector<AnalysedSystem*> timed;
  std::vector<render::FrameSettings> all;
  for (auto* systems : {&analysis.systems, &analysis.tuned}) {
    for (AnalysedSystem& system : *systems) {
      timed.push_back(&system);
      all.push_back(system.settings);
    }
  }
  done = 0;
  const std::vector<Typical> times = time_in_turns(context, model, tester.views(), all, settings.frames, [&] {
    progress("timing", ++done, turn_rounds * all.size() * tester.views().size());
  });
  for (std::size_t k = 0; k < times.size(); ++k) timed[k]->times = times[k];
  for (AnalysedSystem& system : from_targets(analysis.tuned, settings.targets[settings.targets.size() / 2]))
    analysis.systems.push_back(std::move(system));
  render::Frame frame(context, model);
  for (AnalysedSystem& system : analysis.systems) {
    const int frames = render::measures(system.settings.transmittance) ? render::settling_frames : 1;
    for (int n = 0; n < frames; ++n) frame.draw(std::span(&tester.views()[0], 1), system.settings);
    system.picture = for_page(composite(frame.read_pictures().front(), glm::vec3(0.0f)));
  }
  return analysis;
}

nlohmann::ordered_json to_json(const Analysis& a) {
  auto json = object("format", "binosplat study", "version", 2, "device", a.device, "scene", a.scene,
                     "gaussians", a.gaussians, "target", a.drop() ? "drop" : "quality", "views",
                     object("calibration", a.calibration_views, "test", a.test_views, "chosen", a.chosen),
                     "width", a.width, "height", a.height);
  if (a.drop()) json["photo_db"] = object("calibration", a.calibration_photo_db, "test", a.test_photo_db);
  nlohmann::ordered_json distances;
  for (const reference::DistanceBin& bin : a.contributions.by_distance)
    distances.push_back(object("from", bin.from, "to", bin.to, "fragments", bin.fragments, "sum", bin.sum,
                               "largest", bin.largest));
  const auto table = [](const DepthTable& of) { return object("far", of.far, "upper", of.bounds); };
  FieldWriter{json}("depth_table", table(a.depth_table), "fitted_table", table(a.fitted_table),
                    "contributions",
                    object("skipping", a.contributions.skipping, "by_distance", distances, "by_depth",
                           a.contributions.by_depth),
                    "systems", a.systems, "found", a.found, "tuned", a.tuned);
  return json;
}

}  // namespace binosplat::lab
