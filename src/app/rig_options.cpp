#include "app/rig_options.h"

#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

namespace {

// Metres. A bare number beyond what a human or a low flight has is taken for millimetres that were meant.
double parse_ipd(const std::string& text) {
  constexpr double most = 1.0;
  std::string_view unit = text;
  if (unit.starts_with("+")) unit.remove_prefix(1);
  const std::optional<double> value = take_real(unit);
  if (!value || !std::isfinite(*value))
    fail("--ipd {}: expected metres, or a number with a unit, as in 0.064, 64mm or 3m", text);
  if (unit == "mm") return 1e-3 * *value;
  if (unit == "cm") return 1e-2 * *value;
  if (unit == "m") return *value;
  if (!unit.empty()) fail("--ipd {}: its unit may be m, cm or mm", text);
  if (std::abs(*value) > most)
    fail("--ipd {0}: that is {0} metres, and eyes are 0.063 apart; say {0}mm, or {0}m if it is meant", text);
  return *value;
}

}  // namespace

void add_rig_options(CLI::App& sub, RigOptions& o) {
  sub.option_defaults()->group("Both eyes");
  sub.add_flag("--mono", o.mono, "Draw the camera itself, one picture");
  choose<int>(sub, "--only", o.only, "Draw one eye of the pair", {{"left", 0}, {"right", 1}});
  sub.add_option_function<std::string>(
         "--ipd", [&o](const std::string& text) { o.ipd = parse_ipd(text); },
         "Distance between the eyes, in metres or with a unit: 64mm, 3m (0.063)")
      ->type_name("METRES");
  sub.add_option("--units-per-metre", o.units_per_metre, "World units that make a metre (1)")
      ->type_name("N")
      ->check(positive);
  sub.add_option("--convergence", o.convergence,
                 "Distance without disparity, where the screen stands; inf: infinitely\nfar (what suits the "
                 "first view "
                 "where one picture has both eyes, as for\nscreens; else inf)")
      ->type_name("METRES|inf");
  sub.add_option("--cant", o.cant, "Turn each eye outwards (0)")->type_name("DEGREES");
}

void check(const RigOptions& o) {
  if (o.mono && o.only)
    fail("--mono draws the camera itself and --only an eye beside it: choose one of them");
  if (o.mono && o.places_eyes()) fail("--mono has no rig: leave --ipd, --convergence and --cant out");
}

}  // namespace binosplat::app
