#pragma once
// What is drawn at once: a camera, or both eyes of a head.

#include <array>
#include <optional>
#include <string_view>

#include "stereo/rig.h"

namespace binosplat::python {

struct Rig {
  Camera head;                                // where there are no `eyes`
  std::optional<std::array<Camera, 2>> eyes;  // given as a pair
  stereo::RigSettings settings;

  /// In the frame of a model with these axes (scene/axes.h). Throws Error as stereo::make_rig does.
  stereo::EyePair pair(const ModelAxes& axes = {}, double near_plane = near_default) const;
};

}  // namespace binosplat::python
