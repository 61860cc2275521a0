#include "reference/project.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "reference/decode.h"
#include "shared/limits.h"

namespace binosplat::reference {

namespace {

/// M M^T, M = Rot(q) diag(scale): the covariance in world axes.
glm::dmat3 covariance_in_world(const Gaussian& gaussian) {
  const glm::dvec4& q = gaussian.rotation;
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const glm::dmat3 rotation(1 - 2 * (y * y + z * z), 2 * (x * y + w * z),
                            2 * (x * z - w * y),  // first column
                            2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),   // second
                            2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));  // third
  const glm::dvec3& s = gaussian.scale;
  const glm::dmat3 m(rotation[0] * s.x, rotation[1] * s.y, rotation[2] * s.z);
  return m * glm::transpose(m);
}

/// J: how a small step around v moves the projected point. Far outside the picture the perspective is
/// followed only up to the clamp, which keeps what straddles the picture's edge from growing without bound
/// (3D-GS does the same).
glm::dmat3x2 perspective_jacobian(const glm::dvec3& v, const shared::View& view) {
  const glm::dvec4 lens = view.lens;
  const double fx = lens[0], fy = lens[1];
  const glm::dvec4 slopes = view.slopes;
  const double x = std::clamp(v.x / v.z, slopes[0], slopes[2]);
  const double y = std::clamp(v.y / v.z, slopes[1], slopes[3]);
  return glm::dmat3x2(fx / v.z, 0.0, 0.0, fy / v.z, -fx * x / v.z, -fy * y / v.z);  // by columns
}

/// Real spherical harmonics with Condon-Shortley signs, in the order in which models store their
/// coefficients.
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

Splat project(const Gaussian& gaussian, const shared::View& view, const LowPass& low_pass) {
  const glm::dvec4 row_x = view.row_x, row_y = view.row_y, row_z = view.row_z, lens = view.lens;
  const glm::dvec3 p = gaussian.position - glm::dvec3(view.anchor);
  const glm::dvec3 v(glm::dot(glm::dvec3(row_x), p) + row_x.w, glm::dot(glm::dvec3(row_y), p) + row_y.w,
                     glm::dot(glm::dvec3(row_z), p) + row_z.w);
  Splat splat;
  if (v.z <= view.anchor.w) return splat;

  const glm::dmat3 to_eye =
      glm::transpose(glm::dmat3(glm::dvec3(row_x), glm::dvec3(row_y), glm::dvec3(row_z)));
  const glm::dmat3x2 projection = perspective_jacobian(v, view) * to_eye;
  const glm::dmat2 c2 = projection * covariance_in_world(gaussian) * glm::transpose(projection);
  const double kernel = low_pass.kernel_px2;
  const glm::dvec3 covariance(c2[0][0] + kernel, c2[0][1], c2[1][1] + kernel);
  const double det = covariance.x * covariance.z - covariance.y * covariance.y;
  if (!(det > 0.0)) return splat;

  splat.mean = glm::dvec2(lens[0] * v.x / v.z + lens[2] - 0.5, lens[1] * v.y / v.z + lens[3] - 0.5);
  splat.depth = v.z;
  splat.opacity = gaussian.opacity;
  if (low_pass.antialiased) splat.opacity *= std::sqrt(std::max(0.0, glm::determinant(c2)) / det);
  splat.covariance = covariance;
  splat.conic = glm::dvec3(covariance.z, -covariance.y, covariance.x) / det;
  splat.det = det;
  splat.drawn = true;
  return splat;
}

Splat project(const Model& model, std::size_t i, const shared::View& view) {
  const Gaussian gaussian{model.position[i], model.scale[i], model.rotation[i], model.opacity[i]};
  Splat splat = project(gaussian, view, {model.kernel_px2, model.antialiased});
  if (!splat.drawn) return splat;
  const glm::dvec3 p = gaussian.position - glm::dvec3(view.anchor);
  splat.colour = colour_towards(model, i, glm::normalize(p - glm::dvec3(view.eye)));
  return splat;
}

std::vector<Splat> project_all(const Model& model, const shared::View& view) {
  if (model.scaffold) return project_all(model, view, Decoding{});
  std::vector<Splat> splats(model.count());
  parallel_for(splats.size(), [&](std::size_t i) { splats[i] = project(model, i, view); });
  return splats;
}

}  // namespace binosplat::reference
