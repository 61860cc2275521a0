#include "measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "measure/comparable.h"
#include "measure/comparison.h"

namespace binosplat::measure {

namespace {

// The paper's constants, under its names.
constexpr double q_c = 0.7, p_c = 0.4, p_t = 0.95;  // colour: exponent, position and value of the knee
constexpr double w_degrees = 0.082;                 // features: width of the feature detector, degrees
constexpr double q_f = 0.5;                         // features: exponent

using Kernel = std::vector<double>;  // of odd length, for offsets from -n to n

/// One value per pixel, rows from the top.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<double> data;

  Plane(int w, int h) : width(w), height(h), data(static_cast<std::size_t>(w) * h) {}
  double& at(int x, int y) { return data[static_cast<std::size_t>(y) * width + x]; }
  double at(int x, int y) const { return data[static_cast<std::size_t>(y) * width + x]; }
};
using Planes = std::array<Plane, 3>;

template <typename Value>
void fill_plane(Plane& plane, const Value& value) {
  parallel_for(plane.height, [&](int y) {
    for (int x = 0; x < plane.width; ++x) plane.at(x, y) = value(x, y);
  });
}

/// Applies a separable kernel. Pixels beyond an edge have the value of the nearest pixel on the edge.
Plane filtered(const Plane& in, const Kernel& along_x, const Kernel& along_y) {
  Plane rows(in.width, in.height), out(in.width, in.height);
  const int rx = static_cast<int>(along_x.size() / 2), ry = static_cast<int>(along_y.size() / 2);
  fill_plane(rows, [&](int x, int y) {
    double sum = 0.0;
    int at = x - rx;
    for (const double weight : along_x) sum += weight * in.at(std::clamp(at++, 0, in.width - 1), y);
    return sum;
  });
  fill_plane(out, [&](int x, int y) {
    double sum = 0.0;
    int at = y - ry;
    for (const double weight : along_y) sum += weight * rows.at(x, std::clamp(at++, 0, in.height - 1));
    return sum;
  });
  return out;
}

// Colour spaces: linear sRGB, XYZ relative to sRGB's white, linearised CIELAB (YCxCz), CIELAB. The matrix has
// sRGB's primaries, and D65 (x 0.3127, y 0.3290) as white.
const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(0.41239080, 0.35758434, 0.18048079,  //
                                                        0.21263901, 0.71516868, 0.07219232,  //
                                                        0.01933082, 0.11919478, 0.95053215));

/// XYZ relative to white, so that white is (1, 1, 1).
glm::dvec3 relative_xyz(const glm::dvec3& rgb) { return (xyz_of_rgb * rgb) / (xyz_of_rgb * glm::dvec3(1.0)); }

glm::dvec3 ycxcz(const glm::dvec3& rgb) {
  const glm::dvec3 r = relative_xyz(rgb);
  return {116.0 * r.y - 16.0, 500.0 * (r.x - r.y), 200.0 * (r.y - r.z)};
}

glm::dvec3 rgb_of_ycxcz(const glm::dvec3& v) {
  const double y = (v.x + 16.0) / 116.0;
  const glm::dvec3 r(y + v.y / 500.0, y, y - v.z / 200.0);
  static const glm::dmat3 rgb_of_xyz = glm::inverse(xyz_of_rgb);
  return rgb_of_xyz * (r * (xyz_of_rgb * glm::dvec3(1.0)));
}

/// CIELAB with the Hunt effect, which reduces chroma in dark colours.
glm::dvec3 hunt_lab(const glm::dvec3& rgb) {
  constexpr double delta = 6.0 / 29.0;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
  };
  const glm::dvec3 r = relative_xyz(rgb);
  const double l = 116.0 * f(r.y) - 16.0;
  return {l, 0.01 * l * 500.0 * (f(r.x) - f(r.y)), 0.01 * l * 200.0 * (f(r.y) - f(r.z))};
}

/// HyAB, a colour distance for large differences: |difference of lightness| + Euclidean distance in chroma.
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Returns the kernel with the weights `value(i)` for i from -radius to radius.
template <typename Value>
Kernel kernel(int radius, const Value& value) {
  Kernel k;
  for (int i = -radius; i <= radius; ++i) k.push_back(value(i));
  return k;
}

double sum_of(const Kernel& k) { return std::accumulate(k.begin(), k.end(), 0.0); }

/// The contrast sensitivity of an opponent channel: the sum over its terms of a sqrt(pi / b) exp(-pi^2 x^2 /
/// b), x in degrees.
struct Sensitivity {
  struct Term {
    double a, b;
  };
  std::vector<Term> terms;
};
const std::array<Sensitivity, 3> sensitivities = {
    {{{{1.0, 0.0047}}}, {{{1.0, 0.0053}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};
constexpr double widest_b = 0.04;

/// Filters a channel with the eye's contrast sensitivity. The sum of the weights is 1.
Plane seen(const Plane& in, const Sensitivity& sensitivity, double ppd) {
  constexpr double pi = std::numbers::pi;
  const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(widest_b / (2.0 * pi * pi)) * ppd));
  Plane out(in.width, in.height);
  double total = 0.0;
  for (const Sensitivity::Term& term : sensitivity.terms) {
    const Kernel k = kernel(radius, [&](int i) { return std::exp(-pi * pi * i * i / (ppd * ppd * term.b)); });
    const double weight = term.a * std::sqrt(pi / term.b);
    total += weight * sum_of(k) * sum_of(k);
    const Plane part = filtered(in, k, k);
    for (std::size_t p = 0; p < out.data.size(); ++p) out.data[p] += weight * part.data[p];
  }
  for (double& v : out.data) v /= total;
  return out;
}

/// Scales positive weights so that their sum is 1, and negative weights so that their sum is -1.
void balance(Kernel& k) {
  double above = 0.0, below = 0.0;
  for (const double v : k) (v > 0.0 ? above : below) += std::abs(v);
  for (double& v : k) v /= v > 0.0 ? above : below;
}

/// The strength of edges (first derivatives of a Gaussian), and of points and lines (second derivatives).
struct Features {
  Plane edge;
  Plane point;
};

Features features(const Plane& luminance, double ppd) {
  const double sigma = 0.5 * w_degrees * ppd;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto gauss = [sigma](int i) { return std::exp(-i * i / (2.0 * sigma * sigma)); };
  Kernel smooth = kernel(radius, gauss);
  const double sum = sum_of(smooth);
  for (double& v : smooth) v /= sum;
  Kernel first = kernel(radius, [&](int i) { return -i * gauss(i); });
  Kernel second = kernel(radius, [&](int i) { return (i * i / (sigma * sigma) - 1.0) * gauss(i); });
  balance(first);
  balance(second);
  const auto strength = [&](const Kernel& across) {
    Plane x = filtered(luminance, across, smooth);
    const Plane y = filtered(luminance, smooth, across);
    for (std::size_t p = 0; p < x.data.size(); ++p) x.data[p] = std::hypot(x.data[p], y.data[p]);
    return x;
  };
  return {strength(first), strength(second)};
}

/// A picture after the eye's filters, as FLIP compares it.
struct SeenByEye {
  Planes lab;  // CIELAB with the Hunt effect, filtered by contrast sensitivity
  Features features;
};

SeenByEye see(const Image& image, double ppd) {
  const Plane empty(image.width, image.height);
  Planes planes = {empty, empty, empty};
  Plane luminance = empty;
  parallel_for(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      glm::dvec3 rgb;
      for (int c = 0; c < 3; ++c)
        rgb[c] =
            srgb_to_linear(std::clamp(double(image.at(x, y, std::min(c, image.channels - 1))), 0.0, 1.0));
      const glm::dvec3 v = ycxcz(rgb);
      for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].at(x, y) = v[c];
      luminance.at(x, y) = (v.x + 16.0) / 116.0;
    }
  });
  for (std::size_t c = 0; c < 3; ++c) planes[c] = seen(planes[c], sensitivities[c], ppd);
  parallel_for(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 v(planes[0].at(x, y), planes[1].at(x, y), planes[2].at(x, y));
      const glm::dvec3 lab = hunt_lab(glm::clamp(rgb_of_ycxcz(v), 0.0, 1.0));
      for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].at(x, y) = lab[c];
    }
  });
  return {std::move(planes), features(luminance, ppd)};
}

/// The colour difference from 0 to 1. Differences below p_c of the largest one use the range up to p_t.
double colour_difference(const glm::dvec3& a, const glm::dvec3& b) {
  static const double largest =
      std::pow(hyab(hunt_lab({0.0, 1.0, 0.0}), hunt_lab({0.0, 0.0, 1.0})), q_c);  // between green and blue
  const double difference = std::pow(hyab(a, b), q_c), usual = p_c * largest;
  if (difference < usual) return p_t / usual * difference;
  return p_t + (difference - usual) / (largest - usual) * (1.0 - p_t);
}

Image map_of_colours(const Image& a, const Image& b, double ppd) {
  const SeenByEye sa = see(a, ppd), sb = see(b, ppd);
  Image map(a.width, a.height, 1);
  parallel_for(a.height, [&](int y) {
    for (int x = 0; x < a.width; ++x) {
      const auto lab = [&](const Planes& p) {
        return glm::dvec3(p[0].at(x, y), p[1].at(x, y), p[2].at(x, y));
      };
      const double edge = std::abs(sa.features.edge.at(x, y) - sb.features.edge.at(x, y));
      const double point = std::abs(sa.features.point.at(x, y) - sb.features.point.at(x, y));
      const double feature = std::pow(std::max(edge, point) / std::numbers::sqrt2, q_f);
      const double colour = colour_difference(lab(sa.lab), lab(sb.lab));
      map.at(x, y, 0) = static_cast<float>(std::pow(colour, 1.0 - feature));
    }
  });
  return map;
}

}  // namespace

Image flip_map(const Image& a, const Image& b, double pixels_per_degree) {
  require_comparable(a, b);
  if (!(pixels_per_degree >= 1.0 && pixels_per_degree <= 1000.0))
    fail("{} pixels per degree: expected a number from 1 to 1000", pixels_per_degree);
  if (a.channels != 4) return map_of_colours(a, b, pixels_per_degree);
  const auto map_over = [&, shown_a = clamped(a), shown_b = clamped(b)](float grey) {
    const glm::vec3 background(grey);
    return map_of_colours(composite_over(background, shown_a), composite_over(background, shown_b),
                          pixels_per_degree);
  };
  Image map = map_over(0.0f);
  const Image white = map_over(1.0f);
  for (std::size_t k = 0; k < map.data.size(); ++k)
    map.data[k] = white.data[k] <= map.data[k] ? map.data[k] : white.data[k];
  return map;
}

double flip(const Image& a, const Image& b, double pixels_per_degree) {
  const Image map = flip_map(a, b, pixels_per_degree);
  return std::accumulate(map.data.begin(), map.data.end(), 0.0) / static_cast<double>(map.data.size());
}

}  // namespace binosplat::measure
