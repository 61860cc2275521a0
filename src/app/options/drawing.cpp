#include "app/options/drawing.h"

#include <filesystem>

#include "adagscale/calibrated_threshold.h"
#include "base/choices.h"
#include "base/error.h"
#include "measure/reference_stages.h"

namespace binosplat::app {

bool DrawingOptions::has_calibration() const {
  std::error_code ignored;
  return !calibration.empty() && std::filesystem::exists(calibration, ignored);
}

bool finds_k(const DrawingOptions& o) {
  return adagscale::lacks_k(o) && !o.foveation && !o.has_calibration();
}

bool measures_model(const DrawingOptions& o) {
  const bool by_depth = o.transmittance.value_or(Transmittance::depth) == Transmittance::depth;
  return finds_k(o) || (by_depth && !o.has_calibration() &&
                        (o.threshold == Threshold::adagscale || o.transmittance == Transmittance::depth));
}

void check(const DrawingOptions& o) {
  const bool finds = finds_k(o), calibrated = o.has_calibration();
  if (!o.calibration.empty() && !calibrated && !finds) {
    fail(
        "--calibration {}: there is no such file: make it with binosplat calibrate, or add --threshold "
        "adagscale, which finds K and writes it there",
        o.calibration);
  }
  if (calibrated && o.quality)
    fail("--calibration with --quality: both choose the tolerance: leave one of them out");
  // --tolerance is allowed beside a calibrated depth table, which it does not replace.
  if (o.tolerance && calibrated && o.transmittance != Transmittance::depth &&
      o.threshold != Threshold::adagscale)
    fail("--tolerance with --calibration: both choose the tolerance: leave one of them out");
  if (calibrated && o.threshold == Threshold::exact)
    fail("--calibration has no effect with --threshold {}, which is exact", name_of(*o.threshold));
  if (finds && o.reference_until)
    fail("--reference-until uses no calibration: give --threshold adagscale a --tolerance, its K");
  render::check(settings_of(o), "--", calibrated || finds);
  render::check(debug_options_of(o), settings_of(o), "--");
}

render::FrameSettings settings_of(const DrawingOptions& o) {
  render::FrameSettings settings = static_cast<const render::FrameSettings&>(o);
  if (!o.has_calibration() && !o.quality) settings.threshold = render::chosen_threshold(settings);
  return settings;
}

render::DebugOptions debug_options_of(const DrawingOptions& o) {
  render::DebugOptions debug;
  if (o.reference_until) debug.stand_in = measure::reference_until(*o.reference_until);
  return debug;
}

}  // namespace binosplat::app
