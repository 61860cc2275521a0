#include "render/workings.h"

#include "base/error.h"

namespace binosplat::render {

void check(const Workings& workings, const FrameSettings& settings, std::string_view prefix) {
  if (workings.supertile_side < 0 || workings.supertile_side > 2)
    fail("supertiles of {0} x {0} tiles: expected 1 or 2", workings.supertile_side);
  if (workings.stand_in && (settings.transmittance != TRANSMITTANCE_ONE || settings.quality > 0.0f)) {
    fail(
        "{0}reference-until: the reference goes by no earlier frame: leave {0}transmittance and {0}quality "
        "out",
        prefix);
  }
  if (workings.stand_in && !settings.parts.empty())
    fail("{}reference-until: the reference draws all of every view", prefix);
}

}  // namespace binosplat::render
