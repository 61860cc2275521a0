#include "app/drawing_options.h"

#include "base/error.h"
#include "measure/twins.h"
#include "render/threshold_policy.h"

namespace binosplat::app {

void check(const DrawingOptions& o) {
  const render::FrameSettings settings = settings_of(o);
  const char* const th = th_choices[settings.th].name;
  const bool exact = render::is_exact(settings.th);
  const bool given = o.tolerance || o.quality, calibrated = !o.calibration.empty();
  if (o.th == whole_adagscale && settings.transmittance != TRANSMITTANCE_DEPTH) {
    fail("--threshold adagscale uses its table by depth: for --transmittance {} give --threshold peripheral",
         transmittance_choices[settings.transmittance].name);
  }
  // --tolerance is allowed beside a calibrated depth table, which it does not replace.
  if (o.tolerance && calibrated && settings.transmittance != TRANSMITTANCE_DEPTH)
    fail("--tolerance with --calibration: both choose the tolerance: leave one of them out");
  if (!exact && !given && !calibrated)
    fail("--threshold {} needs --tolerance, --quality or --calibration, which set the accepted loss", th);
  if (exact && calibrated) fail("--calibration has no effect with --threshold {}, which is exact", th);
  render::check_choice(settings, "--");
  render::check(debug_options_of(o), settings, "--");
}

int threshold_of(const DrawingOptions& o) {
  if (o.th == whole_adagscale) return TH_PERIPHERAL;
  return o.th.value_or(
      render::default_threshold(o.quality || !o.calibration.empty(), o.tolerance.has_value()));
}

int transmittance_of(const DrawingOptions& o) {
  return o.transmittance.value_or(o.th == whole_adagscale ? TRANSMITTANCE_DEPTH : TRANSMITTANCE_ONE);
}

render::FrameSettings settings_of(const DrawingOptions& o) {
  render::FrameSettings settings;
  settings.tiles = o.tiles;
  settings.th = threshold_of(o);
  settings.tolerance = o.tolerance.value_or(0.0f);
  settings.transmittance = transmittance_of(o);
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
