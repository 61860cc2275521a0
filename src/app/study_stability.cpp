// binosplat study --stability.

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/study_parts.h"
#include "base/error.h"
#include "base/progress.h"
#include "lab/fixed_camera.h"
#include "lab/stability_page.h"
#include "scene/axes.h"

namespace binosplat::app {

using lab::Variant;

namespace {

void find_tolerances(lab::FixedCamera& camera, double target, std::vector<Variant>& variants) {
  Progress progress("tolerances", variants.size());
  for (std::size_t k = 0; k < variants.size(); ++k) {
    variants[k].tolerance = camera.tolerance_at(variants[k], target);
    progress.update(k + 1);
  }
}

void print_case(const lab::StabilityCase& one, const std::vector<Variant>& variants,
                const std::vector<lab::StabilityResult>& results) {
  fmt::print("\n## {}: {}\n\n", one.name, one.fear);
  fmt::print(
      "| rule | worst dB (frame) | settled dB | frames to settle | largest, p99 error | signed | edges | "
      "disagreement dB | removed | verdict |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < variants.size(); ++k) {
    const lab::StabilityResult& r = results[k];
    fmt::print(
        "| {} | {:.1f} ({}) | {:.1f} | {} | {:.3f}, {:.3f} | {:+.4f} | {:.2f} | {:.1f} | {:.1f} % | {} |\n",
        variants[k].name(), r.worst_db, r.worst_frame, r.settled_db, r.settling, r.largest, r.p99,
        r.signed_mean, r.edges, r.disagreement_db, 100.0 * r.removed, r.verdict);
  }
  std::fflush(stdout);
}

void check_cases(const std::vector<std::string>& wanted, const std::vector<lab::StabilityCase>& cases) {
  for (const std::string& name : wanted) {
    std::string names;
    bool known = false;
    for (const lab::StabilityCase& one : cases) {
      known = known || one.name == name;
      names += "\n  " + one.name;
    }
    if (!known) fail("--case {}: there is no such case. There are:{}", name, names);
  }
}

}  // namespace

void study_stability(gl::Context& context, const StudyOptions& options, const Studied& studied) {
  const Camera head = into_axes(studied.shots.front().eyes.front().camera, studied.model->axes);
  const stereo::RigSettings settings = rig_settings(options.rig, {}, studied.near_plane);
  auto cases = lab::built_in_cases();
  for (auto& one : lab::cases_in(studied.model, head, settings)) cases.push_back(std::move(one));
  check_cases(options.cases, cases);
  lab::StabilityStudy study{
      options.scene.name, lab::device_text(context), options.target, {}, lab::all_variants(), {}};
  std::vector<Variant>& variants = study.rules;
  {
    const stereo::EyePair eyes = stereo::make_rig(head, settings);
    lab::FixedCamera camera(context, *studied.model, {eyes.views.begin(), eyes.views.end()});
    find_tolerances(camera, options.target, variants);
  }

  fmt::print("Tolerances for {} dB on {}, {} at {} x {} px an eye:\n\n", options.target, options.scene.name,
             head.name, head.width, head.height);
  for (const Variant& variant : variants) fmt::print("- {}: {:.4g}\n", variant.name(), variant.tolerance);
  for (const lab::StabilityCase& one : cases) {
    if (!options.cases.empty() &&
        std::find(options.cases.begin(), options.cases.end(), one.name) == options.cases.end()) {
      continue;
    }
    Progress progress(one.name, variants.size());
    std::size_t done = 0;
    study.cases.push_back({one.name, one.fear, lab::run_case(context, one, variants, study.bounds, [&] {
                             progress.update(++done);
                           })});
    print_case(one, variants, study.cases.back().results);
  }
  save(options, to_json(study), stability_page(study));
}

}  // namespace binosplat::app
