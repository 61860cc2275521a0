#include "library/settings.h"

#include <algorithm>

#include "base/error.h"
#include "library/numbers.h"
#include "render/threshold_policy.h"

namespace binosplat::library {

namespace {

static_assert(ViewRegion::tile == TILE_SIZE);
static_assert(static_cast<int>(Precision::half) == PRECISION_HALF);
static_assert(static_cast<int>(Order::distance) == ORDER_DISTANCE);
static_assert(static_cast<int>(Projection::tangent) == PROJECTION_TANGENT);
static_assert(static_cast<int>(Threshold::exact) == TH_TAU &&
              static_cast<int>(Threshold::peripheral) == TH_PERIPHERAL &&
              static_cast<int>(Threshold::squared) == TH_SQUARED);
static_assert(static_cast<int>(Transmittance::one) == TRANSMITTANCE_ONE &&
              static_cast<int>(Transmittance::depth) == TRANSMITTANCE_DEPTH &&
              static_cast<int>(Transmittance::last) == TRANSMITTANCE_LAST);

/// Throws Error for illegal combinations, with the library's names of settings. render::check_choice uses the
/// names of the program's options.
void check_choices(const Settings& s) {
  if (s.quality && s.tolerance)
    fail("settings.tolerance with settings.quality: both choose the tolerance: leave one of them out");
  if (s.quality && s.foveation)
    fail("settings.quality with settings.foveation: it is for whole pictures: give settings.tolerance");
  if (s.threshold == Threshold::exact && (s.quality || s.tolerance)) {
    fail("settings.{0} has no effect with settings.threshold exact: leave one of them out",
         s.quality ? "quality" : "tolerance");
  }
  const int transmittance = static_cast<int>(s.transmittance);
  if (transmittance != TRANSMITTANCE_ONE && render::is_exact(rule_of(s, false))) {
    fail("settings.transmittance {} has no effect on an exact picture: give a quality or a tolerance, too",
         transmittance_choices[transmittance].name);
  }
  if (transmittance == TRANSMITTANCE_DEPTH && s.depth_table.bounds.empty()) {
    fail(
        "settings.transmittance depth needs settings.depth_table: take both from a Calibration, or give a "
        "table");
  }
}

render::ViewRegion region_of(const ViewRegion& region) {
  render::ViewRegion result;
  result.columns = region.columns;
  result.hole_begin = region.hole_begin;
  result.hole_end = region.hole_end;
  result.tolerance_share = region.tolerance_share;
  result.low_pass_share = region.low_pass_share;
  return result;
}

}  // namespace

int rule_of(const Settings& settings, bool is_calibrated) {
  if (settings.threshold) return static_cast<int>(*settings.threshold);
  return render::default_threshold(settings.quality || is_calibrated, settings.tolerance.has_value());
}

render::FrameSettings frame_settings(const Settings& from, std::span<const View> views, int precision) {
  check_numbers(from);
  check_choices(from);
  render::FrameSettings to;
  to.precision = precision;
  to.th = rule_of(from, false);
  to.transmittance = static_cast<int>(from.transmittance);
  if (to.transmittance == TRANSMITTANCE_DEPTH) to.depth_table = from.depth_table;
  if (from.quality && !(*from.quality > 0.0f))
    fail("settings.quality {}: expected decibels above zero", *from.quality);
  to.quality = from.quality.value_or(0.0f);
  to.tolerance = from.tolerance.value_or(0.0f);
  if (!render::is_exact(to.th) && !from.quality && !from.tolerance)
    fail("settings.threshold {} needs settings.tolerance or settings.quality", th_choices[to.th].name);
  if (from.order) to.order = static_cast<int>(*from.order);
  if (from.projection) to.projection = static_cast<int>(*from.projection);
  to.background = from.background.value_or(glm::vec3(0.0f));
  const bool has_depths = !views.empty() && views[0].depth.has_value();
  to.depth = !has_depths ? Depth::none : from.depth == DepthKind::median ? Depth::median : Depth::mean;
  const auto is_whole = [](const View& view) { return view.region == ViewRegion{}; };
  if (!std::all_of(views.begin(), views.end(), is_whole)) {
    for (const View& view : views) to.regions.push_back(region_of(view.region));
  }
  render::check_choice(to, "settings.");
  return to;
}

int precision_of(Precision precision) {
  const int number = static_cast<int>(precision);
  if (number < 0 || number > PRECISION_HALF) fail("precision {}: unknown value", number);
  return number;
}

int layout_of(Layout layout) {
  const int number = static_cast<int>(layout);
  const bool named = number == LAYOUT_SEPARATE || (number >= LAYOUT_PARALLEL && number <= LAYOUT_GREY);
  if (!named) fail("layout {}: unknown value", number);
  return number;
}

}  // namespace binosplat::library
