#include "demo/light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/parallel.h"
#include "base/progress.h"
#include "scene/harmonics.h"

namespace binosplat::demo {

namespace {

/// Within this distance a surface shades the surface that faces it.
constexpr double occlusion_reach = 0.7;
/// Distance from a surface at which its rays start, so that it does not shade itself. Outdoors,
/// where window panes are recessed in walls, the distance is larger.
constexpr double room_lift = 4e-3, outdoor_lift = 0.3;

/// Converts display-referred colours to linear light. Displays take the square root.
dvec3 to_linear(const dvec3& colour) { return colour * colour; }

/// Converts linear light to display values with a film-like shoulder (Narkowicz's fit of ACES).
dvec3 developed(const dvec3& light) {
  dvec3 out;
  for (int i = 0; i < 3; ++i) {
    const double x = std::max(0.0, light[i]);
    out[i] = std::sqrt(std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)));
  }
  return out;
}

using Harmonics = std::array<dvec3, 16>;

/// Adds a lobe max(0, cos)^sharpness about an axis, the direction from the eye in which it is brightest.
/// Coefficient (l, m) is band(l) times the basis function at the axis (Funk-Hecke); the integrals 2 pi
/// int_0^1 t^s P_l(t) dt have closed forms.
void add_lobe(Harmonics& sh, const dvec3& axis, const dvec3& rise, double sharpness) {
  const double s = sharpness, i0 = 1.0 / (s + 1.0), i1 = 1.0 / (s + 2.0), i2 = 1.0 / (s + 3.0),
               i3 = 1.0 / (s + 4.0);
  const double bands[] = {2.0 * pi * i0, 2.0 * pi * i1, pi * (3.0 * i2 - i0), pi * (5.0 * i3 - 3.0 * i1)};
  const std::array<double, 16> at_axis = sh_basis(axis);
  for (std::size_t l = 0; l < 4; ++l) {
    for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) sh[k] += rise * (bands[l] * at_axis[k]);
  }
}

/// A light that reaches a surface: its direction, and its irradiance on a surface that faces the light.
struct SeenLight {
  dvec3 direction, irradiance;
};

class Baker {
 public:
  Baker(const SceneBuilder& stage, const Lighting& light) : stage_(stage), light_(light) {
    constexpr int rays = 16;
    for (int i = 0; i < rays; ++i) {  // denser near the normal, with the cosine weights of a diffuse surface
      const double r = std::sqrt((i + 0.5) / rays);
      dome_.emplace_back(r * circle(0.38196601125 * i), std::sqrt(1.0 - r * r));
    }
  }

  Harmonics seen(const Disc& disc) const {
    constexpr double slack = 0.15;  // the window's frame and sill
    Harmonics sh{};
    if (!disc.material.lit) {
      sh[0] = (disc.material.colour - 0.5) / sh_c0;
    } else if (light_.room && glm::clamp(disc.position, light_.room->low - slack,
                                         light_.room->high + slack) == disc.position) {
      light_indoors(disc, sh);
    } else {
      light_outdoors(disc, sh);
    }
    return sh;
  }

 private:
  /// Returns the visible share of the sun's light.
  double sun_outdoors(const dvec3& p, const dvec3& normal, bool leaves) const {
    const double facing = glm::dot(normal, light_.to_sun);
    const dvec3 from = p + outdoor_lift * normal;
    if ((!leaves && facing <= 0.0) || !stage_.solids.is_free(from, light_.to_sun, 1e3)) return 0.0;
    if (leaves) return 0.3 + 0.5 * ramp(-0.6, 0.9, facing);  // leaves do not shade each other
    if (stage_.crowns.is_free(from, light_.to_sun, 1e3)) return facing;
    // Sunlight through leaves has spots.
    return facing * (0.12 + 0.88 * ramp(0.58, 0.72, noise(2.3 * (p.x - p.y), 2.3 * (p.z + p.y))));
  }

  void light_outdoors(const Disc& disc, Harmonics& sh) const {
    const Material& material = disc.material;
    const dvec3 &p = disc.position, &normal = disc.axes[2];
    // Houses hide much of the sky.
    const double open = 0.62 + 0.38 * ramp(0.0, 14.0, -p.y);
    const dvec3 light = light_.sun * sun_outdoors(p, normal, material.two_sided) +
                        light_.sky * (open * (0.72 - 0.28 * normal.y)) +
                        light_.bounce * (0.55 + 0.45 * normal.y) + material.glow;
    const double clear = 1.0 / (1.0 + glm::dot(p, p) / (light_.haze_distance * light_.haze_distance));
    sh[0] = (mix(light_.haze, developed(to_linear(material.colour) * light), clear) - 0.5) / sh_c0;
    if (material.two_sided) {  // the sun shines through
      add_lobe(sh, light_.to_sun, material.colour * (0.12 * clear), 1.0);
    } else if (material.gloss > 0.0) {  // reflects the brighter half of the sky
      const dvec3 bright = glm::normalize(light_.to_sun + up);
      add_lobe(sh, glm::reflect(bright, normal), dvec3(0.42, 0.45, 0.48) * (material.gloss * clear), 1.5);
    }
  }

  /// Returns the irradiance of one side of a surface in the room, and appends the lights that reach it.
  dvec3 received(const dvec3& p, const dmat3& axes, std::vector<SeenLight>& lights) const {
    const Interior& room = *light_.room;
    const dvec3 normal = axes[2];
    if (glm::dot(normal, light_.to_sun) > 0.0 && stage_.solids.is_free(p, light_.to_sun, 10.0))
      lights.push_back({light_.to_sun, room.sun});
    for (const Lamp& lamp : room.lamps) {
      const dvec3 way = lamp.place - p;
      const double far = std::max(0.15, glm::length(way));
      const double shines = lamp.facing == dvec3(0.0) ? 1.0 : glm::dot(lamp.facing, way) / far;
      if (glm::dot(normal, way) > 1e-4 && shines > 0.0 && stage_.solids.is_free(p, way, 0.97))
        lights.push_back({way / far, lamp.power * (shines / (far * far))});
    }
    dvec3 sum(0.0);
    for (const SeenLight& l : lights) sum += l.irradiance * glm::dot(normal, l.direction);
    for (const dvec3& ray : dome_) {
      const double way = stage_.solids.way(p, axes * ray, occlusion_reach);
      sum += room.ambient * (std::sqrt(way / occlusion_reach) / static_cast<double>(dome_.size()));
    }
    return sum;
  }

  void light_indoors(const Disc& disc, Harmonics& sh) const {
    const Material& material = disc.material;
    const dvec3 normal = disc.axes[2];
    std::vector<SeenLight> lights, behind;
    dvec3 light = received(disc.position + room_lift * normal, disc.axes, lights);
    if (material.two_sided) {
      const dmat3 turned_over(disc.axes[0], -disc.axes[1], -normal);
      light = 0.6 * light + 0.4 * received(disc.position - room_lift * normal, turned_over, behind);
    }
    const dvec3 diffuse = to_linear(material.colour) * (light + material.glow);
    sh[0] = (developed(diffuse) - 0.5) / sh_c0;
    if (material.gloss <= 0.0) return;
    // Specular reflections of the lights: normalised Phong lobes. Harmonics use the direction from the eye,
    // so the lobe's axis is opposite to the reflected ray.
    for (const SeenLight& l : lights) {
      // Schlick's Fresnel term for glass and varnish, limited because the lobe is broad.
      const double side = 1.0 - glm::dot(normal, l.direction);
      const double fresnel = std::min(0.3, 0.04 + 0.96 * side * side * side * side * side);
      const double lobe = material.gloss * fresnel * (material.sharpness + 1.0) / (2.0 * pi);
      const dvec3 rise = developed(diffuse + l.irradiance * lobe) - developed(diffuse);
      add_lobe(sh, glm::reflect(l.direction, normal), rise, material.sharpness);
    }
  }

  const SceneBuilder& stage_;
  const Lighting& light_;
  std::vector<dvec3> dome_;  // directions about +z
};

}  // namespace

Model bake(SceneBuilder& stage, const Lighting& light, int degree, const char* name) {
  stage.solids.build();
  stage.crowns.build();
  std::vector<std::size_t> begins;
  std::size_t count = stage.discs.size();
  for (const Surface& s : stage.surfaces) {
    begins.push_back(count);
    count += s.count;
  }
  Model model;
  model.name = name;
  model.degree = degree;
  model.resize(count);
  const Baker baker(stage, light);
  const auto values = static_cast<std::size_t>(sh_count(degree));
  const auto put = [&](std::size_t i, const Disc& disc) {
    const Harmonics sh = baker.seen(disc);
    const glm::dquat q = glm::normalize(glm::quat_cast(disc.axes));
    model.position[i] = disc.position;
    model.rotation[i] = {q.w, q.x, q.y, q.z};
    model.scale[i] = disc.scale;
    model.opacity[i] = static_cast<float>(disc.material.opacity);
    for (std::size_t k = 0; k < 3 * values; ++k)
      model.sh[3 * values * i + k] = static_cast<float>(sh[k / 3][static_cast<int>(k % 3)]);
  };
  parallel_for(
      stage.discs.size(), [&](std::size_t i) { put(i, stage.discs[i]); }, 64);
  Progress progress(std::string("building ") + name, begins.size());
  constexpr std::size_t parts = 64;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = begins.size() * part / parts, end = begins.size() * (part + 1) / parts;
    const auto fill = [&](std::size_t k) {
      std::size_t at = begins[begin + k];
      make_discs(stage.surfaces[begin + k], [&](const Disc& disc) { put(at++, disc); });
    };
    parallel_for(end - begin, fill, 8);
    progress.update(end);
  }
  return model;
}

}  // namespace binosplat::demo
