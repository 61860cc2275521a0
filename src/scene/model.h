#pragma once
// A trained 3D Gaussian Splatting model in memory, decoded (docs/method.md 1).

#include <binosplat/model.h>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat {

/// The constant function of the spherical harmonics: a base colour is 0.5 + sh_c0 * coefficient.
constexpr double sh_c0 = 0.28209479177387814;

/// Number of SH coefficients per colour channel of a degree.
constexpr int sh_count(int degree) { return (degree + 1) * (degree + 1); }

struct Scaffold;

/// How Gaussians become a picture (docs/method.md 2): ORDER_ and PROJECTION_ of shared/axes.h.
struct Perspective {
  int order = ORDER_DEPTH;
  int projection = PROJECTION_AFFINE;

  bool operator==(const Perspective&) const = default;
};

/// The frame of a model's numbers in the cameras' world (scene/axes.h).
struct ModelAxes {
  std::string letters = "RDF";  // where its x, y and z point
  /// What positions are relative to, in the model's axes: zero, but for models so far away from zero that
  /// floats would round what pictures show (choose_origin).
  glm::dvec3 origin{0.0};
};

/// Arrays of equal length, one element a Gaussian, in file order. Every value is finite and every rotation of
/// unit length: readers leave out what is not, and count it.
struct Model {
  std::string name;                 // for people: the file's or scene's name
  std::string format;               // the file's, for people
  int degree = 0;                   // the spherical harmonics' degree, 0 to 3
  std::vector<glm::vec3> position;  // world units, from axes.origin
  std::vector<glm::vec3> scale;     // standard deviations, world units (not logarithms)
  std::vector<glm::vec4> rotation;  // unit quaternions (w, x, y, z)
  std::vector<float> opacity;       // in [0, 1] (not logits)
  std::vector<float> sh;            // (count, sh_count(degree), 3): coefficient-major, RGB together
  std::size_t left_out = 0;         // Gaussians of the source with values not finite or a zero quaternion
  double kernel_px2 = KERNEL_PX2;   // variance of the low-pass it was trained with, px^2
  bool antialiased = false;  // trained with the opacity that the low-pass takes away (Mip-Splatting, Yu 2024)
  std::string antialiased_by;   // what says so, or that it was not; empty: nothing does
  Perspective perspective;      // that it was trained with
  bool lacks_degree_4 = false;  // its file has harmonics of degree 4, too, which nothing here draws
  ModelAxes axes;
  /// Gaussians that it may come to have while it is drawn (scene/model_chunks.h): whoever draws it makes room
  /// for all of them at once, since no frame should wait for that.
  std::size_t room = 0;
  /// Where there is one, it makes the Gaussians anew for each eye, and all arrays above but `position` are
  /// stand-ins (scene/scaffold.h).
  std::shared_ptr<Scaffold> scaffold;

  std::size_t count() const { return position.size(); }
  void reserve(std::size_t n);
  void resize(std::size_t n);
};

/// What a file says of one Gaussian.
struct GaussianValues {
  glm::dvec3 position;  // from zero, wherever the model's origin is
  glm::vec3 scale;      // standard deviations, or their logarithms
  glm::vec4 rotation;   // quaternion w x y z of any length
  float opacity;        // 0 to 1, or its logit
  const float* sh;      // 3 * sh_count(model.degree) values in the model's order
};

/// For readers that know the count and decode on several cores: resize(count), then for every slot `i` either
/// decode_raw, where files hold what trainers store (logarithms and logits), or place, where they hold scales
/// and opacities as they are drawn; then keep_only. Both return whether the Gaussian may be kept: not if a
/// decoded value is not finite, the quaternion is zero, a scale is below 0 or the opacity further outside 0
/// to 1 than rounding takes it.
bool decode_raw(Model& model, std::size_t i, const GaussianValues& raw);
bool place(Model& model, std::size_t i, const GaussianValues& values);

/// Throws Error, naming `source`, where more opacities than damage makes are beyond 0 to 1, and so of another
/// kind.
void check_opacities(const std::string& source, std::span<const float> opacities);

/// Closes the gaps of those that are not kept (0), and counts them as left out.
void keep_only(Model& model, const std::vector<std::uint8_t>& kept);

/// For readers of positions that are finer than floats, which are rounded to floats from zero so far: moves
/// the origin to the middle of a model whose distance from zero is so many times its size that the rounding
/// shows. Returns whether it did; positions are then to be set again, from it.
[[nodiscard]] bool choose_origin(Model& model);

/// The same, and sets the positions again where it did.
void set_far_positions(Model& model, std::span<const glm::dvec3> positions);

/// Gives a model's positions from another origin, as floats. Returns how far that moves one at most.
double move_origin(Model& model, const glm::dvec3& origin);

/// Box around the middle of the model, from zero, robust against far outliers: the 2nd to 98th percentile of
/// positions per axis, of Gaussians that are not wholly transparent, unless all are.
Bounds core_bounds(const Model& model);

/// A box that is empty at first.
struct Box {
  glm::dvec3 low{INFINITY}, high{-INFINITY};

  void include(const glm::dvec3& lowest, const glm::dvec3& highest) {
    low = glm::min(low, lowest);
    high = glm::max(high, highest);
  }
  Box operator+(const glm::dvec3& by) const { return {low + by, high + by}; }
};

/// The box around the ellipsoids of one standard deviation of all Gaussians, or of some, from the origin.
Box reach_of(const Model& model);
Box reach_of(const Model& model, std::span<const std::uint32_t> indices);

}  // namespace binosplat
