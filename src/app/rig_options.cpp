#include "app/rig_options.h"

#include <cctype>
#include <cmath>
#include <limits>

#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

namespace {

// Parses a length into metres. A number without unit is in metres.
double parse_length(const char* option, const std::string& text, const char* examples) {
  std::string_view unit = text;
  if (unit.starts_with("+")) unit.remove_prefix(1);
  const std::optional<double> value = take_real(unit);
  if (!value || !std::isfinite(*value))
    fail("{} {}: expected metres, or a number with a unit, {}", option, text, examples);
  if (unit == "mm") return 1e-3 * *value;
  if (unit == "cm") return 1e-2 * *value;
  if (!unit.empty() && unit != "m") fail("{} {}: its unit may be m, cm or mm", option, text);
  return *value;
}

// Parses metres. Refuses a bare number above 1, which probably means millimetres.
double parse_ipd(const std::string& text) {
  constexpr double most = 1.0;
  const double metres = parse_length("--ipd", text, "as in 0.064, 64mm or 3m");
  if (!text.ends_with("m") && std::abs(metres) > most)
    fail("--ipd {0} means {0} m, but eyes are 0.063 m apart: give {0}mm, or {0}m for metres", text);
  if (metres < 0.0) fail("--ipd {}: expected metres, zero or more", text);
  return metres;
}

double parse_convergence(const std::string& text) {
  std::string word = text.substr(text.starts_with("+") ? 1 : 0);
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (word == "inf" || word == "infinity") return std::numeric_limits<double>::infinity();
  const double metres = parse_length("--convergence", text, "as in 3, 80cm or 2.5m, or inf");
  if (!(metres > 0.0)) fail("--convergence {}: expected metres above zero, or inf for parallel eyes", text);
  return metres;
}

}  // namespace

CLI::Option* add_ipd_option(CLI::App& sub, RigOptions& o) {
  return add_parsed(sub, "--ipd", "METRES", o.ipd, parse_ipd,
                    "Distance between the eyes, in metres or with a unit: 64mm, 3m (0.063)");
}

void add_rig_options(CLI::App& sub, RigOptions& o) {
  sub.option_defaults()->group("Both eyes");
  sub.add_flag("--mono", o.mono, "Draw the camera itself, one picture");
  choose<int>(sub, "--only", o.only, "Draw one eye of the pair; --quality and --detail go by it alone",
              {{"left", 0}, {"right", 1}});
  add_ipd_option(sub, o);
  add_value(sub, "--units-per-metre", "N", o.units_per_metre, positive, "World units that make a metre (1)");
  add_parsed(
      sub, "--convergence", "METRES|inf", o.convergence, parse_convergence,
      "Distance of the screen, where disparity is zero, in metres or with a\nunit: 80cm; inf: infinitely "
      "far (a comfortable distance in the first view\nif one picture has both eyes; else inf)");
  add_value(sub, "--cant", "DEGREES", o.cant, between(-44.999999, 44.999999, "degrees between -45 and 45"),
            "Turn each eye outwards by so many degrees (0)");
}

}  // namespace binosplat::app
