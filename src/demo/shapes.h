#pragma once
// The shapes that demo:room and demo:city are made of: what a surface is made of (Material), where it lies
// (Frame), how it is divided into Gaussians (Cells), and the sheets, boxes, balls, lathed and bent surfaces
// of the room, whose grain is given (Stage). The city's sheets, boxes, balls and wires, whose grain grows
// with the distance, are in demo/city_parts.h.
//
// Deterministic: no library's random distributions, and no two random numbers in one expression, whose order
// compilers choose freely. World axes are COLMAP's: y points down, so heights above the floor are negative y.
// Lengths are metres.

#include <concepts>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "base/random.h"

namespace binosplat::demo {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double pi = 3.14159265358979323846;

/// A random number in [0, 1) that belongs to a pair of integers.
double hash(std::int64_t a, std::int64_t b);

/// Smooth noise in [0, 1] with features of about one unit.
double noise(double x, double y);

/// Noise in [0, 1] of four octaves, for clouds, stone and hills.
double fractal(double x, double y);

dvec3 mix(const dvec3& a, const dvec3& b, double t);

/// 0 below `low`, 1 above `high`, smooth between them.
double ramp(double low, double high, double x);

/// What a point of a surface is made of. Colours are display-referred, as people choose them.
struct Material {
  dvec3 colour{0.5};
  double opacity = 0.97;   // 0: a hole
  double gloss = 0.0;      // how strongly lights are mirrored; in the city 0 dull to 1 glass
  double sharpness = 8.0;  // exponent of the mirrored lobe
  double glow = 0.0;       // light of its own, in units of the colour
  bool two_sided = false;  // leaves and cloth: lit from both sides
  bool lit = true;         // false: the colour is what is seen (the world outside)
};

/// What a surface shows at (u, v), in metres from its corner, or one material throughout.
class Texture {
 public:
  Texture(const Material& material = {}) : at_([material](double, double) { return material; }) {}
  template <std::invocable<double, double> Function>
  Texture(Function at) : at_(std::move(at)) {}
  Material operator()(double u, double v) const { return at_(u, v); }

 private:
  std::function<Material(double u, double v)> at_;
};

/// The texture that a function of (subject, u, v) is for one subject, which must outlive it.
template <auto at, typename Subject>
Texture texture_of(const Subject& subject) {
  return [&subject](double u, double v) { return at(subject, u, v); };
}

/// One Gaussian-to-be. Its axes are tangent, bitangent (their cross product points away from the surface) and
/// normal.
struct Disc {
  dvec3 position;
  dmat3 axes;   // columns tangent, bitangent, normal; right-handed
  dvec3 scale;  // standard deviations along them
  Material material;
};

/// A place and its axes (columns x right, y down, z away). Furniture is described in a frame of its own.
struct Frame {
  dvec3 origin{0.0};
  dmat3 axes{1.0};
  dvec3 at(double x, double y, double z) const { return origin + axes * dvec3(x, y, z); }
};

/// A frame turned about the vertical.
Frame turned(const dvec3& origin, double degrees);

/// A frame rolled about its own z axis.
Frame rolled(const Frame& frame, double degrees);

/// Something that light does not pass: a box, ellipsoid or upright cylinder. `to_unit` and `unit_origin`
/// bring a world point p to to_unit * p + unit_origin, where the solid fills -1 to 1.
struct Solid {
  enum class Shape { box, ellipsoid, cylinder };
  Shape shape;
  dmat3 to_unit;
  dvec3 unit_origin;
  dvec3 centre;
  double radius;  // of a ball around it
};

/// Solids close together, with a ball around them all that most rays miss.
struct SolidGroup {
  dvec3 centre{0.0};
  double radius = 0.0;
  std::vector<Solid> solids;
};

/// How a length is divided into `count` Gaussians: the first lies `first` from its start, the others a cell
/// apart. Where the surface ends at its border (a silhouette), the outermost Gaussian lies `low` or `high`
/// cells inside of it, so that it is half transparent just there; where it goes on, half a cell.
struct Cells {
  double first, size;
  Cells(double length, std::uint32_t count, double low, double high)
      : size(length / (count - 1 + low + high)) {
    first = low * size;
  }
};

/// Whether a sheet ends at its border (silhouettes) or reaches over it (walls that must close at their
/// corners).
enum class Border { ends, overlaps };

/// How far apart the discs of a surface lie, and where its outermost ones do.
struct Grain {
  double u, v;
  Border border = Border::ends;
  explicit Grain(double both) : u(both), v(both) {}
  Grain(double along_u, double along_v, Border where = Border::ends)
      : u(along_u), v(along_v), border(where) {}
};

/// Where the discs and solids of a scene are collected.
class Stage {
 public:
  explicit Stage(std::uint64_t seed) : random(seed) {}

  /// A parallelogram; its front is where cross(edge_u, edge_v) points.
  void sheet(const dvec3& corner, const dvec3& edge_u, const dvec3& edge_v, Grain grain,
             const Texture& texture);

  /// The faces of a box from `low` to `high` in a frame; a texture's u runs along the longer side of each
  /// face. The face on the floor is left out where `low` or `high` touch y = 0 of the frame.
  void box(const Frame& frame, const dvec3& low, const dvec3& high, Grain grain, const Texture& texture);
  /// A box that casts a shadow.
  void solid_box(const Frame& frame, const dvec3& low, const dvec3& high, Grain grain,
                 const Texture& texture);

  /// An ellipsoid; u and v are longitude and latitude in radians.
  void ellipsoid(const Frame& frame, const dvec3& radii, double grain, const Texture& texture);

  /// A surface of revolution about the frame's y axis: `profile` holds radius and height (y, downwards) from
  /// one end to the other; listed from the top middle outwards and down, its front is outside. u is the angle
  /// in radians, v the way along the profile.
  void lathe(const Frame& frame, const std::vector<dvec2>& profile, double grain, const Texture& texture);

  /// A bent pipe along points. u is the angle in radians, v the way along it.
  void tube(const std::vector<dvec3>& path, double radius, double grain, const Texture& texture);

  /// A thin wire: one row of long Gaussians.
  void wire(const std::vector<dvec3>& path, double radius, double grain, const Material& material);

  /// One Gaussian by itself.
  void disc(const dvec3& position, const dmat3& axes, const dvec3& scale, const Material& material);

  /// Solids added from here on belong to a new group.
  void group() { solids.emplace_back(); }
  /// A solid that fills `low` to `high` of a frame.
  void block(Solid::Shape shape, const Frame& frame, const dvec3& low, const dvec3& high);

  /// Takes away the discs that lie inside boxes: nobody sees them, but a wall's discs would show through what
  /// stands close before it wherever their centres come first in depth.
  void remove_hidden();

  Random random;
  std::vector<Disc> discs;
  std::vector<SolidGroup> solids;

 private:
  /// Draws a profile without sharp corners that starts `done` along the whole one; returns its length.
  double smooth_lathe(const Frame& frame, const std::vector<dvec2>& profile, double grain,
                      const Texture& texture, double done);
};

/// Points of a smooth curve (Catmull-Rom) through `points`, about `step` apart.
std::vector<dvec3> curve(const std::vector<dvec3>& points, double step);

/// Right-handed axes whose third column is `normal` (unit), and whose first lies along `along` as far as it
/// can.
dmat3 axes_from_normal(const dvec3& normal, const dvec3& along);

/// A rotation as models have it: w, x, y, z, of unit length.
glm::vec4 quaternion(const dmat3& axes);

}  // namespace binosplat::demo
