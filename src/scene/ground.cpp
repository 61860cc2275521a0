#include "scene/ground.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

/// More flat Gaussians are sampled. A sample of all Gaussians of a large model has too few flat ones.
constexpr std::size_t ground_sample = 50000;
/// A Gaussian is flat if its smallest scale is at most `flat` times the middle one. Gaussians with an opacity
/// below `opaque` are ignored.
constexpr float flat = 0.3f, opaque = 0.5f;
/// A flat Gaussian counts at most this many times the mean. Otherwise a few large ones would decide.
constexpr double max_times_mean = 10.0;
/// Fewer flat Gaussians give no ground.
constexpr std::size_t min_flat_pieces = 200;
/// Largest angle between a surface and exactly level or upright, in degrees.
constexpr double level_degrees = 10.0;
/// Vote of an upright surface, relative to a level one of the same area. In a model of walls alone, the
/// direction that all walls share must win over each wall's normal. On a floor alone, the normal must win.
constexpr double upright_counts = 0.3;
/// The best direction must have this many times the votes of each direction over 30 degrees away.
constexpr double stands_out = 1.05;

/// A flat Gaussian, in the world.
struct Piece {
  glm::dvec3 place;  // relative to the core's middle, in core radii
  glm::dvec3 normal;
  double weight;  // area times opacity, less with distance from the core
};

std::vector<Piece> pieces_of(const CoredModel& cored) {
  const Model& model = cored.model;
  const Core& core = cored.core;
  const glm::dmat3 world = world_from_axes(model.axes.letters);
  const auto thinnest = [&](std::size_t i) {
    const glm::vec3& s = model.scale[i];
    return s.x <= s.y && s.x <= s.z ? 0 : s.y <= s.z ? 1 : 2;
  };
  std::vector<std::size_t> flats;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const int thin = thinnest(i);
    const glm::vec3& s = model.scale[i];
    if (model.opacity[i] >= opaque && s[thin] <= flat * std::min(s[(thin + 1) % 3], s[(thin + 2) % 3]))
      flats.push_back(i);
  }
  std::vector<Piece> pieces;
  double all = 0.0;
  for (std::size_t k = 0; k < flats.size(); k += flats.size() / ground_sample + 1) {
    const std::size_t i = flats[k];
    const int thin = thinnest(i);
    const float wide = model.scale[i][(thin + 1) % 3], other = model.scale[i][(thin + 2) % 3];
    const glm::vec4& q = model.rotation[i];
    const glm::dmat3 turned = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
    const glm::dvec3 place = (glm::dvec3(model.position[i]) - core.middle) / core.radius;
    // A huge Gaussian of the background is no floor: limit its area.
    const double area = std::min(static_cast<double>(wide) * other / (core.radius * core.radius), 0.01);
    const double weight = model.opacity[i] * area / (1.0 + 0.25 * glm::dot(place, place));
    if (weight > 0.0) pieces.push_back({world * place, world * turned[thin], weight});
    all += weight;
  }
  for (Piece& piece : pieces)
    piece.weight = std::min(piece.weight, max_times_mean * all / static_cast<double>(pieces.size()));
  return pieces;
}

const double aligned = std::cos(glm::radians(level_degrees)), across = std::sin(glm::radians(level_degrees));

/// Returns a piece's vote for `up`: positive if the piece is level, negative if it is upright.
double vote(const Piece& piece, const glm::dvec3& up) {
  const double x = std::abs(glm::dot(up, piece.normal));
  return x > aligned ? piece.weight : x < across ? -upright_counts * piece.weight : 0.0;
}

/// Refines an axis by least squares: level pieces have normals along the axis, upright pieces across it.
glm::dvec3 refined(glm::dvec3 direction, std::span<const Piece> pieces) {
  for (int round = 0; round < 4; ++round) {
    glm::dmat3 sum(0.0);
    double upright = 0.0;
    for (const Piece& piece : pieces) {
      const double weight = vote(piece, direction);
      sum += weight * glm::outerProduct(piece.normal, piece.normal);
      upright -= std::min(weight, 0.0);
    }
    // Power iteration to the largest eigenvalue's direction; the shift makes all eigenvalues positive.
    sum += glm::dmat3(upright);
    for (int k = 0; k < 50; ++k) direction = glm::normalize(sum * direction);
  }
  return direction;
}

std::optional<glm::dvec3> axis_of(std::span<const Piece> pieces) {
  if (pieces.size() < min_flat_pieces) return std::nullopt;
  constexpr int count = 1000;  // on a half sphere, a Fibonacci spiral with a spacing of about 4 degrees
  std::vector<glm::dvec3> directions(count);
  std::vector<double> votes(count);
  parallel_for(count, [&](int k) {
    const auto n = static_cast<std::size_t>(k);
    const double z = (k + 0.5) / count, ring = std::sqrt(1.0 - z * z), turn = 2.399963 * k;
    directions[n] = {ring * std::cos(turn), ring * std::sin(turn), z};
    for (const Piece& piece : pieces) votes[n] += std::abs(vote(piece, directions[n]));
  });
  const auto best = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  const double far = std::cos(glm::radians(30.0));
  for (std::size_t n = 0; n < count; ++n) {
    if (std::abs(glm::dot(directions[n], directions[best])) < far && votes[n] * stands_out > votes[best])
      return std::nullopt;
  }
  return refined(directions[best], pieces);
}

/// Returns the end of the axis that is up: models extend farther above the middle of their pieces than below.
/// If neither end extends clearly farther, up is the end towards -y or z, the usual choices of worlds.
glm::dvec3 upper(const glm::dvec3& axis, std::span<const Piece> pieces) {
  constexpr double around = 3.0;  // core radii: pieces farther away are sky, above and below
  std::vector<double> heights;
  for (const Piece& piece : pieces) {
    if (glm::length(piece.place) < around) heights.push_back(glm::dot(piece.place, axis));
  }
  if (heights.empty()) return axis;
  const double middle = quantile(heights, 0.5);
  const double above = quantile(heights, 0.95) - middle, below = middle - quantile(heights, 0.05);
  const double usual = std::abs(axis.z) > std::abs(axis.y) ? axis.z : -axis.y;
  constexpr double min_asymmetry = 1.35;
  const double sense = above > min_asymmetry * below ? 1.0 : below > min_asymmetry * above ? -1.0 : usual;
  return sense < 0.0 ? -axis : axis;
}

/// Sets the floor's height along `up`, from the core's middle and in core radii, and its share.
void find_floor(std::span<const Piece> pieces, Ground& ground) {
  const glm::dvec3& up = ground.up;
  constexpr double around = 2.0;
  std::vector<double> heights;
  double flat_weight = 0.0;
  for (const Piece& piece : pieces) {
    if (glm::length(piece.place) > around) continue;
    flat_weight += piece.weight;
    if (std::abs(glm::dot(piece.normal, up)) > aligned) heights.push_back(glm::dot(piece.place, up));
  }
  if (heights.size() < min_flat_pieces / 2) return;
  // Tables and ceilings are level, too: the floor is the lowest level surface.
  const double floor = quantile(std::move(heights), 0.1);
  // A floor reaches all round the core. A level surface that does not is the base of an object.
  constexpr double thick = 0.1, near = 0.3;
  constexpr int sectors = 8, min_sectors = 6;
  constexpr double share = 0.02;
  const auto [aside, ahead] = level_directions(up);
  std::array<bool, sectors> reached{};
  double floor_weight = 0.0;
  for (const Piece& piece : pieces) {
    const double height = glm::dot(piece.place, up) - floor, x = glm::dot(piece.place, aside),
                 y = glm::dot(piece.place, ahead);
    if (std::abs(height) > thick || std::abs(glm::dot(piece.normal, up)) < aligned) continue;
    if (glm::length(piece.place) > around) continue;
    floor_weight += piece.weight;
    if (std::hypot(x, y) < near) continue;
    const double turn = (std::atan2(y, x) / glm::two_pi<double>() + 0.5) * sectors;
    reached[static_cast<std::size_t>(turn) % sectors] = true;
  }
  if (floor_weight < share * flat_weight || std::count(reached.begin(), reached.end(), true) < min_sectors)
    return;
  ground.height = floor;
  ground.share = floor_weight / flat_weight;
}

}  // namespace

std::optional<Ground> find_ground(const CoredModel& cored, const std::optional<glm::dvec3>& up) {
  if (cored.model.scaffold) return std::nullopt;
  const std::vector<Piece> pieces = pieces_of(cored);
  Ground ground;
  if (up) {
    ground.up = glm::normalize(*up);
  } else {
    const auto axis = axis_of(pieces);
    if (!axis) return std::nullopt;
    ground.up = upper(*axis, pieces);
  }
  find_floor(pieces, ground);
  if (ground.height)
    ground.height = glm::dot(into_world(cored.core.middle, cored.model.axes), ground.up) +
                    *ground.height * cored.core.radius;
  return ground;
}

std::array<glm::dvec3, 2> level_directions(const glm::dvec3& up) {
  const glm::dvec3 aside =
      glm::normalize(glm::cross(up, std::abs(up.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
  return {aside, glm::cross(up, aside)};
}

}  // namespace binosplat
