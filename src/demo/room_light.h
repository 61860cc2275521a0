#pragma once
// Light for procedural scenes, baked once into the Gaussians' spherical harmonics: a sun and a sky through an
// opening, a lamp, shadows of the scene's solids, ambient occlusion, and mirrored lobes that depend on where
// one looks from.

#include <glm/glm.hpp>
#include <vector>

#include "demo/shapes.h"
#include "scene/model.h"

namespace binosplat::demo::room {

/// Irradiances are linear, in units in which 1 on a white wall is white.
struct Lighting {
  dvec3 room_low, room_high;  // the box in which light and shadow happen

  // An upright rectangular opening in the plane z = room_high.z, through which sun and sky come in.
  dvec2 opening_low, opening_high;  // x and y
  dvec3 to_sun;                     // unit
  dvec3 sun;
  dvec3 sky;  // radiance of the opening times pi

  dvec3 lamp_position;
  dvec3 lamp;  // irradiance at 1 m

  dvec3 ambient;        // where nothing is near
  dvec3 bounce_middle;  // the sunlit spot of the floor, which lights what is around and above it
  dvec3 bounce;         // irradiance at 1 m
};

/// The Model of degree 3 that the stage's discs make in this light.
Model bake(const Stage& stage, const Lighting& light);

}  // namespace binosplat::demo::room
