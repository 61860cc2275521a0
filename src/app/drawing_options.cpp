#include "app/drawing_options.h"

#include "app/option_checks.h"
#include "base/error.h"
#include "measure/twins.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

void add_drawing_options(CLI::App& sub, DrawingOptions& o) {
  sub.option_defaults()->group("Drawing");
  choose_explained(sub, "--tiles", o.tiles,
                   "Tile test: chooses the tiles in which a Gaussian is drawn (ellipse)", tiles_choices);
  std::string rules_help =
      "Rule for the alpha below which a Gaussian is dropped from a tile (tau;\nwith --quality or "
      "--calibration: squared; with --tolerance: peripheral)";
  Words<int> rules = words_of(th_choices);
  for (const Choice& rule : th_choices) rules_help += fmt::format("\n  {}: {}", rule.name, rule.help);
  rules.emplace_back("adagscale", TH_PERIPHERAL);
  rules_help += "\n  adagscale: the whole of AdaGScale: peripheral with --transmittance depth";
  choose(sub, "--threshold", o.th, rules_help, rules)->each([&o](const std::string& rule) {
    o.adagscale = rule == "adagscale";
    if (o.adagscale) o.transmittance = TRANSMITTANCE_DEPTH;
  });
  add_value(sub, "--tolerance", "X", o.tolerance, not_negative,
            "Accepted loss of a dropped Gaussian in a tile, in the unit of --threshold");
  add_value(sub, "--quality", "DB", o.quality, quality_range,
            "Choose each frame's tolerance for a PSNR of about DB against the exact\npicture. Frames of "
            "unknown error are exact, as are the first ones and\nsingle pictures; some frames draw a part of "
            "their tiles twice to measure it");
  sub.add_option("--calibration", o.calibration, "Take the tolerance from a file of binosplat calibrate")
      ->type_name("FILE");
  choose_explained(sub, "--transmittance", o.transmittance,
                   "Upper bound of a Gaussian's transmittance, for --threshold (one)", transmittance_choices);
  choose_explained(sub, "--order", o.order, "How Gaussians are sorted (as the model was trained: depth)",
                   order_choices);
  choose_explained(sub, "--projection", o.projection,
                   "How Gaussians are projected (as the model was trained: affine)", projection_choices);
  choose_explained(sub, "--precision", o.precision, "Precision of the stored model and splats (full)",
                   precision_choices);
  Words<render::Stage> stages;
  for (int k = 0; k < render::stages_with_twins; ++k)
    stages.emplace_back(render::name_of(static_cast<render::Stage>(k)), static_cast<render::Stage>(k));
  choose(sub, "--reference-until", o.reference_until,
         fmt::format("Compute the stages up to this one by the float64 reference:\n{} (decode: Scaffold-GS)",
                     fmt::join(std::span(render::stage_names).first(render::stages_with_twins), ", ")),
         stages)
      ->type_name("STAGE");
  add_value(sub, "--frames", "N", o.frames, range(1, 100000),
            "Draw each view N times, for the table of times (1)");
}

void check(const DrawingOptions& o) {
  const render::FrameSettings settings = settings_of(o);
  const char* const th = th_choices[settings.th].name;
  const bool exact = render::is_exact(settings.th);
  const bool given = o.tolerance || o.quality, calibrated = !o.calibration.empty();
  if (o.adagscale && o.transmittance != TRANSMITTANCE_DEPTH) {
    fail("--threshold adagscale uses its table by depth: for --transmittance {} give --threshold peripheral",
         transmittance_choices[o.transmittance].name);
  }
  // --tolerance is allowed beside a calibrated depth table, which it does not replace.
  if (o.tolerance && calibrated && o.transmittance != TRANSMITTANCE_DEPTH)
    fail("--tolerance with --calibration: both choose the tolerance: leave one of them out");
  if (!exact && !given && !calibrated)
    fail("--threshold {} needs --tolerance, --quality or --calibration, which set the accepted loss", th);
  if (exact && calibrated) fail("--calibration has no effect with --threshold {}, which is exact", th);
  render::check_choice(settings, "--");
  render::check(debug_options_of(o), settings, "--");
}

int threshold_of(const DrawingOptions& o) {
  return o.th.value_or(
      render::default_threshold(o.quality || !o.calibration.empty(), o.tolerance.has_value()));
}

render::FrameSettings settings_of(const DrawingOptions& o) {
  render::FrameSettings settings;
  settings.tiles = o.tiles;
  settings.th = threshold_of(o);
  settings.tolerance = o.tolerance.value_or(0.0f);
  settings.transmittance = o.transmittance;
  settings.quality = o.quality.value_or(0.0f);
  settings.order = o.order;
  settings.projection = o.projection;
  settings.precision = o.precision;
  return settings;
}

render::DebugOptions debug_options_of(const DrawingOptions& o) {
  render::DebugOptions debug;
  if (o.reference_until) debug.stand_in = measure::reference_until(*o.reference_until);
  return debug;
}

}  // namespace binosplat::app
