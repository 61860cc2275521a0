#include "app/options/drawing.h"

#include "base/choices.h"
#include "base/error.h"
#include "measure/reference_stages.h"

namespace binosplat::app {

void check(const DrawingOptions& o) {
  const render::FrameSettings settings = settings_of(o);
  const bool calibrated = !o.calibration.empty();
  if (o.rule == whole_adagscale && settings.transmittance != Transmittance::depth) {
    fail("--threshold adagscale uses its table by depth: for --transmittance {} give --threshold peripheral",
         name_of(settings.transmittance));
  }
  // --tolerance is allowed beside a calibrated depth table, which it does not replace.
  if (o.tolerance && calibrated && settings.transmittance != Transmittance::depth)
    fail("--tolerance with --calibration: both choose the tolerance: leave one of them out");
  if (calibrated && render::is_exact(*settings.threshold))
    fail("--calibration has no effect with --threshold {}, which is exact", name_of(*settings.threshold));
  render::check(settings, "--", calibrated);
  render::check(debug_options_of(o), settings, "--");
}

render::FrameSettings settings_of(const DrawingOptions& o) {
  render::FrameSettings settings = static_cast<const render::FrameSettings&>(o);
  if (o.rule)
    settings.threshold = o.rule == whole_adagscale ? Threshold::peripheral : static_cast<Threshold>(*o.rule);
  settings.threshold = render::chosen_threshold(settings, !o.calibration.empty());
  settings.transmittance =
      o.source.value_or(o.rule == whole_adagscale ? Transmittance::depth : Transmittance::one);
  return settings;
}

render::DebugOptions debug_options_of(const DrawingOptions& o) {
  render::DebugOptions debug;
  if (o.reference_until) debug.stand_in = measure::reference_until(*o.reference_until);
  return debug;
}

}  // namespace binosplat::app
