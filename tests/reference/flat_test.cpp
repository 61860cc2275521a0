// Compares flat 3D Gaussians with 2D Gaussian Splatting (Huang et al. 2024). The rasteriser of its trainer is
// written here in float64, from the paper and the public code, and is compared with the reference.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numeric>

#include "base/choices.h"
#include "measure/metrics.h"
#include "reference/splats.h"
#include "support/scenes.h"

namespace binosplat::reference {
namespace {

/// A flat Gaussian: its two axes and its mean, in the eye's space and in homogeneous pixels, whose centres
/// are at k + 0.5 here.
struct Surfel {
  glm::dvec3 a, b, middle;
  glm::dmat3 pixels;       // rows x w, y w and w; columns a, b and mean
  glm::dvec2 screen{0.0};  // centre of its low-pass: the middle of the box around three standard deviations
  double opacity = 0.0;
  glm::dvec3 colour{0.0};
};

Surfel surfel_of(const Model& model, std::size_t i, const Camera& camera) {
  const glm::vec4& q = model.rotation[i];
  const glm::dmat3 axes = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
  Surfel s{axes[0] * static_cast<double>(model.scale[i].x), axes[1] * static_cast<double>(model.scale[i].y),
           glm::dvec3(model.position[i]), glm::dmat3(0.0)};
  const glm::dvec3* columns[] = {&s.a, &s.b, &s.middle};
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3& v = *columns[c];
    s.pixels[c] = {camera.fx * v.x + camera.cx * v.z, camera.fy * v.y + camera.cy * v.z, v.z};
  }
  const glm::dmat3 rows = glm::transpose(s.pixels);
  const glm::dvec3 cutoff(9.0, 9.0, -1.0);
  const glm::dvec3 f = cutoff / glm::dot(cutoff, rows[2] * rows[2]);
  s.screen = {glm::dot(f, rows[0] * rows[2]), glm::dot(f, rows[1] * rows[2])};
  s.opacity = model.opacity[i];
  s.colour = glm::max(colour_towards(model, i, glm::normalize(s.middle)), 0.0);
  return s;
}

double alpha_at(const Surfel& s, const glm::dvec2& pixel) {
  // The planes through the eye and the pixel's column or row intersect the splat's plane. Solve in its
  // coordinates.
  const glm::dmat3 rows = glm::transpose(s.pixels);
  const glm::dvec3 p = glm::cross(pixel.x * rows[2] - rows[0], pixel.y * rows[2] - rows[1]);
  if (p.z == 0.0) return 0.0;
  const double u = p.x / p.z, v = p.y / p.z;
  const glm::dvec2 apart = s.screen - pixel;
  const double of_splat = u * u + v * v, of_screen = 2.0 * glm::dot(apart, apart);  // sqrt(1/2) px
  return std::min(0.99, s.opacity * std::exp(-0.5 * std::min(of_splat, of_screen)));
}

/// Returns the picture of the trainer's rasteriser, from a camera at the origin that looks along z.
Picture traced(const Model& model, const Camera& camera) {
  std::vector<std::size_t> order(model.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return model.position[i].z; });
  std::vector<Surfel> surfels;
  for (const std::size_t i : order) surfels.push_back(surfel_of(model, i, camera));
  Picture picture(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec3 colour(0.0);
      double left = 1.0;
      for (const Surfel& s : surfels) {
        const double alpha = alpha_at(s, {x + 0.5, y + 0.5});
        if (alpha < 1.0 / 255.0) continue;
        if (left * (1.0 - alpha) < 1e-4) break;
        colour += left * alpha * s.colour;
        left *= 1.0 - alpha;
      }
      picture.colour[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                     static_cast<std::size_t>(x)] = glm::vec4(glm::dvec4(colour, left));
    }
  }
  return picture;
}

Picture drawn(const Model& model, const Camera& camera, Projection projection) {
  Settings settings;
  settings.perspective = Perspective{.projection = projection};
  return render(model, make_view(camera), settings);
}

/// Returns the PSNR over the pixels in which either picture shows anything.
double psnr_of_shown(const Picture& a, const Picture& b) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.colour.size(); ++k) {
    if (a.colour[k].a == 1.0f && b.colour[k].a == 1.0f) continue;
    const glm::dvec3 d =
        glm::clamp(glm::dvec3(a.colour[k]), 0.0, 1.0) - glm::clamp(glm::dvec3(b.colour[k]), 0.0, 1.0);
    sum += glm::dot(d, d) / 3.0;
    ++count;
  }
  return -10.0 * std::log10(sum / static_cast<double>(count));
}

Camera camera() { return test::front_camera(96, 72, 96); }

/// Returns one white splat: `off` px from the middle, `sigma` px wide, tilted by `tilt` degrees.
Model one(double sigma, double tilt, double off) {
  Model model;
  const double half = glm::radians(0.5 * tilt);
  const auto size = static_cast<float>(sigma / 96.0 * 2.0);
  test::add(model, {static_cast<float>(off / 96.0 * 2.0), 0.01f, 2.0f}, {size, size, 0.0f}, 0.9f,
            glm::vec3(1.0f),
            {static_cast<float>(std::cos(half)), 0.0f, static_cast<float>(std::sin(half)), 0.0f});
  return model;
}

/// Returns a ball of `count` overlapping splats, `sigma` px wide each, like a trained surface.
Model ball(int count, double sigma) {
  test::Uniform uniform(1);
  Model model;
  const auto size = static_cast<float>(sigma / 96.0 * 3.0);
  for (int i = 0; i < count; ++i) {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(angle), r * std::sin(angle), z);
    const glm::dquat turn = glm::normalize(glm::dquat(1.0 + n.z, -n.y, n.x, 0.0));
    const auto colour = [&] { return static_cast<float>(uniform(0, 1)); };
    const glm::vec3 rgb(colour(), colour(), colour());
    test::add(model, glm::vec3(n + glm::dvec3(0, 0, 3)), {size, 0.5f * size, 0.0f},
              static_cast<float>(uniform(0.3, 1)), rgb, glm::vec4(turn.w, turn.x, turn.y, turn.z));
  }
  return model;
}

/// Returns the PSNR with the affine and the tangent projection.
std::pair<double, double> apart(const Model& model, const Model& truth) {
  const Picture picture = traced(truth, camera());
  return {psnr_of_shown(picture, drawn(model, camera(), Projection::affine)),
          psnr_of_shown(picture, drawn(model, camera(), Projection::tangent))};
}

TEST(FlatSplats, MatchRasteriserFacingEye) {
  Model model = one(12, 0, 30);
  model.kernel_px2 = 0.0;
  EXPECT_GT(apart(model, model).first, 150.0);
  // Injected faults: a shift by two thirds of a pixel, and a slightly smaller size.
  Model beside = model, smaller = model;
  beside.position[0].x += 0.014f;
  smaller.scale[0].y *= 0.95f;
  EXPECT_LT(apart(beside, model).first, 45.0);
  EXPECT_LT(apart(smaller, model).first, 50.0);
}

// The numbers are in docs/measuring.md.
TEST(FlatSplats, OneSplatMatchesDocumentedPsnr) {
  struct Row {
    double tilt;
    std::pair<double, double> of_12, of_3, of_1, of_third;  // px: affine, tangent
  };
  const Row rows[] = {{0, {67.2, 39.4}, {44.0, 43.3}, {26.4, 26.4}, {26.7, 26.7}},
                      {45, {28.2, 28.3}, {37.2, 37.0}, {24.2, 24.2}, {25.1, 25.1}},
                      {70, {26.1, 26.2}, {29.9, 29.9}, {20.7, 20.7}, {23.8, 23.8}},
                      {85, {24.8, 24.8}, {15.5, 15.5}, {21.3, 21.3}, {23.4, 23.4}}};
  for (const Row& row : rows) {
    for (const auto& [sigma, said] : {std::pair(12.0, row.of_12), std::pair(3.0, row.of_3),
                                      std::pair(1.0, row.of_1), std::pair(0.3, row.of_third)}) {
      const Model model = one(sigma, row.tilt, 0.0);
      const auto [affine, tangent] = apart(model, model);
      EXPECT_NEAR(affine, said.first, 0.1) << row.tilt << " " << sigma;
      EXPECT_NEAR(tangent, said.second, 0.1) << row.tilt << " " << sigma;
    }
  }
  // Injected fault: a splat that is as thick as it is wide.
  Model thick = one(12, 70, 0.0);
  thick.scale[0].z = thick.scale[0].x;
  EXPECT_LT(apart(thick, one(12, 70, 0.0)).first, 20.0);
}

TEST(FlatSplats, SurfaceMatchesDocumentedPsnr) {
  struct Row {
    int count;
    double sigma;
    std::pair<double, double> usual, narrow;  // low-pass of 0.3 and 0.1 px^2: affine, tangent
  };
  for (const Row& row : {Row{300, 4, {26.7, 25.5}, {31.1, 30.2}}, Row{1000, 2, {23.9, 22.9}, {27.5, 27.6}},
                         Row{3000, 1, {25.3, 24.8}, {21.5, 22.6}}}) {
    if (row.count > 1000 && !test::switched_on("BINOSPLAT_LONG")) continue;
    const Model model = ball(row.count, row.sigma);
    Model narrow = model;
    narrow.kernel_px2 = 0.1;
    for (const auto& [of, said] : {std::pair(model, row.usual), std::pair(narrow, row.narrow)}) {
      const auto [affine, tangent] = apart(of, model);
      EXPECT_NEAR(affine, said.first, 0.1) << row.count << " " << of.kernel_px2;
      EXPECT_NEAR(tangent, said.second, 0.1) << row.count << " " << of.kernel_px2;
    }
  }
}

// The rasteriser's depth of a splat is that of the point (u, v) of its plane.
TEST(FlatSplats, DepthsLieOnPlane) {
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    for (const double tilt : {0.0, 45.0, 70.0, 85.0}) {
      Model model = one(12, tilt, 5);
      const Surfel surfel = surfel_of(model, 0, camera());
      const glm::dvec3 normal = glm::cross(surfel.a, surfel.b);
      const double reach = 3.0 * std::hypot(surfel.a.z, surfel.b.z);
      const auto farthest_off = [&] {
        const Image depths = depth_map(drawn(model, camera(), projection));
        double off = 0.0;
        std::size_t seen = 0;
        for (int y = 0; y < camera().height; ++y) {
          for (int x = 0; x < camera().width; ++x) {
            const glm::dvec3 ray((x + 0.5 - camera().cx) / camera().fx, (y + 0.5 - camera().cy) / camera().fy,
                                 1.0);
            const double z = glm::dot(normal, surfel.middle) / glm::dot(normal, ray);
            if (std::isinf(depths.at(x, y, 0)) || z < 0.0 || std::abs(z - surfel.middle.z) > reach + 1e-9)
              continue;
            off = std::max(off, std::abs(depths.at(x, y, 0) - z));
            ++seen;
          }
        }
        EXPECT_GT(seen, tilt == 0.0 ? 0u : 40u);
        return off;
      };
      model.flat = true;
      EXPECT_LT(farthest_off(), 1e-6) << name_of(projection) << " " << tilt;
      model.flat = false;
      if (tilt == 0.0) continue;
      EXPECT_GT(farthest_off(), 0.05) << "the depth of the mean goes unnoticed";
    }
  }
}

}  // namespace
}  // namespace binosplat::reference
