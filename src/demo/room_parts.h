#pragma once
// Parts of demo:room.

#include "demo/common_parts.h"

namespace binosplat::demo {

using Shape = Solid::Shape;

// The room, in metres; the window is in the wall at high z.
constexpr dvec3 room_low{-2.5, -2.8, -2.0}, room_high{2.5, 0.0, 2.0};
constexpr dvec2 window_low{-1.75, -2.4}, window_high{0.35, -0.7};
constexpr dvec3 lamp_bulb{0.95, -1.72, 0.5};

constexpr dvec3 walnut{0.42, 0.26, 0.16}, oak{0.66, 0.47, 0.29}, cream{0.90, 0.86, 0.76},
    white{0.90, 0.88, 0.83};
const Material brass{.colour = {0.74, 0.56, 0.27}, .gloss = 3.0};

/// Returns wood with its grain along u.
Texture wooden(const dvec3& colour, double seed, double gloss = 1.5);

void add_furniture(SceneBuilder& stage);

}  // namespace binosplat::demo
