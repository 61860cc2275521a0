#include "study/stability_page.h"

#include <fmt/core.h>

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

/// Which rules hold in which cases.
Section verdicts(const ordered_json& results) {
  Table table{{"rule", "loss", "cases that hold"}, {}};
  for (const auto& [name, one] : results["cases"].items()) table.columns.push_back(name);
  std::size_t best = 0;
  std::string steadiest;
  for (const auto& [rule, loss] : results["losses"].items()) {
    ordered_json row = {rule, loss, 0};
    std::size_t holds = 0;
    for (const auto& [name, one] : results["cases"].items()) {
      const ordered_json& verdict = one["rules"][rule]["verdict"];
      holds += verdict == "holds";
      row.push_back(verdict);
    }
    row[2] = holds;
    table.rows.push_back(std::move(row));
    if (holds <= best || rule == "tau") continue;
    best = holds;
    steadiest = rule;
  }
  std::string sentence =
      fmt::format("Each rule at the loss for {} dB on this scene, in {} cases made to break it",
                  results["target_db"].dump(), results["cases"].size());
  if (!steadiest.empty())
    sentence += fmt::format(": “{}” holds in {} of them, no rule but tau in more", steadiest, best);
  return {"verdicts", "Where thresholds hold", sentence + ".", {}, table, ""};
}

Section bounds(const ordered_json& results) {
  Table table{{"verdict: where it breaks", "bound"}, {}};
  for (const auto& [text, value] : results["bounds"].items()) table.rows.push_back({text, value});
  return {"bounds", "What a verdict follows from", "A case holds if none of these is broken.", {}, table, ""};
}

Section one_case(const std::string& name, const ordered_json& one) {
  Table table{{"rule", "worst dB", "in frame", "settled dB", "frames to settle", "largest error", "signed",
               "disagreement dB", "removed %", "verdict"},
              {}};
  for (const auto& [rule, r] : one["rules"].items()) {
    table.rows.push_back({rule, r["worst_db"], r["worst_frame"], r["settled_db"], r["settling_frames"],
                          r["largest_error"], r["mean_signed_error"], r["disagreement_db"],
                          100.0 * r["pairs_removed"].get<double>(), r["verdict"]});
  }
  return {"case-" + name, name, one["fear"].get<std::string>() + ".", {}, table, ""};
}

}  // namespace

Page stability_page(const ordered_json& results) {
  Page page;
  page.title = "Stability of thresholds on " + results["scene"].get<std::string>();
  page.data = results;
  page.facts = {{"device", results["device"]}, {"scene", results["scene"]}};
  page.sections = {verdicts(results), bounds(results)};
  page.sentence = page.sections.front().sentence;
  for (const auto& [name, one] : results["cases"].items()) page.sections.push_back(one_case(name, one));
  return page;
}

}  // namespace binosplat::study
