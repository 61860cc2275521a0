#pragma once
// demo:city inside. Three steps: the plan (what stands where), the surfaces that show it at a given grain,
// and the Gaussians on each surface with their light.
//
// Only +, -, *, / and square roots are used, which IEEE 754 rounds alike everywhere: sines and powers may
// differ in their last bit from library to library, and the city must not.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "demo/city.h"
#include "demo/shapes.h"

namespace binosplat::demo::city {

// The plan, in metres. Streets lie along z, narrower side streets along x.
constexpr int streets_beside = 5;  // on either side of the main street, which is at x = 0
constexpr double street_pitch = 64.0;
constexpr double first_crossing = -120.0;
constexpr double crossing_pitch = 100.0;
constexpr int blocks_along = 12;
constexpr double last_crossing = first_crossing + blocks_along * crossing_pitch;
constexpr double road = 4.5, front = 7.5;            // from the middle of a street: kerb, houses
constexpr double side_road = 3.5, side_front = 6.0;  // the same of a side street
constexpr double kerb = 0.12;
constexpr double row_depth = 11.0;  // of a row of houses
constexpr double sky_distance = 2800.0;
constexpr dvec3 sky_centre{0.0, 0.0, 400.0};

/// From the plan to the world: streets bend, and rise towards their far end.
struct Relief {
  double bend = 6.0;
  double rise = 30.0;
  dvec3 at(double x, double z, double height = 0.0) const;
};

struct House {
  Frame frame;  // the front's left corner on the ground; x along the front, y down, z inwards
  double width, eave, roof_rise;
  int floors;
  double floor_height;
  bool brick, shop;
  double left_eave, right_eave;  // of the houses beside it; 0 where the row ends
  dvec3 wall, trim, door, roof;
  std::uint32_t number;      // for whatever else differs from house to house
  double begin;              // along its row
  std::uint32_t first_wall;  // its front; its back is the next
};

/// A side of a house that has windows.
struct Wall {
  Frame frame;  // as of a house, for whoever stands before it
  double width;
  int columns;
  bool is_front;
  std::uint32_t house;
  std::uint32_t number;
};

/// Houses wall to wall.
struct Row {
  Frame frame;
  dvec3 along;    // from its first corner to its last, with the slope of the ground
  double length;  // on the plan
  std::uint32_t first, end;
  double eave, roof_rise;  // on average
};

struct Tree {
  dvec3 foot;
  double radius, trunk;
  dvec3 leaves;
  std::uint32_t number;
};

struct Car {
  Frame frame;  // in the middle of its shadow; z forwards
  dvec3 paint;
};

/// What is seen from afar: boxes stacked on each other, each narrower.
struct Tower {
  dvec3 foot;
  double width, height;
  int tiers;
  std::uint32_t number;
};

/// What casts a shadow: a block with a gable roof (roof_rise may be 0), or a ball of leaves.
struct Caster {
  enum class Shape { block, ball };
  Shape shape;
  Frame frame;  // of a block: its first corner; of a ball: its middle
  double width = 0, depth = 0, eave = 0, roof_rise = 0, radius = 0;
};

struct City {
  std::uint64_t seed;
  Relief relief;
  std::vector<House> houses;
  std::vector<Wall> walls;
  std::vector<Row> rows;
  std::vector<Tree> trees;
  std::vector<Car> cars;
  std::vector<Frame> lamps;  // x over the street
  std::vector<Tower> towers;
  std::vector<Caster> casters;
};

City plan_city(std::uint64_t seed);

// Borders at which a sheet ends, so that its Gaussians must not reach over them.
enum Borders : unsigned { border_left = 1, border_right = 2, border_low = 4, border_high = 8 };
constexpr unsigned all_borders = 15;

/// A parallelogram of Gaussians, seen from where cross(u, v) points; or a ball of leaves.
struct Surface {
  dvec3 corner;     // of a ball: its middle
  dvec3 u, v;       // of a ball: u its radii
  Texture texture;  // of a ball: by how far from its middle, and how far outside its lump
  dvec2 at{0.0};    // of the corner, in the texture's metres
  unsigned borders = 0;
  double coarseness = 1.0;  // of its Gaussians, compared with others
  double thickness = 0.0;   // standard deviation along the normal; 0: flat
  bool ball = false;
  std::uint32_t seed = 0;   // of a ball's leaves
  double weight = 0.0;      // how many Gaussians its grain asks for
  std::uint32_t count = 0;  // how many it has
};

/// Collects surfaces, as detailed as the grain allows.
class Builder {
 public:
  /// `grain`: distance between Gaussians right before the cameras, in metres; it grows with the distance.
  Builder(const City& plan, double grain) : city(plan), grain_(grain) {}

  /// Adds a sheet, in pieces that are small against their distance.
  void sheet(const Surface& surface);
  void ball(const Surface& surface);
  /// A thin post as a row of long Gaussians.
  void wire(const dvec3& from, const dvec3& to, double radius, const Texture& texture);
  /// The walls and the top of an upright box; a texture's u goes around its walls.
  void box(const Frame& frame, const dvec3& low, const dvec3& high, const Surface& like);

  double grain_at(const dvec3& p) const;

  const City& city;
  std::vector<Surface> surfaces;

 private:
  double grain_of(const Surface& surface, const dvec3& p) const;

  double grain_;
};

/// A window, door or shop window in a wall; metres from the wall's left end and from the ground.
struct Opening {
  enum class Kind { none, window, door, shop };
  Kind kind;
  double u0, u1, v0, v1;
};
Opening opening_of(const City& city, const Wall& wall, int floor, int column);

// What houses are made of; (u, v) in metres from the wall's left end and from the ground, or from the eave.
Material wall_at(const City& city, const Wall& wall, double u, double v);
Material masonry_at(const House& house, double u, double v);
Material roof_at(const House& house, double u, double v);

// The cameras that demo_city gives, around which its detail lies: eye, and what it looks at, on the plan.
struct Head {
  const char* name;
  dvec3 eye, at;  // x, height above the ground, z
  double fov_degrees;
};
constexpr std::array<Head, 3> heads = {Head{"street", {-1.2, 1.6, -12.0}, {0.6, 2.6, 60.0}, 60.0},
                                       Head{"air", {2.5, 25.0, -40.0}, {0.0, 6.0, 60.0}, 60.0},
                                       Head{"corner", {-5.8, 1.72, 73.4}, {8.0, 2.2, 96.0}, 65.0}};

void add_houses(Builder& builder);    // city_houses.cpp
void add_streets(Builder& builder);   // city_streets.cpp: ground
void add_things(Builder& builder);    // city_things.cpp: trees, lamps, cars
void add_far_away(Builder& builder);  // city_far.cpp: towers, hills, sky

/// Daylight on the city: a sun whose shadows are cast, a sky, and haze before what is far away.
class Light {
 public:
  explicit Light(const City& city);

  struct Seen {
    dvec3 colour;    // from all sides, display-referred
    dvec3 shine{0};  // more of it towards `shine_axis`: colour + shine * dot(direction from the eye, axis)
    dvec3 shine_axis{0};
  };
  /// `leaves`: the surface is of leaves, which other leaves do not darken and which light shines through.
  Seen seen(const dvec3& p, const dvec3& normal, const Material& material, bool leaves) const;

 private:
  double sun_at(const dvec3& p, const dvec3& normal, bool leaves) const;

  const City& city_;
  std::vector<std::vector<std::uint32_t>> cells_;  // casters whose shadow may fall there
};

/// Adds the Gaussians of a surface to the model, from `first` on.
void fill(const Light& light, const Surface& surface, std::size_t first, Model& model);

}  // namespace binosplat::demo::city
