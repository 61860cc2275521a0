#pragma once
// Moves a head through a scene by mouse and keys. Pure maths, in world units and radians.

#include <glm/glm.hpp>

#include "scene/camera.h"

namespace binosplat::preview {

class Navigator {
 public:
  /// Starts at a camera. `up` is the world's up; the target is `distance` ahead of the camera.
  Navigator(const Camera& camera, const glm::dvec3& up, double distance);

  const Camera& camera() const { return camera_; }
  const glm::dvec3& target() const { return target_; }
  double distance() const { return glm::length(target_ - camera_.position); }

  /// Moves around the target: to the right about the world's up, and upwards. Stops a degree before a pole.
  void orbit(double right, double up);
  /// Turns the head in place. The target turns with it.
  void look(double right, double up);
  /// Moves along the camera's axes, with the target; if `walking`, level with the ground.
  void move(double right, double up, double forward, bool walking = false);
  /// Multiplies the distance to the target by `factor`.
  void dolly(double factor);
  /// Sets the vertical field of view. Pixels keep their aspect.
  void set_fov(double radians);
  double fov() const;
  /// Turns towards a new target.
  void focus(const glm::dvec3& point);

 private:
  void turn(double right, double up, const glm::dvec3& pivot);

  Camera camera_;
  glm::dvec3 up_;
  glm::dvec3 target_;
};

}  // namespace binosplat::preview
