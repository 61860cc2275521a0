#pragma once
// demo:city, streets of houses that the program makes itself, as large as one likes: for measuring what real
// captures of this size would need.

#include <cstddef>
#include <cstdint>

#include "demo/room.h"

namespace binosplat {

struct CitySettings {
  std::uint64_t seed = 1;         // another seed is another city
  std::size_t count = 1'000'000;  // Gaussians, exactly
};

constexpr std::size_t city_count_min = 10'000;
constexpr std::size_t city_count_max = 100'000'000;

constexpr const char* demo_city_name = "demo:city";

/// Throws Error, naming --count, for a city too small or too large.
void check(const CitySettings& settings);

/// The cameras of a city: a head in the main street that looks along it, one above it and one at a corner.
std::vector<Camera> city_cameras(std::uint64_t seed = CitySettings().seed);

/// Streets of houses with trees, lamps and cars on a bending, rising ground, 0.6 km wide and 1.2 km long
/// (metres, y downwards; the first camera looks along z), towers and hills beyond them and a sky. Degree 1,
/// which is what a reflection in a window or on a car needs at least. However many Gaussians there are, they
/// close the surfaces; more of them are smaller, and show more of what is there, most where the cameras are.
/// The same settings make the same bits, on any number of threads. Throws Error as
/// check does.
Demo demo_city(const CitySettings& settings = {});

}  // namespace binosplat
