#include "library/conversions.h"

#include <algorithm>

#include "base/error.h"

namespace binosplat::library {

static_assert(static_cast<int>(Precision::half) == PRECISION_HALF);

render::FrameSettings frame_settings(const Settings& from, std::span<const View> views, int precision,
                                     bool finds_tolerance) {
  render::FrameSettings to{from};
  to.precision = precision;
  to.has_depths = !views.empty() && views[0].depth.has_value();
  const auto is_whole = [](const View& view) { return view.region == ViewRegion{}; };
  if (!std::ranges::all_of(views, is_whole)) {
    for (const View& view : views) to.regions.push_back({view.region});
  }
  render::check(to, prefix, finds_tolerance);
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
