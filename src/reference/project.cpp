#include "reference/project.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>

#include "base/parallel.h"
#include "reference/decode.h"
#include "shared/limits.h"

namespace binosplat::reference {

namespace {

/// M = Rot(q) diag(scale). M M^T is the covariance in world axes.
glm::dmat3 scaled_axes(const Gaussian& gaussian) {
  const glm::dvec4& q = gaussian.rotation;
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const glm::dmat3 rotation(1 - 2 * (y * y + z * z), 2 * (x * y + w * z),
                            2 * (x * z - w * y),  // first column
                            2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),   // second
                            2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));  // third
  const glm::dvec3& s = gaussian.scale;
  return {rotation[0] * s.x, rotation[1] * s.y, rotation[2] * s.z};
}

struct PlaneCovariance {
  glm::dvec3 covariance;  // xx, xy, yy, with the low-pass
  double det, det_free;   // with the low-pass and without
};

/// Returns the covariance of scaled axes in a plane. Computes determinants as sums of squares: xx yy - xy^2
/// would cancel for a needle that is a million times as long as wide.
PlaneCovariance covariance_in_plane(const glm::dmat3x2& axes, double low_pass) {
  const glm::dvec3 a = glm::row(axes, 0), b = glm::row(axes, 1), n = glm::cross(a, b);
  const double aa = glm::dot(a, a), bb = glm::dot(b, b), free = glm::dot(n, n);
  return {{aa + low_pass, glm::dot(a, b), bb + low_pass}, free + low_pass * (aa + bb + low_pass), free};
}

/// The rotation from world axes to the eye's axes.
glm::dmat3 axes_of(const shared::View& view) {
  return glm::transpose(glm::dmat3(glm::dvec3(view.row_x), glm::dvec3(view.row_y), glm::dvec3(view.row_z)));
}

/// J: the derivative of the projected point at v. Slopes are clamped far outside the picture, as in 3D-GS.
/// This limits the size of splats that reach across the picture's edge.
glm::dmat3x2 perspective_jacobian(const glm::dvec3& v, const shared::View& view) {
  const glm::dvec4 lens = view.lens;
  const double fx = lens[0], fy = lens[1];
  const glm::dvec4 slopes = view.slopes;
  const double x = std::clamp(v.x / v.z, slopes[0], slopes[2]);
  const double y = std::clamp(v.y / v.z, slopes[1], slopes[3]);
  return glm::dmat3x2(fx / v.z, 0.0, 0.0, fy / v.z, -fx * x / v.z, -fy * y / v.z);  // by columns
}

/// Real spherical harmonics with Condon-Shortley signs, in the order of a model's coefficients.
std::array<double, 16> sh_basis(const glm::dvec3& d) {
  const double x = d.x, y = d.y, z = d.z;
  const double xx = x * x, yy = y * y, zz = z * z;
  return {0.28209479177387814,

          -0.4886025119029199 * y,
          0.4886025119029199 * z,
          -0.4886025119029199 * x,

          1.0925484305920792 * x * y,
          -1.0925484305920792 * y * z,
          0.31539156525252005 * (2 * zz - xx - yy),
          -1.0925484305920792 * x * z,
          0.5462742152960396 * (xx - yy),

          -0.5900435899266435 * y * (3 * xx - yy),
          2.890611442640554 * x * y * z,
          -0.4570457994644658 * y * (4 * zz - xx - yy),
          0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
          -0.4570457994644658 * x * (4 * zz - xx - yy),
          1.445305721320277 * z * (xx - yy),
          -0.5900435899266435 * x * (xx - 3 * yy)};
}

}  // namespace

glm::dvec3 colour_towards(const Model& model, std::size_t i, const glm::dvec3& direction) {
  const std::array<double, 16> basis = sh_basis(direction);
  const std::size_t count = static_cast<std::size_t>(sh_count(model.degree));
  const float* sh = &model.sh[i * count * 3];
  glm::dvec3 colour(0.5);
  for (std::size_t k = 0; k < count; ++k)
    colour += basis[k] * glm::dvec3(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]);
  return glm::max(colour, 0.0);
}

namespace {

/// The pixel coordinates of the point at which the line through the eye and v meets the picture's plane.
glm::dvec2 picture_point(const glm::dvec3& v, const shared::View& view) {
  return {view.lens[0] * v.x / v.z + view.lens[2] - 0.5, view.lens[1] * v.y / v.z + view.lens[3] - 0.5};
}

/// The affine projection: J transforms the Gaussian at v to the picture.
void project_affine(const Gaussian& gaussian, const shared::View& view, const glm::dvec3& v,
                    const LowPass& low_pass, Splat& splat) {
  const PlaneCovariance seen = covariance_in_plane(
      perspective_jacobian(v, view) * axes_of(view) * scaled_axes(gaussian), low_pass.kernel_px2);
  splat.covariance = seen.covariance;
  splat.det = seen.det;
  splat.drawn = splat.det > 0.0;
  splat.mean = picture_point(v, view);
  splat.depth = v.z;
  splat.conic = glm::dvec3(splat.covariance.z, -splat.covariance.y, splat.covariance.x) / splat.det;
  if (low_pass.antialiased) splat.opacity *= std::sqrt(seen.det_free / seen.det);
}

/// Transforms (x, y, 1) of a pixel to its ray, whose z is 1.
glm::dmat3 rays_of(const shared::View& view) {
  const glm::dvec4 lens = view.lens;
  return {1 / lens[0], 0, 0, 0, 1 / lens[1], 0, (0.5 - lens[2]) / lens[0], (0.5 - lens[3]) / lens[1], 1};
}

/// Sets the plane of a flat Gaussian, unless it is seen edge-on or is behind the eye.
void set_plane(const Gaussian& gaussian, const shared::View& view, const glm::dvec3& v, Splat& splat) {
  const glm::dmat3 turn = axes_of(view);
  const glm::dvec3 normal = turn * scaled_axes({.scale = glm::dvec3(1.0), .rotation = gaussian.rotation})[2];
  const double facing = glm::dot(normal, v);
  if (v.z <= 0.0 || std::abs(facing) < EDGE_ON * v.z) return;
  splat.plane = glm::transpose(rays_of(view)) * normal / facing;
  splat.reach = 3.0 * glm::length(glm::row(turn * scaled_axes(gaussian), 2));
}

/// Two unit vectors that form a right-handed orthonormal basis with the unit vector n.
std::array<glm::dvec3, 2> across(const glm::dvec3& n) {
  const glm::dvec3 least = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(least, n));
  return {first, glm::cross(n, first)};
}

/// The tangent projection: drops each unit ray d at a right angle onto the plane that touches the unit sphere
/// in the Gaussian's direction. q is a function of the point in this plane.
void project_tangent(const Gaussian& gaussian, const shared::View& view, const glm::dvec3& v,
                     const LowPass& low_pass, Splat& splat) {
  const glm::dvec4 lens = view.lens;
  const double focal2 = lens[0] * lens[1], distance = glm::length(v);
  const glm::dvec3 n = v / distance;
  const auto [e1, e2] = across(n);
  const glm::dmat3x2 onto = glm::transpose(glm::dmat2x3(e1, e2));
  const PlaneCovariance seen = covariance_in_plane(onto * axes_of(view) * scaled_axes(gaussian) / distance,
                                                   low_pass.kernel_px2 / focal2);
  splat.drawn = seen.det > 0.0;
  splat.depth = distance;
  splat.mean = picture_point(v, view);
  if (low_pass.antialiased) splat.opacity *= std::sqrt(seen.det_free / seen.det);
  const glm::dvec3& c = seen.covariance;
  const double most = 0.5 * (c.x + c.z) + std::hypot(0.5 * (c.x - c.z), c.y);
  const double more = std::max(0.0, 1.0 / (WIDEST_TANGENT * WIDEST_TANGENT) - 1.0 / most);
  const glm::dmat2 q(c.z / seen.det + more, -c.y / seen.det, -c.y / seen.det, c.x / seen.det + more);
  const double det_q = 1.0 / seen.det + more * ((c.x + c.z) / seen.det + more);

  splat.det = focal2 * focal2 / det_q;

  const glm::dmat3 to_ray = rays_of(view);
  const glm::dmat3x2 rays = onto * to_ray;
  splat.cone = Cone{glm::transpose(rays) * q * rays, glm::transpose(to_ray) * to_ray, n.z < 0.0,
                    glm::transpose(to_ray) * n};
}

}  // namespace

Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass,
              const Perspective& perspective) {
  const glm::dvec3 p = gaussian.position - glm::dvec3(view.anchor);
  const glm::dvec3 translation(view.row_x.w, view.row_y.w, view.row_z.w);
  const glm::dvec3 v = axes_of(view) * p + translation;
  const bool by_distance = perspective.order == Order::distance;
  const bool is_tangent = perspective.projection == Projection::tangent;
  Splat splat;
  if ((by_distance && is_tangent ? glm::length(v) : v.z) <= view.anchor.w) return splat;
  splat.opacity = gaussian.opacity;
  splat.order = by_distance ? glm::length(p - glm::dvec3(view.centre)) : v.z;
  (is_tangent ? project_tangent : project_affine)(gaussian, view, v, low_pass, splat);
  if (gaussian.is_flat) set_plane(gaussian, view, v, splat);
  return splat;
}

Splat project(const Model& model, std::size_t i, const shared::View& view,
              const std::optional<Perspective>& perspective) {
  const Gaussian gaussian{model.position[i], model.scale[i], model.rotation[i], model.opacity[i],
                          model.flat && model.scale[i].z == 0.0f};
  Splat splat =
      project(gaussian, view, {model.kernel_px2, model.antialiased}, perspective.value_or(model.perspective));
  if (!splat.drawn) return splat;
  const glm::dvec3 p = gaussian.position - glm::dvec3(view.anchor);
  splat.colour = colour_towards(model, i, glm::normalize(p - glm::dvec3(view.eye)));
  return splat;
}

std::vector<Splat> project_all(const Model& model, const shared::View& view) {
  return project_all(model, view, true, model.perspective);
}

}  // namespace binosplat::reference
