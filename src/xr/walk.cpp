#include "xr/walk.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace binosplat::xr {

namespace {

constexpr double eyes_above_floor = 1.6;  // m, of a standing viewer
constexpr double metres_a_second = 1.5;
constexpr double degrees_a_push = 30.0;
constexpr double pushed = 0.7, released = 0.4;  // stick deflections that begin and end a push
constexpr double dead_zone = 0.15;              // dead zone of sticks at rest
constexpr double max_scale = 100.0;  // maximum factor of scaling up and down, relative to the start

double without_dead_zone(double push) {
  return std::copysign(std::max(0.0, std::abs(push) - dead_zone) / (1.0 - dead_zone), push);
}

// The head's horizontal heading. If the head looks straight up or down, the space's forward direction.
glm::dvec3 heading_of(const Eye& head) {
  const glm::dvec4 q = glm::normalize(head.orientation);
  const glm::dvec3 ahead = glm::dquat(q.w, q.x, q.y, q.z) * glm::dvec3(0.0, 0.0, -1.0);
  const glm::dvec3 level(ahead.x, 0.0, ahead.z);
  return glm::length(level) > 1e-3 ? glm::normalize(level) : glm::dvec3(0.0, 0.0, -1.0);
}

}  // namespace

Placement upright_at(const glm::dvec3& position, const glm::dmat3& rotation, const glm::dvec3& up,
                     double units_per_metre) {
  const glm::dvec3 above = glm::normalize(up);
  const auto level = [&](const glm::dvec3& v) { return v - glm::dot(v, above) * above; };
  glm::dvec3 forward = level(rotation[2]);
  // If the camera looks straight up or down, uses the direction of its picture's upper edge.
  if (glm::length(forward) < 1e-3) forward = -level(rotation[1]);
  forward = glm::normalize(forward);
  return {position, {glm::cross(forward, above), above, -forward}, units_per_metre};
}

Placement start_of(Placement eyes, bool on_floor, const Eye* head) {
  if (on_floor) eyes.origin -= eyes_above_floor * eyes.units_per_metre * eyes.axes[1];
  if (head == nullptr) return eyes;
  const glm::dvec3 ahead = heading_of(*head);
  const double turned = std::atan2(-ahead.x, -ahead.z);  // radians to the left
  eyes.axes *= glm::mat3_cast(glm::angleAxis(-turned, glm::dvec3(0.0, 1.0, 0.0)));
  eyes.origin -= eyes.units_per_metre * (eyes.axes * glm::dvec3(head->position.x, 0.0, head->position.z));
  return eyes;
}

void Walk::turn(double radians, const glm::dvec3& about) {
  const glm::dmat3 turned =
      placement_.axes * glm::mat3_cast(glm::angleAxis(radians, glm::dvec3(0.0, 1.0, 0.0)));
  placement_.origin += placement_.units_per_metre * (placement_.axes * about - turned * about);
  placement_.axes = turned;
}

void Walk::scale(double factor, const glm::dvec3& about) {
  const double wanted = std::clamp(placement_.units_per_metre * factor, start_.units_per_metre / max_scale,
                                   start_.units_per_metre * max_scale);
  placement_.origin += (placement_.units_per_metre - wanted) * (placement_.axes * about);
  placement_.units_per_metre = wanted;
}

void Walk::shift(const glm::dvec3& metres) {
  placement_.origin += placement_.units_per_metre * (placement_.axes * metres);
}

// Moves the world with the hands that hold it.
void Walk::grab(const std::array<Hand, 2>& hands) {
  const auto holds = [&](std::size_t k) {
    return hands[k].grabs && last_[k].grabs && hands[k].position && last_[k].position;
  };
  if (holds(0) && holds(1)) {
    const glm::dvec3 before = *last_[1].position - *last_[0].position;
    const glm::dvec3 now = *hands[1].position - *hands[0].position;
    shift(0.5 * (*last_[0].position + *last_[1].position - *hands[0].position - *hands[1].position));
    const glm::dvec3 middle = 0.5 * (*hands[0].position + *hands[1].position);
    if (glm::length(before) > 1e-3 && glm::length(now) > 1e-3)
      scale(glm::length(before) / glm::length(now), middle);
    const auto heading = [](const glm::dvec3& v) { return std::atan2(-v.z, v.x); };
    if (std::hypot(before.x, before.z) > 1e-2 && std::hypot(now.x, now.z) > 1e-2)
      turn(heading(before) - heading(now), middle);
    return;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    if (holds(k)) return shift(*last_[k].position - *hands[k].position);
  }
}

void Walk::step(const Eye& head, const std::array<Hand, 2>& hands, double seconds) {
  grab(hands);
  last_ = hands;
  const glm::dvec3 forward = heading_of(head), right(-forward.z, 0.0, forward.x);
  const double metres = metres_a_second * seconds;
  shift(metres *
        (without_dead_zone(hands[0].stick.x) * right + without_dead_zone(hands[0].stick.y) * forward));
  const glm::dvec2 push = hands[1].stick;
  if (std::abs(push.y) > std::abs(push.x)) shift({0.0, metres * without_dead_zone(push.y), 0.0});
  if (std::abs(push.x) < released) turned_ = false;
  if (turned_ || std::abs(push.x) < pushed || std::abs(push.x) < std::abs(push.y)) return;
  turned_ = true;
  turn(glm::radians(push.x > 0.0 ? -degrees_a_push : degrees_a_push), head.position);
}

}  // namespace binosplat::xr
