#pragma once
// The built-in scenes. demo:room is the room that `./demo` draws if no model is given. demo:city is streets
// of houses with any number of Gaussians, for benchmarks at the size of real captures.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/camera.h"
#include "scene/model.h"

namespace binosplat {

constexpr const char* demo_room_name = "demo:room";
constexpr const char* demo_city_name = "demo:city";

struct Demo {
  Model model;
  std::vector<Camera> cameras;  // heads, 1,280 x 720; the first one is the default view
};

std::vector<Camera> room_cameras();

/// Returns a furnished room of 5 x 4 x 2.8 m (metres, y downwards), with a window on hills up to 400 m away.
/// It has about 90 thousand Gaussians of degree 3. Deterministic.
Demo demo_room();

struct CitySettings {
  std::uint64_t seed = 1;         // another seed is another city
  std::size_t count = 1'000'000;  // Gaussians, exactly
};

constexpr std::size_t city_count_min = 10'000;
constexpr std::size_t city_count_max = 100'000'000;

/// Throws Error, naming --count, for a count out of range.
void check(const CitySettings& settings);

/// Returns three heads: in the main street looking along it, above it, and at a corner.
std::vector<Camera> city_cameras();

/// Returns streets of houses with trees, lamps and cars on level ground, 0.6 km wide and 1.2 km long, before
/// high houses, hills and a sky. Units are metres, y points down, and the first camera looks along z. The
/// harmonics have degree 1, the least that shows reflections. Surfaces are closed at any count; larger counts
/// show more detail, above all near the cameras. Deterministic on any number of threads. Throws as check().
Demo demo_city(const CitySettings& settings = {});

}  // namespace binosplat
