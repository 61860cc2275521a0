#include "demo/room_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scene/harmonics.h"

namespace binosplat::demo::room {

namespace {

constexpr int bake_degree = 3;
constexpr int coefficients = sh_count(bake_degree);

/// Within this distance a surface dims what it faces.
constexpr double occlusion_reach = 0.7;
/// Rays start this far off their surface: it must not shade itself.
constexpr double disc_lift = 4e-3;

double to_linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double to_display(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

/// Linear light to a display value, with the shoulder of a film (Narkowicz's fit of ACES).
dvec3 developed_filmic(const dvec3& light) {
  dvec3 out;
  for (int i = 0; i < 3; ++i) {
    const double x = std::max(0.0, light[i]);
    out[i] = to_display(std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)));
  }
  return out;
}

/// The share of band l in the lobe max(0, cos)^sharpness about an axis: coefficient (l, m) of the lobe is
/// band(l) times the basis function at the axis (Funk-Hecke). The integrals 2 pi int_0^1 t^s P_l(t) dt have
/// closed forms.
std::array<double, bake_degree + 1> lobe_bands(double s) {
  const double i0 = 1.0 / (s + 1.0), i1 = 1.0 / (s + 2.0), i2 = 1.0 / (s + 3.0), i3 = 1.0 / (s + 4.0);
  return {2.0 * pi * i0, 2.0 * pi * i1, pi * (3.0 * i2 - i0), pi * (5.0 * i3 - 3.0 * i1)};
}

/// Distance along a ray to a solid within (0, reach), or infinity. The ray's direction need not be of unit
/// length.
double hit(const Solid& solid, const dvec3& from, const dvec3& to, double reach) {
  const dvec3 p = solid.to_unit * from + solid.unit_origin;
  const dvec3 d = solid.to_unit * to;
  double enter = 0.0, leave = reach;
  const auto slab = [&](int i) {
    const double a = (-1.0 - p[i]) / d[i], b = (1.0 - p[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  };
  const auto round = [&](double dd, double pd, double pp) {
    const double root = pd * pd - dd * (pp - 1.0);
    if (root <= 0.0) {
      leave = -1.0;
      return;
    }
    enter = std::max(enter, (-pd - std::sqrt(root)) / dd);
    leave = std::min(leave, (-pd + std::sqrt(root)) / dd);
  };
  switch (solid.shape) {
    case Solid::Shape::box:
      for (int i = 0; i < 3; ++i) slab(i);
      break;
    case Solid::Shape::ellipsoid:
      round(glm::dot(d, d), glm::dot(p, d), glm::dot(p, p));
      break;
    case Solid::Shape::cylinder:
      slab(1);
      round(d.x * d.x + d.z * d.z, p.x * d.x + p.z * d.z, p.x * p.x + p.z * p.z);
      break;
  }
  return enter < leave ? enter : std::numeric_limits<double>::infinity();
}

/// Whether a ray, up to `reach` times its direction, comes as near to a ball's centre as its radius.
bool meets(const dvec3& centre, double radius, const dvec3& from, const dvec3& direction, double reach) {
  const dvec3 to_centre = centre - from;
  const double nearest =
      std::clamp(glm::dot(to_centre, direction) / glm::dot(direction, direction), 0.0, reach);
  const dvec3 gap = to_centre - nearest * direction;
  return glm::dot(gap, gap) < radius * radius;
}

/// What reaches one side of a surface, and which lights it sees.
struct Received {
  dvec3 irradiance{0.0};
  unsigned opening = 0;  // a bit for every point of the opening
  double sun = 0.0;      // share of the sun's disc
  bool lamp = false;
};

class Baker {
 public:
  Baker(const Stage& stage, const Lighting& light) : stage_(stage), light_(light) {
    const double golden = pi * (3.0 - std::sqrt(5.0));
    constexpr int rays = 16;
    for (int i = 0; i < rays; ++i) {  // more of them near the normal, as a diffuse surface weighs them
      const double r = std::sqrt((i + 0.5) / rays);
      dome_.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), std::sqrt(1.0 - r * r));
    }
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) {
        const dvec2 share((i + 0.5) / 4.0, (j + 0.5) / 3.0);
        const dvec2 at = light.opening_low + (light.opening_high - light.opening_low) * share;
        opening_.emplace_back(at.x, at.y, light.room_high.z);
      }
    }
  }

  void add(const Disc& disc, Model& model) const;

 private:
  bool inside_room(const dvec3& p) const {
    constexpr double slack = 0.15;  // discs on the window's frame and sill
    return glm::all(glm::greaterThan(p, light_.room_low - slack)) &&
           glm::all(glm::lessThan(p, light_.room_high + slack));
  }
  bool free(const dvec3& from, const dvec3& direction, double reach) const;
  double ambient_share(const dvec3& p, const dmat3& axes) const;
  double sun_share(const dvec3& p) const;
  Received received(const dvec3& p, const dmat3& axes) const;
  void add_lobe(const Disc& disc, const dvec3& to_light, const dvec3& light, const dvec3& diffuse,
                std::array<dvec3, coefficients>& sh) const;
  std::array<dvec3, coefficients> seen(const Disc& disc) const;

  const Stage& stage_;
  const Lighting& light_;
  std::vector<dvec3> dome_;     // directions about +z
  std::vector<dvec3> opening_;  // points of the opening
};

/// Whether nothing lies on a ray within `reach` times its direction.
bool Baker::free(const dvec3& from, const dvec3& direction, double reach) const {
  for (const SolidGroup& group : stage_.solids) {
    if (!meets(group.centre, group.radius, from, direction, reach)) continue;
    for (const Solid& solid : group.solids) {
      if (meets(solid.centre, solid.radius, from, direction, reach) &&
          hit(solid, from, direction, reach) < reach)
        return false;
    }
  }
  return true;
}

double Baker::ambient_share(const dvec3& p, const dmat3& axes) const {
  std::vector<const Solid*> nearby;
  for (const SolidGroup& group : stage_.solids) {
    if (glm::length(group.centre - p) > group.radius + occlusion_reach) continue;
    for (const Solid& solid : group.solids) {
      if (glm::length(solid.centre - p) < solid.radius + occlusion_reach) nearby.push_back(&solid);
    }
  }
  double sum = 0.0;
  for (const dvec3& ray : dome_) {
    const dvec3 direction = axes * ray;
    double way = occlusion_reach;
    for (const Solid* solid : nearby) {
      if (meets(solid->centre, solid->radius, p, direction, way))
        way = std::min(way, hit(*solid, p, direction, way));
    }
    for (int i = 0; i < 3; ++i) {  // the room's own walls
      const double wall = direction[i] > 0.0 ? light_.room_high[i] : light_.room_low[i];
      if (direction[i] != 0.0) way = std::min(way, std::max(0.0, (wall - p[i]) / direction[i]));
    }
    sum += std::sqrt(way / occlusion_reach);
  }
  return sum / static_cast<double>(dome_.size());
}

double Baker::sun_share(const dvec3& p) const {
  const dvec3 across = glm::normalize(glm::cross(light_.to_sun, dvec3(0, 1, 0)));
  const dvec3 upwards = glm::cross(across, light_.to_sun);
  int lit = 0;
  for (int k = 0; k < 5;
       ++k) {  // the middle and four points of a disc somewhat larger than the sun: soft edges
    const double a = k == 1 ? -0.008 : k == 2 ? 0.008 : 0.0, b = k == 3 ? -0.008 : k == 4 ? 0.008 : 0.0;
    const dvec3 direction = light_.to_sun + a * across + b * upwards;
    const double way = std::max(0.0, (light_.room_high.z - p.z) / direction.z);
    const dvec3 out = p + way * direction;
    const bool through = out.x > light_.opening_low.x && out.x < light_.opening_high.x &&
                         out.y > light_.opening_low.y && out.y < light_.opening_high.y;
    lit += through && free(p, direction, way + 0.3);  // 0.3: as far as the bars of the window
  }
  return lit / 5.0;
}

Received Baker::received(const dvec3& p, const dmat3& axes) const {
  const dvec3 normal = axes[2];
  Received out;
  out.irradiance = light_.ambient * ambient_share(p, axes);

  const double facing_sun = glm::dot(normal, light_.to_sun);
  if (facing_sun > 0.0) out.sun = sun_share(p);
  out.irradiance += light_.sun * (facing_sun * out.sun);

  const dvec2 size = light_.opening_high - light_.opening_low;
  for (std::size_t i = 0; i < opening_.size(); ++i) {
    const dvec3 way = opening_[i] - p;
    const double square = std::max(0.04, glm::dot(way, way));
    const double weight = glm::dot(normal, way) * way.z / (square * square * pi);
    if (weight < 1e-5 || !free(p, way, 0.97)) continue;
    out.opening |= 1u << i;
    out.irradiance += light_.sky * (weight * size.x * size.y / static_cast<double>(opening_.size()));
  }

  const dvec3 way = light_.lamp_position - p;
  const double square = std::max(0.01, glm::dot(way, way));
  const double weight = glm::dot(normal, way) / (std::sqrt(square) * square);
  out.lamp = weight > 1e-4 && free(p, way, 1.0);
  if (out.lamp) out.irradiance += light_.lamp * weight;

  const dvec3 down = light_.bounce_middle - p;
  const double far = 0.3 + glm::dot(down, down);
  out.irradiance +=
      light_.bounce * (std::max(0.0, 0.3 + 0.7 * glm::dot(normal, down) / std::sqrt(far)) / far);
  return out;
}

/// Adds a light's mirror image: a normalised Phong lobe about the mirrored direction, as far as it brightens
/// what is seen. `light` is the irradiance on a surface that faces it. Models take the direction from the eye
/// to the Gaussian, which is the lobe's axis with its sign turned.
void Baker::add_lobe(const Disc& disc, const dvec3& to_light, const dvec3& light, const dvec3& diffuse,
                     std::array<dvec3, coefficients>& sh) const {
  const double facing = glm::dot(disc.axes[2], to_light);
  if (facing <= 0.0) return;
  // Schlick's Fresnel term for glass and varnish: more at grazing angles, as far as a broad lobe can bear it.
  const double away = 1.0 - facing, fresnel = std::min(0.3, 0.04 + 0.96 * away * away * away * away * away);
  const dvec3 mirrored =
      light * (disc.material.gloss * fresnel * (disc.material.sharpness + 1.0) / (2.0 * pi));
  const dvec3 rise = developed_filmic(diffuse + mirrored) - developed_filmic(diffuse);
  const dvec3 from_eye = to_light - 2.0 * facing * disc.axes[2];
  const auto bands = lobe_bands(disc.material.sharpness);
  const auto at_axis = sh_basis(from_eye);
  for (int l = 0; l <= bake_degree; ++l) {
    for (int k = l * l; k < (l + 1) * (l + 1); ++k) {
      sh[static_cast<std::size_t>(k)] +=
          rise * (bands[static_cast<std::size_t>(l)] * at_axis[static_cast<std::size_t>(k)]);
    }
  }
}

std::array<dvec3, coefficients> Baker::seen(const Disc& disc) const {
  const Material& material = disc.material;
  std::array<dvec3, coefficients> sh{};
  if (!material.lit || !inside_room(disc.position)) {
    sh[0] = (material.colour - 0.5) / sh_c0;
    return sh;
  }
  const dvec3 albedo(to_linear(material.colour.r), to_linear(material.colour.g),
                     to_linear(material.colour.b));
  const dvec3 p = disc.position + disc_lift * disc.axes[2];
  const Received front = received(p, disc.axes);
  dvec3 light = front.irradiance;
  if (material.two_sided) {
    const dmat3 turned_over(disc.axes[0], -disc.axes[1], -disc.axes[2]);
    light = 0.6 * light + 0.4 * received(disc.position - disc_lift * disc.axes[2], turned_over).irradiance;
  }
  const dvec3 diffuse = albedo * (light + material.glow);
  sh[0] = (developed_filmic(diffuse) - 0.5) / sh_c0;
  if (material.gloss > 0.0) {
    const dvec2 size =
        (light_.opening_high - light_.opening_low) / std::sqrt(static_cast<double>(opening_.size()));
    for (std::size_t i = 0; i < opening_.size(); ++i) {
      if ((front.opening >> i & 1u) == 0) continue;
      const dvec3 way = opening_[i] - p;
      const double far = std::max(0.3, glm::length(way));
      add_lobe(disc, way / far, light_.sky * (size.x * size.y * way.z / (far * far * far * pi)), diffuse, sh);
    }
    const dvec3 way = light_.lamp_position - p;
    const double far = std::max(0.1, glm::length(way));
    if (front.lamp) add_lobe(disc, way / far, light_.lamp / (far * far), diffuse, sh);
    if (front.sun > 0.0) add_lobe(disc, light_.to_sun, light_.sun * front.sun, diffuse, sh);
  }
  return sh;
}

void Baker::add(const Disc& disc, Model& model) const {
  const auto sh = seen(disc);
  model.position.emplace_back(disc.position);
  model.scale.emplace_back(disc.scale);
  model.rotation.push_back(quaternion(disc.axes));
  model.opacity.push_back(static_cast<float>(disc.material.opacity));
  for (const dvec3& value : sh) {
    for (int i = 0; i < 3; ++i) model.sh.push_back(static_cast<float>(value[i]));
  }
}

}  // namespace

Model bake(const Stage& stage, const Lighting& light) {
  Model model;
  model.degree = bake_degree;
  model.reserve(stage.discs.size());
  const Baker baker(stage, light);
  for (const Disc& disc : stage.discs) baker.add(disc, model);
  return model;
}

}  // namespace binosplat::demo::room
