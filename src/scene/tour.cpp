#include "scene/tour.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <tuple>

#include "base/error.h"
#include "base/statistics.h"
#include "scene/key_path.h"

namespace binosplat {

namespace {

/// In the distance between two stops, a radian counts as this many metres. A neighbour that looks the other
/// way is not near, but positions count more.
constexpr double metres_a_radian = 0.5;
/// Cameras that differ by less than both limits are one stop: a path of millimetres has a random direction,
/// and the head would tremble there.
constexpr double same_metres = 0.01, same_degrees = 1.0;
/// Positions that differ by less than this share of the cameras' extent are equal apart from rounding.
constexpr double rounding = 1e-6;
/// Shortest time from rest to full speed. It also limits how fast the velocity changes where the path turns
/// back.
constexpr double seconds_to_full_speed = 0.15;
/// In longer tours the times of nearby keys would be rounded.
constexpr double max_tour_seconds = 1e9;

/// The camera between the eyes of a pair.
Camera head_of(const Camera& left, const Camera& right) {
  Camera head = left;
  head.position = 0.5 * (left.position + right.position);
  head.rotation =
      glm::mat3_cast(glm::slerp(glm::quat_cast(left.rotation), glm::quat_cast(right.rotation), 0.5));
  if (left.width == right.width) head.cx = 0.5 * (left.cx + right.cx);
  if (left.height == right.height) head.cy = 0.5 * (left.cy + right.cy);
  return head;
}

/// Returns the angle between two orientations in radians, from the chord, which is exact for small angles.
double turn_between(const Camera& a, const Camera& b) {
  const glm::dmat3 apart = a.rotation - b.rotation;
  const double square =
      glm::dot(apart[0], apart[0]) + glm::dot(apart[1], apart[1]) + glm::dot(apart[2], apart[2]);
  return 2.0 * std::asin(std::min(1.0, std::sqrt(square / 8.0)));
}

/// Returns a tour's stops, with the first head's lens and positions in metres. The first head comes first;
/// the others are sorted, so that the list's order has no effect. Skips heads that coincide with a stop.
std::vector<Camera> stops_of(const std::vector<Camera>& heads, double units_per_metre) {
  std::vector<Camera> all(heads.size(), heads[0]);
  for (std::size_t k = 0; k < heads.size(); ++k) {
    all[k].position = heads[k].position / units_per_metre;
    all[k].rotation = heads[k].rotation;
  }
  const auto rank = [](const Camera& stop) {
    const glm::dvec3 &p = stop.position, &x = stop.rotation[0], &z = stop.rotation[2];
    return std::tuple(p.x, p.y, p.z, x.x, x.y, x.z, z.x, z.y, z.z);
  };
  std::sort(all.begin() + 1, all.end(), [&](const Camera& a, const Camera& b) { return rank(a) < rank(b); });
  std::vector<Camera> stops;
  for (const Camera& stop : all) {
    const bool known = std::any_of(stops.begin(), stops.end(), [&](const Camera& other) {
      return glm::distance(stop.position, other.position) < same_metres &&
             turn_between(stop, other) < glm::radians(same_degrees);
    });
    if (!known) stops.push_back(stop);
  }
  return stops;
}

/// Distance between two stops for ordering, in metres.
double distance_between(const Camera& a, const Camera& b) {
  return glm::distance(a.position, b.position) + metres_a_radian * turn_between(a, b);
}

/// 2-opt: reverses sections while that shortens the tour. The first stop stays, the last may change.
void shorten(std::vector<Camera>& stops) {
  constexpr double min_gain = 1e-9;  // least gain, m
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t i = 0; i + 2 < stops.size(); ++i) {
      double into = distance_between(stops[i], stops[i + 1]);
      for (std::size_t j = i + 2; j < stops.size(); ++j) {
        const bool last = j + 1 == stops.size();
        const double now = into + (last ? 0.0 : distance_between(stops[j], stops[j + 1]));
        const double turned_into = distance_between(stops[i], stops[j]);
        if (turned_into > now - min_gain) continue;
        if (turned_into + (last ? 0.0 : distance_between(stops[i + 1], stops[j + 1])) > now - min_gain)
          continue;
        std::reverse(stops.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     stops.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        into = turned_into;
        shorter = true;
      }
    }
  }
}

/// Velocity and angular velocity between two poses, as shares of the motion's limits.
struct Velocity {
  glm::dvec3 velocity, angular_velocity;
};

Velocity velocity(const Camera& a, const Camera& b, const Motion& motion) {
  glm::dquat turn = glm::quat_cast(b.rotation * glm::transpose(a.rotation));
  if (turn.w < 0.0) turn = -turn;
  const double seconds = *b.time - *a.time;
  return {(b.position - a.position) / (motion.metres_per_second * seconds),
          2.0 * glm::dvec3(turn.x, turn.y, turn.z) / (glm::radians(motion.degrees_per_second) * seconds)};
}

/// The time at which an even turn along `keys` is as far as the head's at time `t`. Between two keys the head
/// almost rests, turns at up to 1.8 times the even rate, and almost rests again.
double time_of_turn(std::span<const Camera> keys, double t) {
  constexpr double unevenness = 0.8;  // 0: turns evenly; 1: rests at the keys
  const auto end =
      std::ranges::upper_bound(keys.subspan(1), t, {}, [](const Camera& key) { return *key.time; });
  if (end == keys.end()) return t;
  const double begin = *std::prev(end)->time, seconds = *end->time - begin;
  const double turn = 2.0 * glm::pi<double>() / seconds;
  return t - unevenness * std::sin(turn * (t - begin)) / turn;
}

/// The head at time `t` of a path through `keys`: it walks evenly and turns in saccades.
Camera head_at(const KeyPath& path, std::span<const Camera> keys, double t) {
  Camera head = path.at(t);
  head.rotation = path.at(time_of_turn(keys, t)).rotation;
  return head;
}

/// Returns the factor by which a section must be slower to keep speed and change of velocity within the
/// limits; below 1 if it may be faster.
double slowdown(const KeyPath& path, std::span<const Camera> keys, std::size_t section,
                const Motion& motion) {
  const double begin = *keys[section].time, end = *keys[section + 1].time;
  constexpr int samples = 32;
  const double step = (end - begin) / samples;
  double most = 0.0;
  Camera last = head_at(path, keys, begin);
  std::optional<Velocity> before;
  for (int n = 1; n <= samples; ++n) {
    const Camera next = head_at(path, keys, begin + n * step);
    const Velocity now = velocity(last, next, motion);
    most = std::max({most, glm::length(now.velocity), glm::length(now.angular_velocity)});
    if (before) {
      const double change = std::hypot(glm::distance(now.velocity, before->velocity),
                                       glm::distance(now.angular_velocity, before->angular_velocity));
      most = std::max(most, std::sqrt(seconds_to_full_speed * change / step));
    }
    last = next;
    before = now;
  }
  return most;
}

/// Returns the seconds from each camera to the next at full speed.
std::vector<double> seconds_between(std::span<const Camera> cameras, const Motion& motion) {
  std::vector<double> seconds;
  for (std::size_t k = 1; k < cameras.size(); ++k) {
    const Camera &a = cameras[k - 1], &b = cameras[k];
    seconds.push_back(std::max(glm::distance(a.position, b.position) / motion.metres_per_second,
                               turn_between(a, b) / glm::radians(motion.degrees_per_second)));
  }
  return seconds;
}

/// Returns the keys of a tour: the stops, and up to seven keys between distant stops, 0.8 s apart.
/// The keys lie on a path with centripetal times (by the roots of distances), which has no loops or cusps.
std::vector<Camera> keys_through(std::vector<Camera> stops, const Motion& motion) {
  constexpr double seconds_a_key = 0.8, max_keys = 8.0;
  const std::vector<double> seconds = seconds_between(stops, motion);
  if (const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0); !(all < max_tour_seconds)) {
    fail("the `tour` takes {:.2g} s, more than {:.0e}: choose a faster one, or other units per metre", all,
         max_tour_seconds);
  }
  stops[0].time = 0.0;
  for (std::size_t k = 1; k < stops.size(); ++k)
    stops[k].time = *stops[k - 1].time + std::sqrt(distance_between(stops[k - 1], stops[k]));
  const KeyPath way(stops);
  std::vector<Camera> keys = {stops[0]};
  for (std::size_t k = 1; k < stops.size(); ++k) {
    const double count = std::clamp(std::ceil(seconds[k - 1] / seconds_a_key), 1.0, max_keys);
    for (double n = 1.0; n <= count; ++n)
      keys.push_back(way.at(glm::mix(*stops[k - 1].time, *stops[k].time, n / count)));
  }
  return keys;
}

/// Sets the keys' times, as short as the limits of speed and change of velocity allow.
void set_times(std::vector<Camera>& keys, const Motion& motion) {
  constexpr int rounds = 16;      // a section's speed affects its neighbours
  constexpr double least = 1e-6;  // s
  std::vector<double> seconds = seconds_between(keys, motion);
  for (int round = 0; round <= rounds; ++round) {
    keys[0].time = 0.0;
    for (std::size_t k = 1; k < keys.size(); ++k)
      keys[k].time = *keys[k - 1].time + std::max(least, seconds[k - 1]);
    const KeyPath path(keys);
    double most = 1.0;
    for (std::size_t k = 1; k < keys.size(); ++k) {
      const double factor = slowdown(path, keys, k - 1, motion);
      seconds[k - 1] *= factor;
      most = std::max(most, factor);
    }
    if (round < rounds) continue;
    for (Camera& key : keys) *key.time *= most;
  }
}

}  // namespace

std::vector<Camera> heads_from_pairs(std::span<const Camera> cameras) {
  constexpr std::string_view left_end = "_left", right_end = "_right";
  std::map<std::string, const Camera*, std::less<>> by_name;
  for (const Camera& camera : cameras) by_name.emplace(camera.name, &camera);
  const auto other_eye = [&](const Camera& camera, std::string_view end,
                             std::string_view other) -> const Camera* {
    if (!camera.name.ends_with(end)) return nullptr;
    const auto found = by_name.find(camera.name.substr(0, camera.name.size() - end.size()).append(other));
    return found == by_name.end() ? nullptr : found->second;
  };
  std::vector<Camera> heads;
  for (const Camera& camera : cameras) {
    const Camera* const right = other_eye(camera, left_end, right_end);
    const Camera* const left = other_eye(camera, right_end, left_end);
    const Camera* const other = right != nullptr ? right : left;
    if (other == nullptr) {
      heads.push_back(camera);
    } else if (other > &camera) {
      heads.push_back(right != nullptr ? head_of(camera, *right) : head_of(*left, camera));
    }
  }
  return heads;
}

const std::vector<Motion>& head_motions() {
  static const std::vector<Motion> motions = {
      {"calm", 0.23, 28.0}, {"walk", 0.51, 82.0}, {"fast", 0.76, 183.0}};
  return motions;
}

double estimated_metre(std::span<const Camera> cameras) {
  const std::vector<Camera> heads = heads_from_pairs(cameras);
  double extent = 0.0;
  for (const Camera& head : heads) extent = std::max(extent, glm::distance(head.position, heads[0].position));
  std::vector<double> nearest;
  for (const Camera& head : heads) {
    double least = INFINITY;
    for (const Camera& other : heads) {
      const double apart = glm::distance(head.position, other.position);
      if (apart > rounding * extent) least = std::min(least, apart);
    }
    if (std::isfinite(least)) nearest.push_back(least);
  }
  return nearest.empty() ? 1.0 : quantile(std::move(nearest), 0.5);
}

std::vector<Camera> tour(std::span<const Camera> cameras, const TourSettings& settings) {
  const std::vector<Camera> heads = heads_from_pairs(cameras);
  if (heads.size() < 2) {
    fail("a `tour` needs at least two cameras, found {}: name a file with more, or go around the model",
         heads.size());
  }
  std::vector<Camera> stops = stops_of(heads, settings.units_per_metre);
  if (stops.size() < 2) {
    fail(
        "a `tour` needs different poses: all {} cameras are within {} m and {} degrees ({} world units per "
        "metre): name other cameras, or other units per metre",
        heads.size(), same_metres, same_degrees, settings.units_per_metre);
  }
  shorten(stops);
  std::vector<Camera> keys = keys_through(std::move(stops), settings.motion);
  set_times(keys, settings.motion);
  const KeyPath path(keys);
  std::vector<Camera> frames = frames_of(path, settings.frames_per_second, settings.seconds);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    frames[n].name = fmt::format("tour_{:05}", n);
    frames[n].rotation = head_at(path, keys, *frames[n].time).rotation;
    frames[n].position *= settings.units_per_metre;
  }
  return frames;
}

}  // namespace binosplat
