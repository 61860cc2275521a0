#pragma once
// The scenes that the program makes by itself: demo:room, a room, which `./demo` draws where no model is
// given, and demo:city, streets of houses as large as one likes, for measuring what real captures of this
// size need.

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
  std::vector<Camera> cameras;  // heads, 1,280 x 720; the first is the one to show
};

/// The heads in the room.
std::vector<Camera> room_cameras();

/// A furnished room of 5 x 4 x 2.8 m (metres, y downwards) with a window on hills as far as 400 m away, some
/// 90 thousand Gaussians of degree 3. Every call makes the same bits.
Demo demo_room();

struct CitySettings {
  std::uint64_t seed = 1;         // another seed is another city
  std::size_t count = 1'000'000;  // Gaussians, exactly
};

constexpr std::size_t city_count_min = 10'000;
constexpr std::size_t city_count_max = 100'000'000;

/// Throws Error, naming --count, for a city too small or too large.
void check(const CitySettings& settings);

/// A head in the main street that looks along it, one above it and one at a corner.
std::vector<Camera> city_cameras();

/// Streets of houses with trees, lamps and cars on level ground, 0.6 km wide and 1.2 km long (metres, y
/// downwards; the first camera looks along z), high houses and hills beyond them and a sky. Degree 1, which
/// is what a reflection in a window or on a car needs at least. However many Gaussians there are, they close
/// the surfaces; more of them are smaller, and show more of what is there, most where the cameras are. The
/// same settings make the same bits, on any number of threads. Throws Error as check does.
Demo demo_city(const CitySettings& settings = {});

}  // namespace binosplat
