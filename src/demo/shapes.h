#pragma once
// The shapes that demo:room and demo:city are made of: what a surface is made of (Material), where it lies
// (Frame), what casts shadows (Solids), and the surfaces that become Gaussians (Stage).
//
// Deterministic: no library's random distributions, and no two random numbers in one expression, whose order
// compilers choose freely. World axes are COLMAP's: y points down, so heights above the floor are negative y.
// Lengths are metres.
//
// Shapes and lights take only +, -, *, / and square roots, which IEEE 754 rounds alike everywhere. Sines and
// powers may differ in their last bit from library to library, and the city must not.

#include <concepts>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace binosplat::demo {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double pi = 3.14159265358979323846;
constexpr dvec3 right{1, 0, 0}, down{0, 1, 0}, up{0, -1, 0}, away{0, 0, 1};

double hash(std::int64_t a, std::int64_t b);  // a random number in [0, 1) that belongs to two integers
double hash_at(double x, double y);           // the same of the square of a lattice in which (x, y) lies
double noise(double x, double y);             // smooth, in [0, 1], with features of about one unit
double fractal(double x, double y);           // noise of four octaves, in [0, 1]: clouds, stone and hills
dvec3 mix(const dvec3& a, const dvec3& b, double t);
double ramp(double low, double high, double x);  // 0 below `low`, 1 above `high`, smooth between them
dvec2 circle(double turn);                    // a point of the unit circle: 0 at x, 0.25 at y, 1 at x again
double part_of(double value, double period);  // what is left when whole periods are taken away

/// What a point of a surface is made of. Colours are display-referred, as people choose them.
struct Material {
  dvec3 colour{0.5};
  double opacity = 0.97;   // 0: a hole
  double gloss = 0.0;      // how strongly lights are mirrored
  double sharpness = 8.0;  // exponent of the mirrored lobe
  double glow = 0.0;       // light of its own, in units of the colour
  bool two_sided = false;  // leaves and cloth: light shines through
  bool lit = true;         // false: the colour is what is seen (the sky)
};

/// What a surface shows at (u, v), in metres from its corner, or one material throughout. Copies share it.
class Texture {
 public:
  using Function = std::function<Material(double u, double v)>;
  Texture(const Material& material = {}) : Texture([material](double, double) { return material; }) {}
  template <std::invocable<double, double> Look>
  Texture(Look look) : at_(std::make_shared<const Function>(std::move(look))) {}
  Material operator()(double u, double v) const { return (*at_)(u, v); }

 private:
  std::shared_ptr<const Function> at_;
};

/// A place and its axes (columns x right, y down, z away). Things are described in a frame of their own.
struct Frame {
  dvec3 origin{0.0};
  dmat3 axes{1.0};
  dvec3 at(const dvec3& p) const { return origin + axes * p; }
};

/// A frame turned about the vertical, and then rolled about its own z axis.
Frame turned(const dvec3& origin, double degrees, double roll = 0.0);

/// One Gaussian-to-be. Its axes are tangent, bitangent (their cross product points away from the surface) and
/// normal.
struct Disc {
  dvec3 position;
  dmat3 axes;   // columns tangent, bitangent, normal; right-handed
  dvec3 scale;  // standard deviations along them
  Material material;
};

/// How far apart the Gaussians of a sheet lie along u and v, in units of the stage's grain.
struct Grain {
  double u, v;
  Grain(double both = 1.0) : u(both), v(both) {}
  Grain(double along_u, double along_v) : u(along_u), v(along_v) {}
};

// Borders at which a sheet ends in a silhouette, so that its Gaussians must not reach over them. At others it
// meets other sheets, and must close.
enum Borders : unsigned { border_left = 1, border_right = 2, border_low = 4, border_high = 8 };
constexpr unsigned all_borders = 15;

/// A parallelogram, seen from where cross(u, v) points, or a crown of leaves. It is only described here: how
/// many Gaussians show it is decided when all surfaces are known.
struct Surface {
  dvec3 corner{0.0}, u{0.0}, v{0.0};  // of a crown: its middle, and u its radii
  Texture texture;                    // of a crown: by how far from its middle, and how far outside its lump
  Grain grain;
  unsigned borders = 0;
  dvec2 at{0.0};  // of the corner, in the texture's metres
  bool crown = false;
  std::uint32_t seed = 0;   // of a crown's leaves
  double weight = 0.0;      // how many Gaussians its grain asks for
  std::uint32_t count = 0;  // how many it has
};

/// Adds the Gaussians of a surface, as many as it has.
void make_discs(const Surface& surface, const std::function<void(const Disc&)>& add);

/// Something that light does not pass, in a box of its own frame: it fills the box, or lies in it as an
/// ellipsoid, or as a roof with its ridge along x.
struct Solid {
  enum class Shape { box, ellipsoid, roof };
  Shape shape;
  dmat3 to_unit;  // to_unit * p + unit_origin brings the box to -1 to 1
  dvec3 unit_origin, half;
  dvec3 low, high;  // bounds in the world
};

/// Solids in a tree of bounding boxes.
class Solids {
 public:
  /// Adds a solid that fills `low` to `high` of a frame.
  void add(Solid::Shape shape, const Frame& frame, const dvec3& low, const dvec3& high);

  /// Makes the tree. Rays need it.
  void build();

  /// How many times `direction` a ray goes until it enters a solid; `reach` if it enters none before. With
  /// `any` it is enough to know that there is one: the nearest is not searched for.
  double way(const dvec3& from, const dvec3& direction, double reach, bool any = false) const;
  bool is_free(const dvec3& from, const dvec3& direction, double reach) const {
    return way(from, direction, reach, true) >= reach;
  }

  /// Whether a point lies inside of a box, and not at its faces.
  bool hide(const dvec3& p) const;

 private:
  struct Node {
    dvec3 low, high;
    std::uint32_t begin, end;  // of its solids
    std::uint32_t second;      // its second child; the first one follows it; 0: a leaf
  };
  void add_node(std::uint32_t begin, std::uint32_t end);

  std::vector<Solid> solids_;
  std::vector<Node> nodes_;
};

/// Where the surfaces, Gaussians and solids of a scene are collected.
class Stage {
 public:
  /// The grain of surfaces of a coarseness at a place of the world, in metres.
  using GrainAt = std::function<double(const dvec3& place, double coarseness)>;
  explicit Stage(GrainAt grain_at = [](const dvec3&, double coarseness) { return coarseness; })
      : grain_(std::move(grain_at)) {}

  /// What is added is described in this frame.
  Frame frame;
  double grain(const dvec3& place, double coarseness = 1.0) const {
    return grain_(frame.at(place), coarseness);
  }

  /// Adds a sheet, in pieces each of which has an even grain.
  void sheet(Surface surface);
  void sheet(const dvec3& corner, const dvec3& u, const dvec3& v, const Texture& texture,
             Grain grain_of_sheet = {}, unsigned borders = 0) {
    sheet({corner, u, v, texture, grain_of_sheet, borders});
  }

  /// The faces of a box; a texture's u runs along the longer side of each face. The face on the floor is left
  /// out where `low` or `high` touch y = 0.
  void box(const dvec3& low, const dvec3& high, Grain grain_of_box, const Texture& texture);
  /// A box that casts a shadow.
  void solid_box(const dvec3& low, const dvec3& high, Grain grain_of_box, const Texture& texture);
  void solid(Solid::Shape shape, const dvec3& low, const dvec3& high) { solids.add(shape, frame, low, high); }

  /// Leaves on the outside of lumps that overlap, in a ball; they cast a shadow with spots of light in it.
  void crown(const dvec3& middle, double radius, double coarseness, const Texture& leaves,
             std::uint32_t seed);

  // What follows consists of Gaussians about `spacing` metres apart, whatever the grain.

  /// An ellipsoid; u and v are longitude and latitude in radians.
  void ellipsoid(const dvec3& middle, const dvec3& radii, double spacing, const Texture& texture);

  /// A surface of revolution about the y axis through `foot`: `profile` holds radius and height (y,
  /// downwards) from one end to the other; listed from the top middle outwards and down, its front is
  /// outside. u is the angle in radians, v the way along the profile.
  void lathe(const dvec3& foot, const std::vector<dvec2>& profile, double spacing, const Texture& texture,
             const dvec3& stretch = dvec3(1.0));

  /// A pipe bent smoothly through points. u is the angle in radians, v the way along it.
  void tube(const std::vector<dvec3>& points, double radius, double spacing, const Texture& texture);

  /// A thin wire through points: one row of long Gaussians.
  void wire(const std::vector<dvec3>& points, double radius, double spacing, const Material& material);

  /// One Gaussian by itself.
  void disc(const dvec3& position, const dmat3& axes, const dvec3& scale, const Material& material);

  std::vector<Surface> surfaces;
  std::vector<Disc> discs;
  Solids solids;
  Solids crowns;  // balls of leaves, which light shines through here and there

 private:
  void add_pieces(const Surface& surface);

  GrainAt grain_;
};

/// Right-handed axes whose third column is `normal` (unit), and whose first lies along `along` as far as it
/// can.
dmat3 axes_from_normal(const dvec3& normal, const dvec3& along);

}  // namespace binosplat::demo
