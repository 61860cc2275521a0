#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/ground.h"
#include "scene/subject.h"

namespace binosplat {

namespace {

/// Height of the eyes in a model no larger than a person.
constexpr double highest_eyes = 0.7;

/// Directions from the middle of a level circle.
struct Circle {
  glm::dvec3 up;
  std::array<glm::dvec3, 2> level;

  explicit Circle(const glm::dvec3& upwards) : up(glm::normalize(upwards)), level(level_directions(up)) {}

  /// Returns the angle of a direction, in radians.
  double turn_to(const glm::dvec3& away) const {
    return std::atan2(glm::dot(away, level[0]), glm::dot(away, level[1]));
  }

  glm::dvec3 away(double turn, double elevation) const {
    return std::sin(elevation) * up +
           std::cos(elevation) * (std::cos(turn) * level[1] + std::sin(turn) * level[0]);
  }
};

/// Angle from which cameras look down on a model.
constexpr double elevation_degrees = 15.0;
constexpr int places = 16;  // that are examined on a circle
constexpr double place_turn = glm::two_pi<double>() / places;

/// Returns the obstruction of the view from `eye` to `middle`, in sr: solid angle times opacity, summed over
/// the Gaussians in the nearer half of the distance.
double obstruction(const std::vector<SampledSplat>& splats, const glm::dvec3& eye, const glm::dvec3& middle) {
  const double distance = glm::distance(middle, eye);
  const glm::dvec3 forward = (middle - eye) / distance;
  double sum = 0.0;
  for (const SampledSplat& splat : splats) {
    const glm::dvec3 v = splat.place - eye;
    const double z = glm::dot(v, forward);
    const double square = glm::dot(v, v);
    // Within 45 degrees of the middle of the picture.
    if (z <= 0.0 || z > 0.5 * distance || square > 2.0 * z * z) continue;
    sum += std::min(1.0, splat.cover / (glm::two_pi<double>() * square));
  }
  return sum;
}

/// Sets the first camera to the clearest of 16 places on the circle, the first among equals, and returns its
/// obstruction in sr; infinite if none `is_possible`. Obstructions are rounded down to multiples of 0.02 sr,
/// one per cent of the examined cone, so that noise does not decide.
double turn_to_clearest(const std::vector<SampledSplat>& splats, const Circle& circle,
                        Capture::Around& around, double start, const auto& is_possible) {
  std::array<double, places> found{};
  const auto first = [&](auto k) {
    return around.distance * circle.away(start + place_turn * static_cast<double>(k), around.elevation);
  };
  parallel_for(found.size(), [&](std::size_t k) {
    const glm::dvec3 eye = around.middle + first(k);
    found[k] =
        is_possible(eye) ? 0.02 * std::floor(obstruction(splats, eye, around.middle) / 0.02) : INFINITY;
  });
  const auto best = std::min_element(found.begin(), found.end());
  around.first = first(best - found.begin());
  return *best;
}

bool always(const glm::dvec3&) { return true; }

template <typename Value>
double largest(const std::vector<SampledSplat>& splats, const Value& value) {
  double most = -INFINITY;
  for (const SampledSplat& splat : splats) most = std::max(most, value(splat));
  return most;
}

/// Returns the middle, and half of the length, of a model along a direction.
std::array<double, 2> extent(const std::vector<SampledSplat>& splats, const glm::dvec3& direction) {
  const auto end = [&](const glm::dvec3& d) {
    return largest(splats, [&](const SampledSplat& s) { return glm::dot(s.place, d) + s.reach(d); });
  };
  const double high = end(direction), low = -end(-direction);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

/// Returns the direction in which splats lie closest to one plane.
glm::dvec3 thin_axis(const std::vector<SampledSplat>& splats) {
  glm::dvec3 sum(0.0);
  glm::dmat3 squares(0.0);
  double all = 0.0;
  for (const SampledSplat& splat : splats) {
    all += splat.cover;
    sum += splat.cover * splat.place;
    squares += splat.cover * glm::outerProduct(splat.place, splat.place);
  }
  const glm::dmat3 spread = squares / all - glm::outerProduct(sum / all, sum / all) + glm::dmat3(1e-6);
  // Power iteration to the smallest eigenvalue's direction.
  glm::dvec3 direction = glm::normalize(glm::dvec3(0.1, 0.2, 1.0));
  for (int k = 0; k < 100; ++k) direction = glm::normalize(glm::inverse(spread) * direction);
  return direction;
}

/// Returns the width of the open place around `middle`, a point on the floor: the radius of the circle that a
/// person can look across, at most 3 heights of the eyes. 0: there is no floor.
double open_around(const std::vector<SampledSplat>& splats, const glm::dvec3& up, const glm::dvec3& middle,
                   double eyes) {
  constexpr int rings = 30;
  const double width = 3.0 * eyes / rings;
  std::array<double, rings> walls{};  // the share of a ring's height that is covered
  double floor = 0.0;
  for (const SampledSplat& splat : splats) {
    const glm::dvec3 v = splat.place - middle;
    const double height = glm::dot(v, up), distance = glm::length(v - height * up);
    if (std::abs(height) < 0.25 * eyes) {
      if (distance < 0.3 * eyes) floor += splat.cover;
    } else if (height > 0.0 && height < 1.25 * eyes && distance < 3.0 * eyes) {
      walls[static_cast<std::size_t>(distance / width)] +=
          splat.cover / (glm::two_pi<double>() * std::max(distance, width) * eyes);
    }
  }
  if (floor < 0.1 * eyes * eyes) return 0.0;
  double covered = 0.0;
  int ring = 0;
  while (ring < rings && (covered += walls[static_cast<std::size_t>(ring)]) < 0.1) ++ring;
  return width * ring;
}

/// Returns one of the widest open places near the middle, looking along the longest free way: the widest of
/// those in which least is close to the eyes. Haze and clutter may seem as open as a room.
std::optional<Capture::Around> open_place(const std::vector<SampledSplat>& splats, const Circle& circle,
                                          double floor, double eyes) {
  constexpr int half = 12, side = 2 * half + 1;
  struct Place {
    double radius = 0.0, score = 0.0;
    glm::dvec3 middle;
  };
  std::vector<Place> found(std::size_t{side} * side);
  parallel_for(found.size(), [&](std::size_t k) {
    const std::div_t cell = std::div(static_cast<int>(k), side);
    const glm::dvec2 at = glm::dvec2(cell.rem, cell.quot) / double{half} - 1.0;
    const glm::dvec3 aside = at.x * circle.level[0] + at.y * circle.level[1],
                     on_floor = aside + floor * circle.up;
    const double radius = open_around(splats, circle.up, on_floor, eyes);
    found[k] = {radius, radius - 0.1 * glm::length(aside), on_floor + eyes * circle.up};
  });
  std::erase_if(found, [&](const Place& place) { return place.radius <= 0.3 * eyes; });
  std::ranges::stable_sort(found, std::greater{}, &Place::score);
  std::optional<Capture::Around> best;
  double closest = INFINITY;
  constexpr std::size_t max_tried = 32;
  for (const Place& place : std::span(found).first(std::min(found.size(), max_tried))) {
    Capture::Around around{place.middle, 0.7 * place.radius};
    double least = INFINITY;
    for (int k = 0; k < places; ++k) {
      const glm::dvec3 away = circle.away(place_turn * k, 0.0), eye = around.middle + around.distance * away;
      const double obstructed = obstruction(splats, eye, eye - 2.0 * away);
      if (obstructed >= least) continue;
      least = obstructed;
      around.first = around.distance * away;
    }
    const glm::dvec3 eye = around.middle + around.first, ahead = -glm::normalize(around.first);
    const double close = std::floor(10.0 * obstruction(splats, eye, eye + 2.0 * eyes * ahead));
    if (close >= closest) continue;
    closest = close;
    best = around;
    if (close == 0.0) break;
  }
  return best;
}

/// Returns where a person on the floor at `floor`, with eyes `eyes` above it, has a clear view of the core;
/// or else, in a model of rooms or streets, which is larger than a person, the widest open place near the
/// middle, looking along the longest free way. Returns nothing if there is no such place.
std::optional<Capture::Around> standing(const std::vector<SampledSplat>& splats, const glm::dvec3& up,
                                        double floor, double eyes) {
  const Circle circle(up);
  constexpr double crowded = 0.2;  // sr, of the 1.8 sr that obstruction() examines
  std::optional<Capture::Around> found;
  double least = crowded;
  for (const double away : {0.9, 0.6, 0.4}) {
    Capture::Around around{glm::dvec3(0.0), std::hypot(away, floor + eyes), std::atan2(floor + eyes, away)};
    const double obstructed = turn_to_clearest(splats, circle, around, 0.0, [&](const glm::dvec3& eye) {
      return open_around(splats, circle.up, eye - eyes * circle.up, eyes) > 0.3 * eyes;
    });
    if (found ? obstructed >= least : obstructed > least) continue;
    least = obstructed;
    found = around;
  }
  return found || eyes >= highest_eyes ? found : open_place(splats, circle, floor, eyes);
}

/// Returns a circle from which the subject is whole in pictures of this shape. Its first camera has the
/// clearest view, and is as near as it may be. A relief is seen along its thin axis.
Capture::Around around_whole(const std::vector<SampledSplat>& all, const std::vector<SampledSplat>& subject,
                             const glm::dvec3& up, const PictureShape& shape) {
  const Circle circle(up);
  const auto [high, height] = extent(subject, up);
  const auto [left, width] = extent(subject, circle.level[0]);
  const auto [ahead, depth] = extent(subject, circle.level[1]);
  Capture::Around around{high * up + left * circle.level[0] + ahead * circle.level[1]};
  // A flat model is seen from above, but a relief that stands along its normal, from the front.
  around.elevation = glm::radians(std::clamp(45.0 - 60.0 * height / std::min(width, depth), 15.0, 45.0));
  double start = 0.0;
  glm::dvec3 thin = thin_axis(subject);
  const auto [aside, other] = level_directions(thin);
  const double rise = std::asin(std::clamp(glm::dot(thin, up), -1.0, 1.0));
  constexpr double flat = 0.25;
  if (std::abs(rise) < glm::radians(45.0) &&
      extent(subject, thin)[1] < flat * std::min(extent(subject, aside)[1], extent(subject, other)[1])) {
    const double front = glm::dot(thin, circle.level[1]) < -1e-6 ? -1.0 : 1.0;
    around.elevation = front * rise;
    start = circle.turn_to(front * thin);
  }
  const auto distance = [&](double turn) {
    constexpr double margin = 1.08;
    const glm::dvec3 away = circle.away(turn, around.elevation);
    const glm::dvec3 right = glm::normalize(glm::cross(away, up)), down = glm::cross(right, away);
    return margin * largest(subject, [&](const SampledSplat& s) {
             const glm::dvec3 v = s.place - around.middle;
             return glm::dot(v, away) +
                    std::max((std::abs(glm::dot(v, right)) + s.reach(right)) / shape.tan_x,
                             (std::abs(glm::dot(v, down)) + s.reach(down)) / shape.tan_y);
           });
  };
  std::array<double, places> distances{};
  parallel_for(places,
               [&](int k) { distances[static_cast<std::size_t>(k)] = distance(start + place_turn * k); });
  constexpr double nearest = 0.1;  // a single point must not lie in the camera
  around.distance = std::max(nearest, *std::max_element(distances.begin(), distances.end()));
  turn_to_clearest(all, circle, around, start, always);
  around.first *= std::max(nearest, distance(circle.turn_to(around.first))) / around.distance;
  return around;
}

/// Returns whether the edge of a subject is thin and far from most of it, as in a scene, whose surroundings
/// fade out. `whole` is the subject's circle.
bool frays(const std::vector<SampledSplat>& subject, const Capture::Around& whole,
           const PictureShape& shape) {
  std::vector<double> distances;
  for (const SampledSplat& splat : subject) distances.push_back(glm::length(splat.place));
  const double edge = whole.distance * std::min(shape.tan_x, shape.tan_y);
  const double most = quantile(std::move(distances), 0.9);
  constexpr double large = 4.0, far = 2.0;
  return edge > large && edge > far * most;
}

/// Returns a circle around the core, which fills the picture.
Capture::Around around_core(const std::vector<SampledSplat>& splats, const glm::dvec3& up,
                            const PictureShape& shape) {
  Capture::Around around{glm::dvec3(0.0), 1.0 / std::sin(std::atan(std::min(shape.tan_x, shape.tan_y))),
                         glm::radians(elevation_degrees)};
  turn_to_clearest(splats, Circle(up), around, 0.0, always);
  return around;
}

/// Returns whether a model stands on a floor at `floor`: much of it is above, and little below.
bool bears(const std::vector<SampledSplat>& splats, const glm::dvec3& up, double floor) {
  constexpr double thick = 0.15, around = 3.0;
  double all = 0.0, above = 0.0, below = 0.0;
  for (const SampledSplat& splat : splats) {
    if (glm::length(splat.place) > around) continue;
    const double height = glm::dot(splat.place, up) - floor, cover = std::min(splat.cover, 0.01);
    all += cover;
    (height < 0.0 ? below : above) += std::abs(height) > thick ? cover : 0.0;
  }
  return above > 0.01 * all && above > 4.0 * below;
}

bool surrounds(const std::vector<SampledSplat>& splats, const Capture::Around& around, const glm::dvec3& up) {
  const glm::dvec3 level = glm::normalize(around.first - glm::dot(around.first, up) * up);
  return surrounds(splats, around.middle + around.first, -level, up);
}

/// Returns the depths of the splats in a camera's picture, in world units and sorted, and how much each
/// covers.
std::vector<std::pair<double, double>> depths_in(const Camera& camera, const CoredModel& cored,
                                                 const std::vector<SampledSplat>& splats) {
  Camera from_core = camera;
  from_core.position -= into_world(cored.core.middle, cored.model.axes);
  std::vector<std::pair<double, double>> depths;
  for (const SampledSplat& splat : splats) {
    const ProjectedPoint seen = project_point(from_core, cored.core.radius * splat.place);
    const double covers = splat.cover * cored.core.radius * cored.core.radius / (seen.depth * seen.depth);
    if (seen.depth > 0.0 && seen.is_within(0.0)) depths.emplace_back(seen.depth, std::min(covers, 0.01));
  }
  std::sort(depths.begin(), depths.end());
  return depths;
}

}  // namespace

PictureShape shape_of(const Camera& camera) {
  return {0.5 * camera.width / camera.fx, 0.5 * camera.height / camera.fy};
}

Viewpoint find_viewpoint(const CoredModel& cored, const PictureShape& shape,
                         const std::optional<glm::dvec3>& known_up, double eyes,
                         std::optional<Viewpoint::Kind> wanted) {
  using Kind = Viewpoint::Kind;
  const Core& core = cored.core;
  const glm::dvec3 middle = into_world(core.middle, cored.model.axes);
  const std::vector<SampledSplat> splats = visible_splats(cored);
  const glm::dvec3 usual_up = cored.model.up.value_or(default_up);
  Viewpoint out{wanted.value_or(Kind::core), {glm::normalize(known_up.value_or(usual_up))}};
  const auto taking = [&](const Capture::Around& a) {
    out.capture.around = {middle + core.radius * a.middle, core.radius * a.distance, a.elevation,
                          core.radius * a.first};
    return out;
  };
  // The floor near the format's up; or else, in a model that is larger than a person, in any direction.
  const double eyes_at = std::min(eyes / core.radius, highest_eyes);
  auto ground = find_ground(cored, known_up);
  if (!known_up && !(ground && glm::dot(ground->up, usual_up) > 0.82)) {  // 35 degrees
    const auto other = std::exchange(ground, find_ground(cored, usual_up));
    // A room has walls all round, which are smaller than its floor.
    if (other && ground && eyes_at < highest_eyes && ground->share < 0.6 * other->share) ground = other;
  }
  const double floor =
      ground && ground->height ? (*ground->height - glm::dot(middle, ground->up)) / core.radius : 0.0;
  if (ground && ground->height && bears(splats, ground->up, floor)) {
    out.capture.up = ground->up;
    out.up_by_floor = !known_up;
    const auto stand = wanted ? std::nullopt : standing(splats, ground->up, floor, eyes_at);
    if (stand && surrounds(splats, *stand, ground->up)) {
      out.kind = Kind::within;
      out.eyes = eyes_at * core.radius;
      return taking(*stand);
    }
  }
  const Capture::Around of_core = around_core(splats, out.capture.up, shape);
  const std::vector<SampledSplat> subject = without_floaters(splats);
  if (wanted == Kind::core || subject.empty() || (!wanted && surrounds(splats, of_core, out.capture.up)))
    return taking(of_core);
  const Capture::Around of_whole = around_whole(splats, subject, out.capture.up, shape);
  if (!wanted && frays(subject, of_whole, shape)) return taking(of_core);
  out.kind = Kind::whole;
  return taking(of_whole);
}

bool any_camera_sees(std::span<const Camera> cameras, const CoredModel& cored) {
  const std::vector<SampledSplat> splats = visible_splats(cored);
  const glm::dvec3 middle = into_world(cored.core.middle, cored.model.axes);
  constexpr double min_share_in_view = 0.005, min_depth = 0.03;
  const double least = min_share_in_view * static_cast<double>(splats.size());
  return splats.empty() || std::ranges::any_of(cameras, [&](const Camera& camera) {
           const glm::dvec3 eye = (camera.position - middle) / cored.core.radius;
           return static_cast<double>(depths_in(camera, cored, splats).size()) > least &&
                  is_free(splats, eye, min_depth);
         });
}

std::optional<std::array<double, 2>> depths_seen(std::span<const Camera> cameras, const CoredModel& cored) {
  const std::vector<SampledSplat> splats = visible_splats(cored);
  std::array<double, 2> found{INFINITY, 0.0};
  constexpr std::size_t max_cameras = 16;  // of a long orbit, some are enough
  for (std::size_t k = 0; k < cameras.size(); k += cameras.size() / max_cameras + 1) {
    const auto depths = depths_in(cameras[k], cored, splats);
    double all = 0.0, below = 0.0;
    for (const auto& [depth, covers] : depths) all += covers;
    for (const auto& [depth, covers] : depths) {
      below += covers;
      if (below > 0.002 * all) found[0] = std::min(found[0], depth);
      if (below < 0.998 * all) found[1] = std::max(found[1], depth);
    }
  }
  return found[1] > 0.0 ? std::optional(found) : std::nullopt;
}

std::vector<Camera> orbit(const Capture& capture, int count, int width, int height, double fov_degrees) {
  const Capture::Around& around = *capture.around;
  const Circle circle(capture.up);
  const double start = circle.turn_to(around.first);
  std::vector<Camera> cameras;
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 away = circle.away(start + glm::two_pi<double>() * k / count, around.elevation);
    cameras.push_back(look_at(around.middle + around.distance * away, around.middle, circle.up, fov_degrees,
                              width, height));
    cameras.back().name = fmt::format("orbit_{:03}", k);
  }
  return cameras;
}

Camera first_camera(const Capture& capture, int width, int height, double fov_degrees) {
  const Capture::Around& around = *capture.around;
  Camera camera =
      look_at(around.middle + around.first, around.middle, capture.up, fov_degrees, width, height);
  camera.name = "framed";
  return camera;
}

Camera frame_model(const CoredModel& cored, int width, int height, double fov_degrees,
                   const std::optional<glm::dvec3>& up) {
  const double tan_y = std::tan(0.5 * glm::radians(fov_degrees));
  const Viewpoint viewpoint = find_viewpoint(cored, {tan_y * width / height, tan_y}, up);
  return first_camera(viewpoint.capture, width, height, fov_degrees);
}

}  // namespace binosplat
