#pragma once
// The shapes of demo:room and demo:city: surfaces that become Gaussians (SceneBuilder), their materials, and
// shadow casters (Solids). World axes are COLMAP's: y points down, so heights above the floor are negative y.
// Lengths are metres.
//
// Deterministic: no library's random distributions, and at most one random number in an expression, since
// compilers choose the order of evaluation. Shapes and lights use only +, -, *, / and square roots, which
// IEEE 754 rounds exactly: sines and powers may differ between libraries, and the city must not.

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

double hash(std::int64_t a, std::int64_t b);  // a random number in [0, 1) determined by two integers
double hash_at(double x, double y);           // the same for the lattice cell of (x, y)
double noise(double x, double y);             // smooth, in [0, 1], with features of about one unit
double fractal(double x, double y);           // noise of four octaves, in [0, 1]: clouds, stone and hills
dvec3 mix(const dvec3& a, const dvec3& b, double t);
double ramp(double low, double high, double x);  // 0 below `low`, 1 above `high`, smooth between them
dvec2 circle(double turn);                       // point of the unit circle: turn 0 is x, 0.25 is y, 1 is x
double part_of(double value, double period);     // remainder after whole periods

/// The material at a point of a surface. Colours are display-referred.
struct Material {
  dvec3 colour{0.5};
  double opacity = 0.97;   // 0: a hole
  double gloss = 0.0;      // strength of specular reflections
  double sharpness = 8.0;  // exponent of the specular lobe
  double glow = 0.0;       // emitted light, in units of the colour
  bool two_sided = false;  // leaves and cloth: light shines through
  bool lit = true;         // false: the colour is final (the sky)
};

/// The material at (u, v), in metres from a surface's corner, or one material everywhere. Copies share the
/// material.
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

/// A position and axes (columns x right, y down, z away). Each thing is described in its own frame.
struct LocalAxes {
  dvec3 origin{0.0};
  dmat3 axes{1.0};
  dvec3 at(const dvec3& p) const { return origin + axes * p; }
};

/// Returns a frame rotated about the vertical, then rolled about its own z axis.
LocalAxes turned(const dvec3& origin, double degrees, double roll = 0.0);

/// A disc that becomes a Gaussian. The cross product of tangent and bitangent points away from the surface.
struct Disc {
  dvec3 position;
  dmat3 axes;   // columns tangent, bitangent, normal; right-handed
  dvec3 scale;  // standard deviations along these axes
  Material material;
};

/// Spacing of a sheet's Gaussians along u and v, in units of the stage's grain.
struct Grain {
  double u, v;
  Grain(double both = 1.0) : u(both), v(both) {}
  Grain(double along_u, double along_v) : u(along_u), v(along_v) {}
};

// Borders at which a sheet ends in a silhouette. At its other borders it meets sheets and leaves no gap.
enum Borders : unsigned { border_left = 1, border_right = 2, border_low = 4, border_high = 8 };
constexpr unsigned all_borders = 15;

/// A parallelogram with its front towards cross(u, v), or a crown of leaves.
struct Surface {
  dvec3 corner{0.0}, u{0.0}, v{0.0};  // crown: its middle, its radii, unused
  Texture texture;                    // crown: at (distance from its middle, distance outside its lump)
  Grain grain;
  unsigned borders = 0;
  dvec2 at{0.0};  // texture coordinates of the corner, metres
  bool crown = false;
  std::uint32_t seed = 0;   // seed of a crown's leaves
  double weight = 0.0;      // number of Gaussians that its grain requests
  std::uint32_t count = 0;  // number of Gaussians that it gets, set once all surfaces are known
};

void make_discs(const Surface& surface, const std::function<void(const Disc&)>& add);

/// A shadow caster in its own frame: a box, or in its box an ellipsoid or a roof with its ridge along x.
struct Solid {
  enum class Shape { box, ellipsoid, roof };
  Shape shape;
  dmat3 to_unit;  // to_unit * p + unit_origin maps the box to -1 to 1
  dvec3 unit_origin, half;
  dvec3 low, high;  // bounds in the world
};

/// Solids in a bounding volume hierarchy.
class Solids {
 public:
  /// Adds a solid that fills `low` to `high` of a frame.
  void add(Solid::Shape shape, const LocalAxes& frame, const dvec3& low, const dvec3& high);

  /// Builds the tree. Rays require it.
  void build();

  /// Returns the distance to the first solid along a ray, in lengths of `direction`, or `reach` if the ray
  /// hits none before. With `any` it returns the first solid found, not the nearest.
  double way(const dvec3& from, const dvec3& direction, double reach, bool any = false) const;
  bool is_free(const dvec3& from, const dvec3& direction, double reach) const {
    return way(from, direction, reach, true) >= reach;
  }

  /// Returns whether a point is inside a box, away from its faces.
  bool hide(const dvec3& p) const;

 private:
  struct Node {
    dvec3 low, high;
    std::uint32_t begin, end;  // range of its solids
    std::uint32_t second;      // index of its second child, or 0 for a leaf; the first child follows the node
  };
  void add_node(std::uint32_t begin, std::uint32_t end);

  std::vector<Solid> solids_;
  std::vector<Node> nodes_;
};

/// Collects the surfaces, Gaussians and solids of a scene.
class SceneBuilder {
 public:
  /// Returns the grain in metres of surfaces with this coarseness, at a position of the world.
  using GrainAt = std::function<double(const dvec3& place, double coarseness)>;
  explicit SceneBuilder(GrainAt grain_at = [](const dvec3&, double coarseness) { return coarseness; })
      : grain_(std::move(grain_at)) {}

  LocalAxes frame;
  double grain(const dvec3& place, double coarseness = 1.0) const {
    return grain_(frame.at(place), coarseness);
  }

  /// Adds a sheet, split into pieces of even grain.
  void sheet(Surface surface);
  void sheet(const dvec3& corner, const dvec3& u, const dvec3& v, const Texture& texture,
             Grain grain_of_sheet = {}, unsigned borders = 0) {
    sheet({corner, u, v, texture, grain_of_sheet, borders});
  }

  /// Adds the faces of a box; u runs along each face's longer side. Omits a face on the floor (y = 0).
  void box(const dvec3& low, const dvec3& high, Grain grain_of_box, const Texture& texture);
  /// Adds a box that casts a shadow.
  void solid_box(const dvec3& low, const dvec3& high, Grain grain_of_box, const Texture& texture);
  void solid(Solid::Shape shape, const dvec3& low, const dvec3& high) { solids.add(shape, frame, low, high); }

  /// Adds leaves on the outside of overlapping lumps in a ball; they cast a shadow with spots of light.
  void crown(const dvec3& middle, double radius, double coarseness, const Texture& leaves,
             std::uint32_t seed);

  // The following shapes have Gaussians about `spacing` metres apart, independent of the grain.

  /// Adds an ellipsoid; u and v are longitude and latitude in radians.
  void ellipsoid(const dvec3& middle, const dvec3& radii, double spacing, const Texture& texture);

  /// Adds a surface of revolution about the y axis through `foot`. `profile` lists radius and height (y,
  /// downwards) from end to end. If it runs from the top middle outwards and down, the front is outside. u is
  /// the angle in radians, v the length along the profile.
  void lathe(const dvec3& foot, const std::vector<dvec2>& profile, double spacing, const Texture& texture,
             const dvec3& stretch = dvec3(1.0));

  /// Adds a pipe bent smoothly through points. u is the angle in radians, v the length along the pipe.
  void tube(const std::vector<dvec3>& points, double radius, double spacing, const Texture& texture);

  /// Adds a thin wire through points: one row of long Gaussians.
  void wire(const std::vector<dvec3>& points, double radius, double spacing, const Material& material);

  void disc(const dvec3& position, const dmat3& axes, const dvec3& scale, const Material& material);

  std::vector<Surface> surfaces;
  std::vector<Disc> discs;
  Solids solids;
  Solids crowns;  // balls of leaves, partly transparent to light

 private:
  void add_pieces(const Surface& surface);

  GrainAt grain_;
};

/// Returns right-handed axes: the last is the unit vector `normal`, the first as near to `along` as possible.
dmat3 axes_from_normal(const dvec3& normal, const dvec3& along);

}  // namespace binosplat::demo
