#include "lab/stability_page.h"

#include <fmt/core.h>

#include "lab/fields.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

/// Which rules hold in which cases.
Section verdicts(const StabilityStudy& study) {
  Table table{{"rule", "tolerance", "cases that hold"}, {}};
  for (const StabilityStudy::Case& one : study.cases) table.columns.push_back(one.name);
  std::size_t best = 0;
  std::string steadiest;
  for (std::size_t k = 0; k < study.rules.size(); ++k) {
    const Variant& rule = study.rules[k];
    auto& cells = table.rows.emplace_back(row(rule.name(), rule.tolerance, 0));
    std::size_t holds = 0;
    for (const StabilityStudy::Case& one : study.cases) {
      holds += one.results[k].verdict == "holds";
      cells.emplace_back(one.results[k].verdict);
    }
    cells[2] = holds;
    if (holds <= best || render::is_exact(rule.th)) continue;
    best = holds;
    steadiest = rule.name();
  }
  std::string sentence =
      fmt::format("Each rule at the tolerance for {} dB on this scene, in {} cases made to break it",
                  json_text(study.target), study.cases.size());
  if (!steadiest.empty())
    sentence += fmt::format(": “{}” holds in {} of them, no rule but tau in more", steadiest, best);
  return {"verdicts", "Where thresholds hold", sentence + ".", {}, table};
}

std::vector<std::vector<Cell>> bounds_of(const StabilityBounds& b) {
  return {row("dips: a frame below dB", b.worst_db),
          row("wrong: settled below dB", b.settled_db),
          row("drifts: the last third below the second by dB", b.drift_db),
          row("slow: more frames until within 1 dB", b.settling),
          row("darkens or brightens: mean signed error beyond", b.darkening),
          row("rivalry: disagreement below dB", b.disagreement_db)};
}

Section bounds(const StabilityStudy& study) {
  const Table table{{"verdict: where it breaks", "bound"}, bounds_of(study.bounds)};
  return {"bounds", "What a verdict follows from", "A case holds if none of these is broken.", {}, table};
}

Section one_case(const StabilityStudy& study, const StabilityStudy::Case& one) {
  Table table{{"rule", "worst dB", "in frame", "settled dB", "frames to settle", "largest error", "signed",
               "disagreement dB", "removed %", "verdict"},
              {}};
  for (std::size_t k = 0; k < study.rules.size(); ++k) {
    const StabilityResult& r = one.results[k];
    table.rows.push_back(row(study.rules[k].name(), r.worst_db, r.worst_frame, r.settled_db, r.settling,
                             r.largest, r.signed_mean, r.disagreement_db, 100.0 * r.removed, r.verdict));
  }
  return {"case-" + one.name, one.name, one.fear + ".", {}, table};
}

ordered_json result_json(const StabilityResult& r) {
  return object("verdict", r.verdict, "worst_db", r.worst_db, "worst_frame", r.worst_frame, "settled_db",
                r.settled_db, "drift_db", r.drift_db, "settling_frames", r.settling, "largest_error",
                r.largest, "p99_error", r.p99, "mean_signed_error", r.signed_mean, "edge_over_inside",
                r.edges, "disagreement_db", r.disagreement_db, "pairs_removed", r.removed);
}

}  // namespace

Page stability_page(const StabilityStudy& study) {
  Page page;
  page.title = "Stability of thresholds on " + study.scene;
  page.facts = {{"device", study.device}, {"scene", study.scene}};
  page.sections = {verdicts(study), bounds(study)};
  page.sentence = page.sections.front().sentence;
  for (const StabilityStudy::Case& one : study.cases) page.sections.push_back(one_case(study, one));
  return page;
}

ordered_json to_json(const StabilityStudy& study) {
  const ordered_json none = ordered_json::object();
  ordered_json json = object("scene", study.scene, "device", study.device, "target_db", study.target,
                             "bounds", none, "tolerances", none, "cases", none);
  for (const auto& bound : bounds_of(study.bounds))
    json["bounds"][std::get<std::string>(bound[0].value)] = bound[1];
  for (const Variant& rule : study.rules) json["tolerances"][rule.name()] = rule.tolerance;
  for (const StabilityStudy::Case& one : study.cases) {
    json["cases"][one.name]["fear"] = one.fear;
    for (std::size_t k = 0; k < study.rules.size(); ++k)
      json["cases"][one.name]["rules"][study.rules[k].name()] = result_json(one.results[k]);
  }
  return json;
}

}  // namespace binosplat::lab
