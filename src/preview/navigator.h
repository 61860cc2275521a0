#pragma once
// How a mouse and keys move a head through a scene. Pure maths, in world units and radians.

#include <glm/glm.hpp>

#include "scene/camera.h"

namespace binosplat::preview {

class Navigator {
 public:
  /// A head that looks from a camera; `up` is the world's, `target` lies `distance` ahead.
  Navigator(const Camera& camera, const glm::dvec3& up, double distance);

  const Camera& camera() const { return camera_; }
  const glm::dvec3& target() const { return target_; }
  double distance() const { return glm::length(target_ - camera_.position); }

  /// Around the target: to the right about the world's up, and upwards. Never over the top: the head stays at
  /// least a degree away from looking straight up or down.
  void orbit(double right, double up);
  /// Turns the head where it is; the target turns with it.
  void look(double right, double up);
  /// Along the camera's axes, target included; while walking, level with the ground.
  void move(double right, double up, double forward, bool walking = false);
  /// Towards the target: the distance is multiplied by `factor`.
  void dolly(double factor);
  /// The vertical angle that the camera sees; pixels stay as square as they were.
  void set_fov(double radians);
  double fov() const;
  /// What lies at this depth in a pixel of a camera beside the head (an eye) becomes the target, and is
  /// turned to without being moved to.
  void focus(const Camera& eye, const glm::dvec2& pixel, double depth);

 private:
  void turn(double right, double up, const glm::dvec3& pivot);

  Camera camera_;
  glm::dvec3 up_;
  glm::dvec3 target_;
};

}  // namespace binosplat::preview
