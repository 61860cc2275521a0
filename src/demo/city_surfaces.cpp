// demo:city: surfaces in pieces of even grain, and the Gaussians on them.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

// Of the SH basis: the constant function, and the three linear ones.
constexpr double c0 = 0.28209479177387814, c1 = 0.4886025119029199;

/// Gaussians a cell apart overlap enough to close a surface when their standard deviation is this share of
/// the cell, although they stand a little off their places.
constexpr double city_overlap = 0.78;
constexpr double unrest = 0.12;  // cells
/// At a border where a sheet ends its outermost Gaussians lie this many cells inside: half transparent there.
constexpr double margin_at_end = 0.85;
/// Thickness of a flat Gaussian as a share of its smaller side, and at most: kilometres of ground must not
/// become fog.
constexpr double city_flatness = 0.08, thickest = 0.25;
constexpr float opacity = 0.97f;

/// Of leaves in a crown of radius 1.
constexpr double ball_area = 22.0;

/// The grain doubles at this distance from the nearest camera.
constexpr double near_distance = 4.0;
constexpr double along_streets = 0.33;  // how much a metre along them counts
/// Pieces of a sheet are no longer than this share of their distance, so that each has one grain; or a few
/// Gaussians.
constexpr double piece = 0.5, piece_grains = 4.0;
/// Coarse surfaces are no coarser than this share of their distance: Gaussians that reach around a camera
/// are drawn as fog.
constexpr double coarsest = 0.1;

/// Distance of the nearest camera; less of it along the streets, as people walk there.
double distance_to_heads(const City& city, const dvec3& p) {
  double nearest = 1e9;
  for (const Head& head : heads) {
    const dvec3 way = p - city.relief.at(head.eye.x, head.eye.z, head.eye.y);
    nearest = std::min(nearest, glm::length(dvec3(way.x, way.y, along_streets * way.z)));
  }
  return nearest;
}

double margin(bool ends) { return ends ? margin_at_end : 0.5; }

/// The mean material of a cell: of more points, the larger the cell is.
Material mean_material(const Surface& surface, const dvec2& middle, const dvec2& extent) {
  const double size = std::max(extent.x, extent.y);
  const int n = size < 0.05 ? 1 : size < 0.4 ? 2 : size < 2.0 ? 3 : 4;
  Material mean{.colour = dvec3(0.0)};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Material at = surface.texture(middle.x + ((i + 0.5) / n - 0.5) * extent.x,
                                          middle.y + ((j + 0.5) / n - 0.5) * extent.y);
      mean.colour += at.colour / double(n * n);
      mean.gloss += at.gloss / (n * n);
      mean.glow += at.glow / (n * n);
      mean.lit = at.lit;
    }
  }
  return mean;
}

void put(Model& model, std::size_t i, const dvec3& position, const glm::vec4& rotation, const dvec3& scale,
         const Light::Seen& seen) {
  model.position[i] = position;
  model.rotation[i] = rotation;
  model.scale[i] = scale;
  model.opacity[i] = opacity;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto channel = static_cast<int>(c);
    float* sh = &model.sh[12 * i + c];
    const double shine = seen.shine[channel] / c1;
    sh[0] = static_cast<float>((seen.colour[channel] - 0.5) / c0);
    sh[3] = static_cast<float>(-shine * seen.shine_axis.y);
    sh[6] = static_cast<float>(shine * seen.shine_axis.z);
    sh[9] = static_cast<float>(-shine * seen.shine_axis.x);
  }
}

void fill_sheet(const Light& light, const Surface& s, std::size_t first, Model& model) {
  const double length_u = glm::length(s.u), length_v = glm::length(s.v);
  const dvec3 u = s.u / length_u, v = s.v / length_v;
  const dvec3 normal = glm::normalize(glm::cross(u, v));
  const glm::vec4 rotation = quaternion(axes_from_normal(normal, u));
  const std::uint64_t n = s.count;
  const double even = std::sqrt(static_cast<double>(n) * length_v / length_u);
  const auto rows = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::llround(even)), 1, n);
  const Cells high(length_v, static_cast<std::uint32_t>(rows), margin(s.borders & border_low),
                   margin(s.borders & border_high));
  std::size_t at = first;
  for (std::uint64_t j = 0; j < rows; ++j) {
    const std::uint64_t in_row = (j + 1) * n / rows - j * n / rows;
    const Cells wide(length_u, static_cast<std::uint32_t>(in_row), margin(s.borders & border_left),
                     margin(s.borders & border_right));
    const double flat = std::min(thickest, city_overlap * city_flatness * std::min(wide.size, high.size));
    const double thin = s.thickness > 0.0 ? s.thickness : flat;
    const dvec3 scale(city_overlap * wide.size, city_overlap * high.size, thin);
    for (std::uint64_t i = 0; i < in_row; ++i, ++at) {
      const auto key = static_cast<std::int64_t>(at);
      const double shift_u = unrest * (2.0 * hash(key, 1) - 1.0),
                   shift_v = unrest * (2.0 * hash(key, 2) - 1.0);
      const double a = wide.first + (static_cast<double>(i) + shift_u) * wide.size;
      const double b = high.first + (static_cast<double>(j) + shift_v) * high.size;
      const dvec3 p = s.corner + a * u + b * v;
      const Material mean = mean_material(s, {s.at.x + a, s.at.y + b}, {wide.size, high.size});
      const Light::Seen seen = mean.lit ? light.seen(p, normal, mean, false) : Light::Seen{mean.colour};
      put(model, at, p, rotation, scale, seen);
    }
  }
}

/// A point within the unit ball.
dvec3 in_ball(Random& random) {
  while (true) {
    dvec3 p;
    for (int k = 0; k < 3; ++k) p[k] = random.uniform(-1.0, 1.0);
    const double square = glm::dot(p, p);
    if (square > 0.01 && square <= 1.0) return p;
  }
}

/// Leaves on the outside of lumps that overlap.
void fill_ball(const Light& light, const Surface& s, std::size_t first, Model& model) {
  constexpr std::uint32_t lumps = 11;
  constexpr double lump_radius = 0.50;  // of the crown's
  std::array<dvec3, lumps> middles;
  Random of_crown(std::uint64_t{s.seed} * 77 + 5);
  for (std::uint32_t k = 0; k < lumps; ++k) {
    middles[k] = glm::normalize(in_ball(of_crown)) * (k == 0 ? 0.0 : 1.0 - lump_radius);
  }
  const double mean = (s.u.x + s.u.y + s.u.z) / 3.0;
  const double area = ball_area * mean * mean;
  const double size = std::min(0.5 * mean, 0.62 * std::sqrt(area / s.count));
  for (std::uint32_t i = 0; i < s.count; ++i) {
    Random random((std::uint64_t{s.seed} << 32) + i);
    const dvec3 out = glm::normalize(in_ball(random));
    const double deep = std::max(random.uniform(), random.uniform()) * 0.35 + 0.65;
    // A few Gaussians alone are the whole crown.
    const double shell = lump_radius * deep * (1.0 - 0.5 * size / mean);
    const dvec3 place = s.count < lumps ? dvec3(0.0) : middles[i % lumps] + shell * out;
    const dvec3 p = s.corner + place * s.u;
    const dvec3 normal = glm::normalize(in_ball(random) + 0.6 * out);
    const dvec3 along = in_ball(random);
    Material leaf = s.texture(glm::length(place), glm::dot(place, out));
    leaf.colour *= 0.90 + 0.2 * random.uniform();
    const glm::vec4 rotation = quaternion(axes_from_normal(normal, along));
    const Light::Seen seen = light.seen(p, glm::normalize(out + place), leaf, true);
    put(model, first + i, p, rotation, dvec3(1.15, 0.85, 0.45) * size, seen);
  }
}

}  // namespace

double Builder::grain_at(const dvec3& p) const {
  return grain_ * (1.0 + distance_to_heads(city, p) / near_distance);
}

double Builder::grain_of(const Surface& surface, const dvec3& p) const {
  const double grain = grain_at(p);
  return std::min(surface.coarseness * grain, std::max(grain, coarsest * distance_to_heads(city, p)));
}

void Builder::sheet(const Surface& surface) {
  const double length_u = glm::length(surface.u), length_v = glm::length(surface.v);
  const dvec3 middle = surface.corner + 0.5 * (surface.u + surface.v);
  const double far = distance_to_heads(city, middle);
  const double nearest = std::max(0.0, far - 0.5 * std::max(length_u, length_v));
  Surface low = surface, high = surface;
  const double grain = grain_of(surface, middle);
  const double longest = std::max(piece * (near_distance + nearest), piece_grains * grain);
  if (std::max(length_u, length_v) <= longest) {
    // Strips much narrower than the grain are not to become needles.
    low.weight = std::max(length_u * length_v / grain, 0.5 * std::max(length_u, length_v)) / grain;
    surfaces.push_back(low);
  } else if (length_u > length_v) {
    low.u = high.u = 0.5 * surface.u;
    high.corner += low.u;
    high.at.x += 0.5 * length_u;
    low.borders &= ~border_right;
    high.borders &= ~border_left;
    sheet(low);
    sheet(high);
  } else {
    low.v = high.v = 0.5 * surface.v;
    high.corner += low.v;
    high.at.y += 0.5 * length_v;
    low.borders &= ~border_high;
    high.borders &= ~border_low;
    sheet(low);
    sheet(high);
  }
}

void Builder::ball(const Surface& surface) {
  Surface whole = surface;
  whole.ball = true;
  const double grain = grain_of(surface, surface.corner);
  whole.weight = ball_area * surface.u.x * surface.u.x / (grain * grain);
  surfaces.push_back(whole);
}

void Builder::wire(const dvec3& from, const dvec3& to, double radius, const Texture& texture) {
  const dvec3 along = to - from;
  const dvec3 side = glm::normalize(dvec3(along.y, -along.x, 0.0)) * (2.0 * radius);
  Surface post{.corner = from - 0.5 * side,
               .u = side,
               .v = along,
               .texture = texture,
               .borders = all_borders,
               .thickness = 0.6 * radius};
  const double grain = grain_at(from + 0.5 * along);
  post.weight = glm::length(along) * 2.0 * radius / (grain * grain);
  surfaces.push_back(post);
}

void Builder::box(const Frame& frame, const dvec3& low, const dvec3& high, const Surface& like) {
  const std::array<dvec2, 5> round = {dvec2(low.x, low.z), dvec2(high.x, low.z), dvec2(high.x, high.z),
                                      dvec2(low.x, high.z), dvec2(low.x, low.z)};
  Surface side = like;
  side.borders = all_borders;
  for (std::size_t k = 0; k < 4; ++k) {
    side.corner = frame.at(round[k].x, high.y, round[k].y);
    side.u = frame.at(round[k + 1].x, high.y, round[k + 1].y) - side.corner;
    side.v = frame.axes[1] * (low.y - high.y);
    sheet(side);
    side.at.x += glm::length(side.u);
  }
  side.corner = frame.at(low.x, low.y, low.z);
  side.u = frame.axes[0] * (high.x - low.x);
  side.v = frame.axes[2] * (high.z - low.z);
  side.at = like.at + dvec2(0.0, high.y - low.y);
  sheet(side);
}

void fill(const Light& light, const Surface& surface, std::size_t first, Model& model) {
  if (surface.ball) {
    fill_ball(light, surface, first, model);
  } else {
    fill_sheet(light, surface, first, model);
  }
}

}  // namespace binosplat::demo::city
