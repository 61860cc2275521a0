#include "scene/key_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"

namespace binosplat {

namespace {

/// Cameras are keys if their median interval in seconds is above this: no film has fewer than 10 frames a
/// second. It is slightly above 0.1, so that frames 0.1 s apart with rounded times make no keys.
constexpr double keys_apart = 0.1 * (1.0 + 1e-3);
/// More would hardly fit into memory.
constexpr double max_key_path_frames = 1e6;

// Returns the lens for a picture of 1 by 1: the logarithms of the focal lengths, which make a zoom even, and
// the principal point.
glm::dvec4 lens_of(const Camera& camera) {
  return {std::log(camera.fx / camera.width), std::log(camera.fy / camera.height), camera.cx / camera.width,
          camera.cy / camera.height};
}

/// Returns a rotation's axis with its angle as length.
glm::dvec3 rotation_vector(const glm::dquat& turn) {
  const glm::dvec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  return sine > 0.0 ? axis * (2.0 * std::atan2(sine, turn.w) / sine) : glm::dvec3(0.0);
}

glm::dquat turn_by(const glm::dvec3& turn) {
  const double angle = glm::length(turn);
  return angle > 0.0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
}

/// De Casteljau's cubic, for any interpolation `between`.
template <typename T, typename Between>
T cubic(const T& a, const T& b, const T& c, const T& d, double u, const Between& between) {
  const T ab = between(a, b, u), bc = between(b, c, u), cd = between(c, d, u);
  return between(between(ab, bc, u), between(bc, cd, u), u);
}

/// Returns the Catmull-Rom slope at a knot, from the slopes of the chords into and out of it, which take the
/// times `before` and `after`. The slope is bounded, so that the path does not overshoot beside a much slower
/// chord. Positions are slow where the camera turns on the spot, rotations where it walks straight.
template <typename V>
V slope_between(const V& in, const V& out, double before, double after) {
  const V slope = (after * in + before * out) / (before + after);
  const double steepest = 3.0 * std::min(glm::length(in), glm::length(out));
  const double steep = glm::length(slope);
  return steep > steepest ? slope * (steepest / steep) : slope;
}

// The cubic from a to b with these slopes at its ends.
template <typename V>
V cubic_between(const V& a, const V& slope_a, const V& b, const V& slope_b, double apart, double u) {
  return cubic(a, a + slope_a * (apart / 3.0), b - slope_b * (apart / 3.0), b, u,
               [](const V& from, const V& to, double share) { return glm::mix(from, to, share); });
}

}  // namespace

bool times_rise(std::span<const Camera> cameras) {
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (!cameras[k].time || (k > 0 && !(*cameras[k].time > *cameras[k - 1].time))) return false;
  }
  return true;
}

bool are_keys(std::span<const Camera> cameras) {
  if (cameras.size() < 2 || !times_rise(cameras)) return false;
  std::vector<double> apart;
  for (std::size_t k = 1; k < cameras.size(); ++k) apart.push_back(*cameras[k].time - *cameras[k - 1].time);
  return quantile(std::move(apart), 0.5) > keys_apart;
}

KeyPath::KeyPath(std::span<const Camera> keys, const std::optional<double>& seconds) {
  if (keys.size() < 2) fail("a path needs at least two keys, found {}: add another", keys.size());
  if (!seconds && !times_rise(keys))
    fail("the times of a path's keys do not rise: give the path's duration in seconds");
  if (seconds && !(*seconds > 0.0 && std::isfinite(*seconds)))
    fail("path duration of {} s: expected more than 0", *seconds);
  first_ = keys[0];
  for (const Camera& key : keys) {
    // Convert all to one size: otherwise pixels between keys of different aspects would not be square.
    Knot knot{.place = key.position,
              .orientation = glm::normalize(glm::quat_cast(key.rotation)),
              .lens = lens_of(resized(key, first_.width, first_.height))};
    if (!seconds) knot.at = *key.time - *keys[0].time;
    // q and -q are one orientation: the nearer one avoids the long way round.
    if (!knots_.empty() && glm::dot(knot.orientation, knots_.back().orientation) < 0.0)
      knot.orientation = -knot.orientation;
    knots_.push_back(knot);
  }
  if (seconds) pace(*seconds);
  find_slopes();
}

// A section's time grows with its relative length and its rotation. Keys do not define a metre, so one radian
// counts as the mean distance between keys.
void KeyPath::pace(double seconds) {
  std::vector<double> ways, turns;
  double all = 0.0;
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    ways.push_back(glm::distance(knots_[k].place, knots_[k - 1].place));
    turns.push_back(
        glm::length(rotation_vector(glm::conjugate(knots_[k - 1].orientation) * knots_[k].orientation)));
    all += ways.back();
  }
  const double usual = all > 0.0 ? all / static_cast<double>(ways.size()) : 1.0;
  // Keys of equal pose also take time: a zoom, or a rest.
  constexpr double least = 0.05;
  for (std::size_t k = 0; k < ways.size(); ++k)
    knots_[k + 1].at = knots_[k].at + std::max(least, ways[k] / usual + turns[k]);
  const double scale = seconds / knots_.back().at;
  for (Knot& knot : knots_) knot.at *= scale;
}

void KeyPath::find_slopes() {
  // The straight connection from a knot to the next.
  struct Chord {
    double apart;
    glm::dvec3 velocity, angular_velocity;
    glm::dvec4 lens_velocity;
  };
  std::vector<Chord> chords;
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    const Knot &a = knots_[k - 1], &b = knots_[k];
    const double apart = b.at - a.at;
    chords.push_back({apart, (b.place - a.place) / apart,
                      rotation_vector(glm::conjugate(a.orientation) * b.orientation) / apart,
                      (b.lens - a.lens) / apart});
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const Chord& in = chords[k == 0 ? 0 : k - 1];
    const Chord& out = chords[std::min(k, chords.size() - 1)];
    Knot& knot = knots_[k];
    knot.velocity = slope_between(in.velocity, out.velocity, in.apart, out.apart);
    knot.angular_velocity = slope_between(in.angular_velocity, out.angular_velocity, in.apart, out.apart);
    knot.lens_velocity = slope_between(in.lens_velocity, out.lens_velocity, in.apart, out.apart);
  }
}

Camera KeyPath::at(double seconds) const {
  const double time = std::clamp(seconds, 0.0, knots_.back().at);
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time,
                                      [](double t, const Knot& knot) { return t < knot.at; });
  const Knot &a = *(after - 1), &b = *after;
  const double apart = b.at - a.at, u = (time - a.at) / apart;
  Camera camera = first_;
  camera.time = seconds;
  camera.position = cubic_between(a.place, a.velocity, b.place, b.velocity, apart, u);
  // glm::slerp takes the shorter arc, so it would jump if a section turns by more than half a turn.
  const auto spherical = [](const glm::dquat& from, const glm::dquat& to, double share) {
    // Opposite quaternions are one orientation; glm::mix would divide by 0.
    return glm::dot(from, to) <= -1.0 ? from : glm::mix(from, to, share);
  };
  camera.rotation = glm::mat3_cast(glm::normalize(
      cubic(a.orientation, a.orientation * turn_by(a.angular_velocity * (apart / 3.0)),
            b.orientation * turn_by(b.angular_velocity * (-apart / 3.0)), b.orientation, u, spherical)));
  const glm::dvec4 lens = cubic_between(a.lens, a.lens_velocity, b.lens, b.lens_velocity, apart, u);
  camera.fx = std::exp(lens.x) * camera.width;
  camera.fy = std::exp(lens.y) * camera.height;
  camera.cx = lens.z * camera.width;
  camera.cy = lens.w * camera.height;
  return camera;
}

std::vector<Camera> frames_of(const KeyPath& path, double frames_per_second, double seconds) {
  constexpr double rounded = 1e-6;  // frames; tolerates rounded times
  const double count = std::min(std::floor(path.seconds() * frames_per_second + rounded) + 1.0,
                                std::max(1.0, std::ceil(seconds * frames_per_second - rounded)));
  if (!(count <= max_key_path_frames)) {
    fail(
        "a path of {:.4g} s at {} frames a second has {:.3g} frames, more than {:.0e}: use fewer seconds, "
        "fewer frames a second or a faster tour",
        path.seconds(), frames_per_second, count, max_key_path_frames);
  }
  std::vector<Camera> frames;
  for (double n = 0.0; n < count; ++n) {
    frames.push_back(path.at(n / frames_per_second));
    frames.back().name = fmt::format("path_{:05}", frames.size() - 1);
  }
  return frames;
}

}  // namespace binosplat
