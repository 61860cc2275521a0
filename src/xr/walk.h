#pragma once
// How hands move a head through a model: where the space that heads are located in lies in the model's world.
// Pure maths; the space is OpenXR's, x right, y up, z backward, metres.

#include <binosplat/eyes.h>

#include <array>
#include <optional>

namespace binosplat::xr {

/// What a hand does at a moment.
struct Hand {
  std::optional<glm::dvec3> position;  // m, in the space; none: not there
  glm::dvec2 stick{0.0};               // right and forward, each from -1 to 1
  bool grabs = false;
};

/// A space whose origin lies at a camera, upright and with the camera's heading. `rotation` is that of the
/// camera: its axes right, down and forward in the world, as columns. `up` in the world, of any length.
Placement upright_at(const glm::dvec3& position, const glm::dmat3& rotation, const glm::dvec3& up,
                     double units_per_metre);

/// Where OpenXR's space lies at first, for a viewer who stands, with eyes where upright_at() says: 1.6 m
/// lower where its origin lies on the floor. Where its origin is not where a head is at first, as in the
/// middle of a room, this head is there, and looks that way.
Placement start_of(Placement eyes, bool on_floor, const Eye* head = nullptr);

class Walk {
 public:
  explicit Walk(const Placement& start) : start_(start), placement_(start) {}

  const Placement& placement() const { return placement_; }
  void reset() { placement_ = start_; }

  /// Moves by what hands did in the last `seconds`. The left stick walks, level and towards where the head
  /// looks; the right one turns by 30 degrees a push, and pushed forward or back raises or lowers. A hand
  /// that grabs holds the world where it is; two turn it about the vertical and scale it, too.
  void step(const Eye& head, const std::array<Hand, 2>& hands, double seconds);

 private:
  void turn(double radians, const glm::dvec3& about);
  void scale(double factor, const glm::dvec3& about);
  void shift(const glm::dvec3& metres);
  void grab(const std::array<Hand, 2>& hands);

  Placement start_, placement_;
  std::array<Hand, 2> last_;
  bool turned_ = false;  // whether this push of the stick has turned already
};

}  // namespace binosplat::xr
