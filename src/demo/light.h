#pragma once
// Light for procedural scenes, baked once into the Gaussians' spherical harmonics: a sun, a sky and haze, and
// within a room lamps and ambient occlusion; the scene's solids cast shadows. Mirrored lobes depend on where
// one looks from. Irradiances are linear, in units in which 1 on a white wall is nearly white.

#include <optional>

#include "demo/shapes.h"
#include "scene/model.h"

namespace binosplat::demo {

/// A lamp, or a piece of a window.
struct Lamp {
  dvec3 place;
  dvec3 power;        // irradiance at 1 m
  dvec3 facing{0.0};  // a window's normal, from the room to the outside
};

/// A box in which lamps shine instead of the sky. Its walls are solids of the stage.
struct Interior {
  dvec3 low, high;
  dvec3 sun;
  std::vector<Lamp> lamps;
  dvec3 ambient;  // where nothing is near
};

struct Lighting {
  dvec3 to_sun;                   // unit
  dvec3 sun, sky, bounce;         // the last from sunlit ground and walls
  dvec3 haze{0.80, 0.85, 0.90};   // a colour
  double haze_distance = 1500.0;  // where it covers a half
  std::optional<Interior> room;
};

/// The Model that the stage's Gaussians and surfaces make in this light.
Model bake(Stage& stage, const Lighting& light, int degree, const char* name);

}  // namespace binosplat::demo
