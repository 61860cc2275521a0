// demo:city: a sunny afternoon.

#include <algorithm>
#include <cmath>

#include "demo/city_parts.h"

namespace binosplat::demo::city {

namespace {

// Irradiances are linear, in units in which 1 on a white wall is nearly white.
const dvec3 to_sun = glm::normalize(dvec3(0.58, -0.66, -0.34));
constexpr dvec3 sun{2.55, 2.25, 1.80};
constexpr dvec3 sky{0.52, 0.62, 0.80};
constexpr dvec3 bounce{0.30, 0.26, 0.21};  // from sunlit ground and walls
constexpr dvec3 haze{0.80, 0.85, 0.90};

// Rays start this far off their surface: it must not shade itself, and window panes lie this deep in walls.
constexpr double point_lift = 0.3;

// Cells of the ground with lists of what casts shadows on them.
constexpr double cell = 8.0;
constexpr double cells_x0 = -450.0, cells_z0 = -180.0;
constexpr int cells_x = 112, cells_z = 168;

int cell_at(double from, double at, int count) {
  return std::clamp(static_cast<int>((at - from) / cell), 0, count - 1);
}

std::size_t cell_index(int i, int j) {
  return static_cast<std::size_t>(j) * cells_x + static_cast<std::size_t>(i);
}

/// Part of a ray that lies in a half space: where gap + t * step >= 0.
void cut(double gap, double step, double& enter, double& leave) {
  if (step > 0.0) {
    enter = std::max(enter, -gap / step);
  } else if (step < 0.0) {
    leave = std::min(leave, -gap / step);
  } else if (gap < 0.0) {
    leave = -1.0;
  }
}

/// Whether a caster stands between a point and the sun.
bool shades(const Caster& caster, const dvec3& from) {
  if (caster.shape == Caster::Shape::ball) {
    const dvec3 way = caster.frame.origin - from;
    const double along = glm::dot(way, to_sun);
    return along > 0.0 && glm::dot(way, way) - along * along < caster.radius * caster.radius;
  }
  const dvec3 p = glm::transpose(caster.frame.axes) * (from - caster.frame.origin);
  const dvec3 d = glm::transpose(caster.frame.axes) * to_sun;
  const double slope = 2.0 * caster.roof_rise / caster.depth;
  double enter = 0.0, leave = 1e9;
  cut(p.x, d.x, enter, leave);
  cut(caster.width - p.x, -d.x, enter, leave);
  cut(p.z, d.z, enter, leave);
  cut(caster.depth - p.z, -d.z, enter, leave);
  cut(caster.eave + slope * p.z + p.y, slope * d.z + d.y, enter, leave);
  cut(caster.eave + slope * (caster.depth - p.z) + p.y, d.y - slope * d.z, enter, leave);
  return enter < leave;
}

/// Linear light to a display value: a soft shoulder, and a gamma of 2.
dvec3 developed_city(const dvec3& light) {
  dvec3 out;
  for (int i = 0; i < 3; ++i) {
    const double x = std::max(0.0, light[i]);
    out[i] = std::sqrt(x * (1.0 + x / 10.0) / (1.0 + x));
  }
  return out;
}

}  // namespace

Light::Light(const City& city) : city_(city), cells_(static_cast<std::size_t>(cells_x) * cells_z) {
  for (std::size_t k = 0; k < city.casters.size(); ++k) {
    const Caster& c = city.casters[k];
    const bool ball = c.shape == Caster::Shape::ball;
    const double height = ball ? 0.0 : c.eave + c.roof_rise;
    // The ground may lie some metres below the caster's foot.
    const dvec3 throws = -to_sun * ((height + 8.0) / -to_sun.y);
    dvec2 low(1e9), high(-1e9);
    for (const dvec2 corner : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1), dvec2(1, 1)}) {
      const dvec3 p =
          ball ? c.frame.at(c.radius * (2.0 * corner.x - 1.0), 0, c.radius * (2.0 * corner.y - 1.0))
               : c.frame.at(c.width * corner.x, 0, c.depth * corner.y);
      for (const dvec3& q : {p, p + throws}) {
        low = glm::min(low, dvec2(q.x, q.z));
        high = glm::max(high, dvec2(q.x, q.z));
      }
    }
    for (int j = cell_at(cells_z0, low.y, cells_z); j <= cell_at(cells_z0, high.y, cells_z); ++j) {
      for (int i = cell_at(cells_x0, low.x, cells_x); i <= cell_at(cells_x0, high.x, cells_x); ++i) {
        cells_[cell_index(i, j)].push_back(static_cast<std::uint32_t>(k));
      }
    }
  }
}

double Light::sun_at(const dvec3& p, const dvec3& normal, bool leaves) const {
  const double facing = glm::dot(normal, to_sun);
  if (!leaves && facing <= 0.0) return 0.0;
  const dvec3 from = p + point_lift * normal;
  const int i = cell_at(cells_x0, from.x, cells_x), j = cell_at(cells_z0, from.z, cells_z);
  double share = 1.0;
  for (const std::uint32_t k : cells_[cell_index(i, j)]) {
    const Caster& caster = city_.casters[k];
    const bool ball = caster.shape == Caster::Shape::ball;
    if ((ball && leaves) || !shades(caster, from)) continue;
    if (!ball) return 0.0;
    // The sun comes through leaves in spots.
    share = std::min(share, 0.12 + 0.88 * ramp(0.58, 0.72, noise(2.3 * (p.x - p.y), 2.3 * (p.z + p.y))));
  }
  return share * (leaves ? 0.35 + 0.65 * ramp(-0.6, 0.9, facing) : facing);
}

Light::Seen Light::seen(const dvec3& p, const dvec3& normal, const Material& material, bool leaves) const {
  const double height = city_.relief.at(0.0, p.z).y - p.y;
  // Between houses little of the sky is seen.
  const double open = 0.62 + 0.38 * ramp(0.0, 14.0, height);
  const double upwards = -normal.y;
  const dvec3 light = sun * sun_at(p, normal, leaves) + sky * (open * (0.72 + 0.28 * upwards)) +
                      bounce * (0.55 - 0.45 * upwards) + material.glow;
  const dvec3 from_camera = p - dvec3(0.0, -1.6, 0.0);
  const double far = glm::dot(from_camera, from_camera);
  const double hazy = far / (far + 1500.0 * 1500.0);
  Seen seen;
  seen.colour = mix(developed_city(material.colour * material.colour * light), haze, hazy);
  if (leaves) {  // the sun shines through
    seen.shine = material.colour * 0.16;
    seen.shine_axis = to_sun;
  } else {  // the brighter half of the sky, mirrored
    const dvec3 bright = glm::normalize(to_sun + dvec3(0.0, -1.0, 0.0));
    seen.shine = dvec3(0.28, 0.30, 0.32) * (material.gloss * (1.0 - hazy));
    seen.shine_axis = bright - normal * (2.0 * glm::dot(bright, normal));
  }
  return seen;
}

}  // namespace binosplat::demo::city
