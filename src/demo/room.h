#pragma once
// demo:room, a room made by the program itself: what `./demo` draws where no model is given.

#include <vector>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

constexpr const char* demo_room_name = "demo:room";

struct Demo {
  Model model;
  std::vector<Camera> cameras;  // heads, 1,280 x 720; the first is the one to show
};

/// Its heads.
std::vector<Camera> room_cameras();

/// A furnished room of 5 x 4 x 2.8 m (metres, y downwards) with a window on hills as far as 400 m away, some
/// 90 thousand Gaussians of degree 3. Every call makes the same bits.
Demo demo_room();

}  // namespace binosplat
