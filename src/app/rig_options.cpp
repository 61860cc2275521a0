#include "app/rig_options.h"

#include "app/option_checks.h"
#include "base/error.h"

namespace binosplat::app {

void add_rig_options(CLI::App& sub, RigOptions& o) {
  sub.option_defaults()->group("Both eyes");
  sub.add_flag("--mono", o.mono, "Draw the camera itself, one picture");
  choose<int>(sub, "--only", o.only, "Draw one eye of the pair", {{"left", 0}, {"right", 1}});
  sub.add_option("--ipd", o.ipd, "Distance between the eyes (0.063)")->type_name("METRES");
  sub.add_option("--units-per-metre", o.units_per_metre, "World units that make a metre (1)")
      ->type_name("N")
      ->check(positive);
  sub.add_option("--convergence", o.convergence, "Distance without disparity (infinite)")
      ->type_name("METRES");
  sub.add_option("--cant", o.cant, "Turn each eye outwards (0)")->type_name("DEGREES");
}

void check(const RigOptions& o) {
  if (o.mono && o.only)
    fail("--mono draws the camera itself and --only an eye beside it: choose one of them");
  if (o.mono && o.places_eyes()) fail("--mono has no rig: leave --ipd, --convergence and --cant out");
}

}  // namespace binosplat::app
