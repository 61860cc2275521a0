#include "render/debug_options.h"

#include <algorithm>

#include "base/error.h"

namespace binosplat::render {

void check(const DebugOptions& debug, const FrameSettings& settings, std::string_view prefix) {
  if (debug.stand_in && (chosen_transmittance(settings) != Transmittance::one || settings.quality)) {
    fail("{0}reference-until: the reference uses no earlier frame: leave out {0}transmittance and {0}quality",
         prefix);
  }
  const auto is_whole = [](const ViewRegion& region) { return region.is_whole(); };
  if (debug.between_pixels && !std::ranges::all_of(settings.regions, is_whole))
    fail("rays between pixels need whole views: leave out the view regions");
  if (debug.stand_in && !settings.regions.empty())
    fail("{}reference-until: the reference draws only whole views: leave out the view regions", prefix);
}

}  // namespace binosplat::render
