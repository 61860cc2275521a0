#pragma once
// Light for procedural scenes, baked into the Gaussians' spherical harmonics: sun, sky and haze; in a room
// also lamps and ambient occlusion. The scene's solids cast shadows, and specular reflections depend on the
// viewing direction. Irradiances are linear; an irradiance of 1 makes a white wall nearly white.

#include <optional>

#include "demo/shapes.h"
#include "scene/model.h"

namespace binosplat::demo {

/// A lamp, or a part of a window.
struct Lamp {
  dvec3 place;
  dvec3 power;        // irradiance at 1 m
  dvec3 facing{0.0};  // a window's outward normal
};

/// A box lit by lamps instead of the sky. Its walls are solids of the stage.
struct Interior {
  dvec3 low, high;
  dvec3 sun;
  std::vector<Lamp> lamps;
  dvec3 ambient;  // irradiance on a surface that nothing occludes
};

struct Lighting {
  dvec3 to_sun;                   // unit
  dvec3 sun, sky, bounce;         // bounce: light from sunlit ground and walls
  dvec3 haze{0.80, 0.85, 0.90};   // a colour
  double haze_distance = 1500.0;  // metres at which haze replaces half of the light
  std::optional<Interior> room;
};

/// Returns the model of the stage's Gaussians and surfaces in this light.
Model bake(SceneBuilder& stage, const Lighting& light, int degree, const char* name);

}  // namespace binosplat::demo
