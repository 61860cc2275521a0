#include "app/measured_options.h"

#include "app/option_checks.h"
#include "base/choices.h"

namespace binosplat::app {

namespace {

/// Parses TH,SOURCE or adagscale.
lab::Rule rule_of(const std::string& text) {
  if (text == "adagscale") return {TH_PERIPHERAL, TRANSMITTANCE_DEPTH};
  std::string bare = text;
  std::erase(bare, ' ');
  if (std::ranges::count(bare, ',') != 1) fail("--rule {}: expected TH,SOURCE or adagscale", text);
  const std::size_t comma = bare.find(',');
  const std::string place = "--rule " + text, th = bare.substr(0, comma);
  const lab::Rule rule{th == "adagscale" ? TH_PERIPHERAL : find_choice(place, th, th_choices),
                       find_choice(place, bare.substr(comma + 1), transmittance_choices)};
  if (render::is_exact(rule.th)) fail("{}: {} is exact, and always measured", place, th);
  if (th == "adagscale" && rule.transmittance != TRANSMITTANCE_DEPTH)
    fail("{}: adagscale uses its table by depth: for another source name peripheral", place);
  return rule;
}

}  // namespace

void add_rule_option(CLI::App& sub, std::vector<std::string>& rules) {
  add_names_option(
      sub, "--rule", rules,
      "Measure only this rule: adagscale, or a value of `render --threshold` and\none of `--transmittance`, "
      "as in squared,last; repeat it for more (all);\nrules with `last` take longest",
      "TH,SOURCE");
}

std::vector<lab::Rule> rules_of(const std::vector<std::string>& texts) {
  std::vector<lab::Rule> rules;
  for (const std::string& text : texts) rules.push_back(rule_of(text));
  return rules.empty() ? lab::all_rules() : rules;
}

void add_measured_options(CLI::App& sub, MeasuredOptions& o) {
  add_format_option(sub, o.scene);
  add_near_option(sub, o.camera);
  add_count_option(sub, o.scene);
  add_seed_option(sub, o.scene);
  choose<gl::Backend>(sub, "--backend", o.context.backend, "A GPU, else Mesa; or Mesa without a GPU (auto)",
                      {{"auto", gl::Backend::automatic}, {"surfaceless", gl::Backend::surfaceless}});
  add_device_option(sub, o.context);
}

}  // namespace binosplat::app
