#pragma once
// Moves a viewer through a model by hand controllers: updates the placement of OpenXR's space in the model's
// world. Pure maths; the space has x right, y up, z backward, in metres.

#include <binosplat/eyes.h>

#include <array>
#include <optional>

namespace binosplat::xr {

struct Hand {
  std::optional<glm::dvec3> position;  // m, in the space; none: not tracked
  glm::dvec2 stick{0.0};               // right and forward, each from -1 to 1
  bool grabs = false;
};

/// Returns an upright placement that has its origin at a camera and the camera's heading. The columns of
/// `rotation` are the camera's axes right, down and forward in the world. `up` is in the world, of any
/// length.
Placement upright_at(const glm::dvec3& position, const glm::dmat3& rotation, const glm::dvec3& up,
                     double units_per_metre);

/// The first placement of OpenXR's space, for a standing viewer. `eyes` is upright_at() of the eyes. With
/// `on_floor`, the space's origin lies 1.6 m below the eyes. If the head does not start at the origin, as in
/// a room's space, pass the head's pose as `head`: the head then starts at the position and heading of
/// `eyes`.
Placement start_of(Placement eyes, bool on_floor, const Eye* head = nullptr);

class Walk {
 public:
  explicit Walk(const Placement& start) : start_(start), placement_(start) {}

  const Placement& placement() const { return placement_; }
  void reset() { placement_ = start_; }

  /// Moves by the input of the last `seconds`. The left stick walks horizontally, relative to the head's
  /// heading. The right stick turns by 30 degrees per push to the side; pushed forward or back, it raises or
  /// lowers the head. A hand that grabs drags the world along; two hands also turn the world about the
  /// vertical and scale it.
  void step(const Eye& head, const std::array<Hand, 2>& hands, double seconds);

 private:
  void turn(double radians, const glm::dvec3& about);
  void scale(double factor, const glm::dvec3& about);
  void shift(const glm::dvec3& metres);
  void grab(const std::array<Hand, 2>& hands);

  Placement start_, placement_;
  std::array<Hand, 2> last_;
  bool turned_ = false;  // this push of the stick has already turned
};

}  // namespace binosplat::xr
