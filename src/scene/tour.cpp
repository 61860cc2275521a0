#include "scene/tour.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <string_view>
#include <tuple>

#include "base/error.h"
#include "base/statistics.h"
#include "scene/curve.h"

namespace binosplat {

namespace {

/// What a turn of a radian counts for when the next camera is chosen: a neighbour that looks the other way is
/// not near, but places decide.
constexpr double metres_a_radian = 0.5;
/// Cameras that differ by less than both are one stop: a way of a few millimetres has no direction worth
/// keeping, and a head would tremble there.
constexpr double same_metres = 0.01, same_degrees = 1.0;
/// Two places nearer than this share of all cameras' extent are one that was rounded.
constexpr double rounding = 1e-6;
/// Samples of a way between stops: one in so many seconds, and no fewer than so many. Between them the head
/// goes straight on, so that speeds are exact, and bends are too slight to be seen.
constexpr double seconds_a_sample = 0.0025;
constexpr double samples_least = 64.0;
/// No change of velocity is quicker than from rest to full speed in this time, which bounds what a frame
/// differs from the last where the curve turns back. Other bends do not feel it.
constexpr double seconds_to_full_speed = 0.25;
/// More would hardly fit in memory.
constexpr double tour_frames_most = 1e6;
constexpr double tour_seconds_most = 1e12;  // of which a step is still a number of 64 bits apart

/// Where the head stops by, in metres.
struct Stop {
  glm::dvec3 place{0.0};
  glm::dquat turned{1, 0, 0, 0};  // the camera's axes in the world
};

/// The angle between two orientations in radians; by the chord, which is exact for small angles, too.
double turn_between(const glm::dquat& a, const glm::dquat& b) {
  const double chord = std::min(glm::length(a - b), glm::length(a + b));
  return 4.0 * std::asin(std::min(1.0, 0.5 * chord));
}

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

/// The heads that are worth a stop: the first, then the others in an order that the list's does not change.
std::vector<Stop> stops_of(const std::vector<Camera>& heads, double units_per_metre) {
  std::vector<Stop> all;
  for (const Camera& head : heads)
    all.push_back({head.position / units_per_metre, glm::normalize(glm::quat_cast(head.rotation))});
  const auto rank = [](const Stop& stop) {
    const glm::dvec3& p = stop.place;
    const glm::dquat& q = stop.turned;
    return std::tuple(p.x, p.y, p.z, q.x, q.y, q.z, q.w);
  };
  std::sort(all.begin() + 1, all.end(), [&](const Stop& a, const Stop& b) { return rank(a) < rank(b); });
  std::vector<Stop> stops;
  for (const Stop& stop : all) {
    const bool known = std::any_of(stops.begin(), stops.end(), [&](const Stop& other) {
      return glm::distance(stop.place, other.place) < same_metres &&
             turn_between(stop.turned, other.turned) < glm::radians(same_degrees);
    });
    if (!known) stops.push_back(stop);
  }
  return stops;
}

/// How far it is from one stop to another, in metres.
double way_between(const Stop& a, const Stop& b) {
  return glm::distance(a.place, b.place) + metres_a_radian * turn_between(a.turned, b.turned);
}

/// From the first on each next the nearest that is left.
void order_greedily(std::vector<Stop>& stops) {
  for (std::size_t k = 1; k + 1 < stops.size(); ++k) {
    std::size_t best = k;
    double least = way_between(stops[k - 1], stops[k]);
    for (std::size_t i = k + 1; i < stops.size(); ++i) {
      const double way = way_between(stops[k - 1], stops[i]);
      if (way < least) {
        best = i;
        least = way;
      }
    }
    std::swap(stops[k], stops[best]);
  }
}

/// 2-opt: parts of the tour are gone through backwards for as long as that makes it shorter; the first stop
/// stays, the last need not.
void shorten(std::vector<Stop>& stops) {
  constexpr double worth = 1e-9;  // m
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t i = 0; i + 2 < stops.size(); ++i) {
      double into = way_between(stops[i], stops[i + 1]);
      for (std::size_t j = i + 2; j < stops.size(); ++j) {
        const bool last = j + 1 == stops.size();
        const double now = into + (last ? 0.0 : way_between(stops[j], stops[j + 1]));
        const double turned_into = way_between(stops[i], stops[j]);
        if (turned_into > now - worth) continue;
        if (turned_into + (last ? 0.0 : way_between(stops[i + 1], stops[j + 1])) > now - worth) continue;
        std::reverse(stops.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     stops.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        into = turned_into;
        shorter = true;
      }
    }
  }
}

/// A stop as a knot of the curve: positions and quaternions are cubics between knots.
struct Knot {
  double at = 0.0;
  glm::dvec3 place{0.0}, place_slope{0.0};
  glm::dvec4 turned{0.0}, turned_slope{0.0};
};

/// Centripetal knots, which are apart by the root of the way: no loops and no cusps within a way.
std::vector<Knot> knots_of(const std::vector<Stop>& stops) {
  std::vector<Knot> knots;
  for (const Stop& stop : stops) {
    const glm::dquat& q = stop.turned;
    Knot knot{0.0, stop.place, {}, {q.x, q.y, q.z, q.w}, {}};
    if (!knots.empty()) {
      // q and -q are one orientation: the nearer one, or the head would go the long way round.
      if (glm::dot(knot.turned, knots.back().turned) < 0.0) knot.turned = -knot.turned;
      knot.at = knots.back().at + std::sqrt(way_between(stops[knots.size() - 1], stop));
    }
    knots.push_back(knot);
  }
  const auto chord = [](const Knot& a, const Knot& b, Knot& into) {
    into.place_slope = (b.place - a.place) / (b.at - a.at);
    into.turned_slope = (b.turned - a.turned) / (b.at - a.at);
  };
  chord(knots[0], knots[1], knots[0]);
  chord(knots[knots.size() - 2], knots.back(), knots.back());
  for (std::size_t k = 1; k + 1 < knots.size(); ++k) {
    const Knot &a = knots[k - 1], &c = knots[k + 1];
    Knot& b = knots[k];
    const double before = b.at - a.at, after = c.at - b.at;
    b.place_slope = slope_between((b.place - a.place) / before, (c.place - b.place) / after, before, after);
    b.turned_slope =
        slope_between((b.turned - a.turned) / before, (c.turned - b.turned) / after, before, after);
  }
  return knots;
}

template <typename V>
V hermite(const V& a, const V& slope_a, const V& b, const V& slope_b, double apart, double u) {
  const double v = 1.0 - u;
  return v * v * (1.0 + 2.0 * u) * a + u * u * (1.0 + 2.0 * v) * b +
         apart * u * v * (v * slope_a - u * slope_b);
}

/// A place along the curve.
struct Sample {
  Stop stop;
  double at = 0.0;            // s from the start at full speed
  double rate_squared = 1.0;  // of the full speed
  double time = 0.0;          // s from the start
};

/// How long it takes from one stop to another at full speed, in seconds.
double time_between(const Stop& a, const Stop& b, const Motion& motion) {
  return std::max(glm::distance(a.place, b.place) / motion.metres_per_second,
                  turn_between(a.turned, b.turned) / glm::radians(motion.degrees_per_second));
}

/// The curve as places so near to each other that the ways between are straight, with `at`; at least as far
/// as the head gets in so many seconds, and so much farther that what comes after has no say in them.
std::vector<Sample> samples_of(const std::vector<Knot>& knots, const Motion& motion, double seconds) {
  constexpr double too_near = 1e-9;  // s: the direction would be noise
  const double enough = seconds + 2.0 * seconds_to_full_speed;
  const auto stop_at = [](const glm::dvec3& place, const glm::dvec4& turned) {
    const glm::dvec4 q = glm::normalize(turned);
    return Stop{place, glm::dquat(q.w, q.x, q.y, q.z)};
  };
  std::vector<Sample> samples = {{stop_at(knots[0].place, knots[0].turned)}};
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const Knot &a = knots[k - 1], &b = knots[k];
    const double apart = b.at - a.at;
    const double straight = time_between(stop_at(a.place, a.turned), stop_at(b.place, b.turned), motion);
    const double count = std::max(samples_least, std::ceil(straight / seconds_a_sample));
    for (double n = 1.0; n <= count && samples.back().at < enough; ++n) {
      const Stop stop =
          stop_at(hermite(a.place, a.place_slope, b.place, b.place_slope, apart, n / count),
                  hermite(a.turned, a.turned_slope, b.turned, b.turned_slope, apart, n / count));
      const double step = time_between(samples.back().stop, stop, motion);
      if (step > too_near) samples.push_back({stop, samples.back().at + step});
    }
  }
  return samples;
}

/// How the head goes and turns from one sample to the next at full speed, as shares of what is allowed.
struct Velocity {
  glm::dvec3 going, turning;
};

Velocity velocity(const Sample& a, const Sample& b, const Motion& motion) {
  const glm::dquat turn = b.stop.turned * glm::conjugate(a.stop.turned);
  const double step = b.at - a.at;
  return {(b.stop.place - a.stop.place) / (motion.metres_per_second * step),
          2.0 * glm::dvec3(turn.x, turn.y, turn.z) / (glm::radians(motion.degrees_per_second) * step)};
}

/// Fills in rates and times: full speed, but slower where the curve bends more sharply than
/// seconds_to_full_speed allows, and before and after.
void time_samples(std::vector<Sample>& samples, const Motion& motion) {
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    const Velocity in = velocity(samples[k - 1], samples[k], motion);
    const Velocity out = velocity(samples[k], samples[k + 1], motion);
    const double change =
        std::hypot(glm::distance(in.going, out.going), glm::distance(in.turning, out.turning));
    const double step = 0.5 * (samples[k + 1].at - samples[k - 1].at);
    // The velocity's change in time is change / step * rate^2.
    if (change * seconds_to_full_speed > step)
      samples[k].rate_squared = step / (change * seconds_to_full_speed);
  }
  // At the same acceleration the rate's square changes evenly along the way.
  const auto bound = [](Sample& sample, const Sample& beside) {
    const double gain = 2.0 * std::abs(sample.at - beside.at) / seconds_to_full_speed;
    sample.rate_squared = std::min(sample.rate_squared, beside.rate_squared + gain);
  };
  for (std::size_t k = 1; k < samples.size(); ++k) bound(samples[k], samples[k - 1]);
  for (std::size_t k = samples.size() - 1; k > 0; --k) bound(samples[k - 1], samples[k]);
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const Sample& last = samples[k - 1];
    samples[k].time = last.time + 2.0 * (samples[k].at - last.at) /
                                      (std::sqrt(last.rate_squared) + std::sqrt(samples[k].rate_squared));
  }
}

/// Where the head is at a time between those of two samples.
Stop between(const Sample& a, const Sample& b, double time) {
  const double since = time - a.time, rate = std::sqrt(a.rate_squared);
  const double gain = (std::sqrt(b.rate_squared) - rate) / (b.time - a.time);
  const double share = std::clamp((rate * since + 0.5 * gain * since * since) / (b.at - a.at), 0.0, 1.0);
  return {glm::mix(a.stop.place, b.stop.place, share), glm::slerp(a.stop.turned, b.stop.turned, share)};
}

void check(const TourSettings& settings) {
  const auto good = [](double value) { return value > 0.0 && std::isfinite(value); };
  const Motion& motion = settings.motion;
  if (!good(motion.metres_per_second) || !good(motion.degrees_per_second)) {
    fail("a tour at {} m and {} degrees a second: expected speeds above 0", motion.metres_per_second,
         motion.degrees_per_second);
  }
  if (!(settings.seconds > 0.0)) fail("a tour of {} seconds: expected more than 0", settings.seconds);
  if (!good(settings.frames_per_second) || !good(settings.units_per_metre)) {
    fail("a tour of {} frames a second and {} units a metre: expected numbers above 0",
         settings.frames_per_second, settings.units_per_metre);
  }
}

/// The stops in the order of the tour.
std::vector<Stop> ordered_stops(const std::vector<Camera>& heads, double units_per_metre) {
  if (heads.size() < 2) {
    fail(
        "a tour goes through two cameras or more, and there is {}: name a file of more with --cameras, or go "
        "around the model with --orbit",
        heads.size());
  }
  std::vector<Stop> stops = stops_of(heads, units_per_metre);
  if (stops.size() < 2) {
    fail(
        "a tour goes through cameras that lie apart: all {} are within {} m and {} degrees, at {} world "
        "units "
        "a metre; name others with --cameras, or another scale with --units-per-metre",
        heads.size(), same_metres, same_degrees, units_per_metre);
  }
  order_greedily(stops);
  shorten(stops);
  return stops;
}

/// Before the long work: straight ways are the shortest.
void check_length(const std::vector<Stop>& stops, const TourSettings& settings) {
  double least = 0.0;  // s
  for (std::size_t k = 1; k < stops.size(); ++k)
    least += time_between(stops[k - 1], stops[k], settings.motion);
  if (least > tour_seconds_most) {
    fail("a tour of {:.2g} s, and {:.0e} fit: go faster (--tour), or name another scale (--units-per-metre)",
         least, tour_seconds_most);
  }
  // Between frames that are far apart there are samples, too.
  const double rate = std::max(settings.frames_per_second, 10.0);
  const double frames = std::min(least, settings.seconds) * rate;
  if (frames < tour_frames_most) return;
  fail(
      "a tour of {:.2g} frames or more, and {:.0e} fit: go faster (--tour), for less time (--seconds, at "
      "most {:.4g}) or at fewer frames a second (--fps)",
      frames, tour_frames_most, tour_frames_most / rate);
}

}  // namespace

std::vector<Camera> heads_of(std::span<const Camera> cameras) {
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
  static const std::vector<Motion> motions = {{"calm", 0.3, 12.0}, {"walk", 1.5, 45.0}, {"fast", 6.0, 200.0}};
  return motions;
}

double metre_of(std::span<const Camera> cameras) {
  const std::vector<Camera> heads = heads_of(cameras);
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
  check(settings);
  const std::vector<Camera> heads = heads_of(cameras);
  const std::vector<Stop> stops = ordered_stops(heads, settings.units_per_metre);
  check_length(stops, settings);
  std::vector<Sample> samples = samples_of(knots_of(stops), settings.motion, settings.seconds);
  time_samples(samples, settings.motion);
  std::vector<Camera> out;
  std::size_t next = 1;
  for (std::size_t n = 0;; ++n) {
    const double time = static_cast<double>(n) / settings.frames_per_second;
    // A frame that begins with the last moment is no part of so many seconds.
    if (n > 0 && (time > samples.back().time || time > settings.seconds - 1e-9)) break;
    while (next + 1 < samples.size() && samples[next].time < time) ++next;
    const Stop stop = between(samples[next - 1], samples[next], time);
    Camera& camera = out.emplace_back(heads[0]);
    camera.name = fmt::format("tour_{:05}", n);
    camera.position = stop.place * settings.units_per_metre;
    camera.rotation = glm::mat3_cast(stop.turned);
    camera.time = time;
  }
  return out;
}

}  // namespace binosplat
