#include "stream/head_motion.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>

namespace binosplat {

namespace {

constexpr double apart_s = 0.05;    // least time between poses
constexpr double max_gap_s = 0.25;  // with longer gaps the motion is unknown

glm::dmat3 axes_of_view(const shared::View& view) {
  return {glm::dvec3(view.row_x), glm::dvec3(view.row_y), glm::dvec3(view.row_z)};
}

glm::dvec3 eye_of(const shared::View& view) { return glm::dvec3(view.anchor) + glm::dvec3(view.eye); }

struct HeadVelocity {
  glm::dvec3 along{0.0};   // world units a second
  glm::dvec3 around{0.0};  // rotation axis times radians a second
};

HeadVelocity motion_of(const shared::View& from, const shared::View& to, double seconds) {
  HeadVelocity motion{(eye_of(to) - eye_of(from)) / seconds, {}};
  const glm::dmat3 a = axes_of_view(from), b = axes_of_view(to);
  if (a == b) return motion;
  const glm::dquat turn = glm::normalize(glm::quat_cast(b * glm::transpose(a)));
  const glm::dquat shorter = turn.w < 0.0 ? -turn : turn;
  motion.around = glm::axis(shorter) * glm::angle(shorter) / seconds;
  return motion;
}

/// Returns the velocity `now`; zero if it differs from `before` by more than |before|, as at a jump or start.
glm::dvec3 steady(const glm::dvec3& before, const glm::dvec3& now) {
  return glm::distance(before, now) <= glm::length(before) ? now : glm::dvec3(0.0);
}

void move(shared::View& view, const HeadVelocity& motion, double seconds) {
  glm::dmat3 axes = axes_of_view(view);
  if (const double angle = glm::length(motion.around) * seconds; angle > 0.0)
    axes = glm::mat3_cast(glm::angleAxis(angle, glm::normalize(motion.around))) * axes;
  const glm::dvec3 by = motion.along * seconds, eye = glm::dvec3(view.eye) + by;
  const glm::dvec3 translation = -(glm::transpose(axes) * eye);
  view.row_x = glm::vec4(glm::dvec4(axes[0], translation.x));
  view.row_y = glm::vec4(glm::dvec4(axes[1], translation.y));
  view.row_z = glm::vec4(glm::dvec4(axes[2], translation.z));
  view.eye = glm::vec4(glm::vec3(eye), view.eye.w);
  view.centre += glm::vec4(glm::vec3(by), 0.0f);
}

double seconds_between(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

void HeadMotion::note(std::span<const shared::View> views, Clock::time_point now) {
  if (views.size() != views_.size()) poses_ = {};
  views_.assign(views.begin(), views.end());
  if (!poses_[0].views.empty() && seconds_between(poses_[0].at, now) < apart_s) return;
  std::shift_right(poses_.begin(), poses_.end(), 1);
  poses_[0] = {views_, now};
}

std::vector<shared::View> HeadMotion::predicted(double seconds) const {
  std::vector<shared::View> views = views_;
  const auto& [latest, middle, first] = poses_;
  if (first.views.empty()) return views;
  const double now_s = seconds_between(middle.at, latest.at), before_s = seconds_between(first.at, middle.at);
  if (std::max(now_s, before_s) > max_gap_s) return views;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const HeadVelocity before = motion_of(first.views[v], middle.views[v], before_s),
                       now = motion_of(middle.views[v], latest.views[v], now_s);
    const HeadVelocity goes_on{steady(before.along, now.along), steady(before.around, now.around)};
    if (goes_on.along != glm::dvec3(0.0) || goes_on.around != glm::dvec3(0.0))
      move(views[v], goes_on, seconds);
  }
  return views;
}

}  // namespace binosplat
