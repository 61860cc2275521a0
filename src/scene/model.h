#pragma once
// A trained 3D Gaussian Splatting model in memory, decoded (docs/method.md 1).

#include <binosplat/model.h>
#include <binosplat/settings.h>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/choices.h"
#include "shared/limits.h"

namespace binosplat {

/// The constant function of the spherical harmonics: a base colour is 0.5 + sh_c0 * coefficient.
constexpr double sh_c0 = 0.28209479177387814;

/// Number of SH coefficients per colour channel of a degree.
constexpr int sh_count(int degree) { return (degree + 1) * (degree + 1); }

struct Scaffold;

/// How Gaussians become a picture (docs/method.md 2).
struct Perspective {
  Order order = Order::depth;
  Projection projection = Projection::affine;

  bool operator==(const Perspective&) const = default;
};

/// A model's frame relative to the world of cameras (scene/axes.h).
struct ModelAxes {
  std::string letters = "RDF";  // directions of its x, y and z
  /// Origin of the positions, in the model's axes. It is zero unless the model is so far from zero that
  /// rounding to floats would be visible (choose_origin).
  glm::dvec3 origin{0.0};
};

/// How a model's trainer drew it. Each `_by` names the file or option that says so, for display; empty: the
/// default.
struct Training {
  double kernel_px2 = KERNEL_PX2;    // variance of the low-pass, px^2
  bool antialiased = false;          // opacity compensated for the low-pass (Mip-Splatting, Yu 2024)
  std::optional<double> near_plane;  // world units; none: no file says it
  Perspective perspective;
  bool flat = false;    // its Gaussians whose third scale is 0 are discs (2DGS), with depths in their planes
  bool linear = false;  // colours are linear light: it is blended, and the picture converted to sRGB
  std::string kernel_by, antialiased_by, near_by, perspective_by, linear_by;
};

/// Arrays of equal length, one element a Gaussian, in file order. Every value is finite and every rotation
/// has unit length: readers drop other Gaussians and count them in `left_out`.
struct Model : Training {
  std::string name;                 // for display: the file's or scene's name
  std::string path;                 // the file or folder that it was read from; empty: none
  std::string format;               // for display: the file's format
  int degree = 0;                   // the spherical harmonics' degree, 0 to 3
  std::vector<glm::vec3> position;  // world units, from axes.origin
  std::vector<glm::vec3> scale;     // standard deviations, world units (not logarithms)
  std::vector<glm::vec4> rotation;  // unit quaternions (w, x, y, z)
  std::vector<float> opacity;       // in [0, 1] (not logits)
  std::vector<float> sh;            // (count, sh_count(degree), 3): coefficient-major, RGB together
  std::size_t left_out = 0;         // Gaussians of the source that were dropped as invalid (place())
  bool lacks_degree_4 = false;      // its file also has harmonics of degree 4, which are not drawn
  ModelAxes axes;
  std::optional<glm::dvec3> up;  // in the world, if the file says it; none: that of the axes
  /// Number of Gaussians that the model may grow to while it is drawn (scene/model_chunks.h). Renderers
  /// reserve memory for all of them at the start, so that no frame waits for an allocation.
  std::size_t capacity = 0;
  /// If set, the scaffold generates the Gaussians for each eye, and all arrays above but `position` are
  /// placeholders (scene/scaffold.h).
  std::shared_ptr<Scaffold> scaffold;

  std::size_t count() const { return position.size(); }
  void set_training(const Training& training) { static_cast<Training&>(*this) = training; }
  void reserve(std::size_t n);
  void resize(std::size_t n);
};

struct GaussianValues {
  glm::dvec3 position;  // from zero, not from the model's origin
  glm::vec3 scale;      // standard deviations, or their logarithms
  glm::vec4 rotation;   // quaternion w x y z of any length
  float opacity;        // 0 to 1, or its logit
  const float* sh;      // 3 * sh_count(model.degree) values in the model's order
};

/// decode_raw and place store Gaussian `i`, for readers that decode on several cores (decode_all). decode_raw
/// takes the values that trainers store (logarithms and logits), place takes linear scales and opacities.
/// Each returns whether the Gaussian is valid. Invalid Gaussians have values that are not finite, a zero
/// quaternion, a scale below 0 or above 1e13, or an opacity outside 0 to 1 by more than rounding.
bool decode_raw(Model& model, std::size_t i, const GaussianValues& raw);
bool place(Model& model, std::size_t i, const GaussianValues& values);

/// Returns the coefficient of degree 0 for a base colour.
inline float sh_of_colour(double colour) { return static_cast<float>((colour - 0.5) / sh_c0); }

/// Throws Error, naming `source`, if over 1 % of the opacities lie outside 0 to 1: they are probably logits.
void check_opacities(const std::string& source, std::span<const float> opacities);

/// Removes the Gaussians whose `kept` is 0 and counts them in left_out.
void keep_only(Model& model, const std::vector<std::uint8_t>& kept);

/// Resizes a model, calls decode(i) for each Gaussian on all cores, and removes those for which it is false.
void decode_all(Model& model, std::size_t count, const std::function<bool(std::size_t i)>& decode);

/// For readers of positions finer than floats, which first round them to floats, relative to zero. If the
/// model is so far from zero that this rounding is visible, sets axes.origin near its middle and returns
/// true: the reader must then set the positions again, relative to the origin.
[[nodiscard]] bool choose_origin(Model& model);

/// Calls choose_origin(); if it moved the origin, sets the positions again.
void set_far_positions(Model& model, std::span<const glm::dvec3> positions);

/// Makes positions relative to a new origin. Returns the largest rounding error of a position, world units.
double move_origin(Model& model, const glm::dvec3& origin);

/// Returns the box from the 2nd to the 98th percentile of positions on each axis, relative to zero, without
/// what is farther than 8 core radii (scene/core.h), as skies are. Outliers hardly change it. Gaussians of
/// opacity 0 are ignored, unless all have opacity 0.
Bounds core_bounds(const Model& model);

/// Returns the box around all positions, relative to zero.
Bounds all_bounds(const Model& model);

/// A box, empty at first.
struct Box {
  glm::dvec3 low{INFINITY}, high{-INFINITY};

  void include(const glm::dvec3& lowest, const glm::dvec3& highest) {
    low = glm::min(low, lowest);
    high = glm::max(high, highest);
  }
  Box operator+(const glm::dvec3& by) const { return {low + by, high + by}; }
};

/// Return the box around the one-sigma ellipsoids of all or some Gaussians, relative to the origin.
Box bounds_of(const Model& model);
Box bounds_of(const Model& model, std::span<const std::uint32_t> indices);

}  // namespace binosplat
