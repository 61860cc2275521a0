#pragma once
// Writes models, reads them back, and bounds the differences by the precision that a format stores.

#include <cmath>
#include <cstring>
#include <span>

#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "formats/models/morton.h"
#include "scene/axes.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::test {

constexpr ModelFormat formats[] = {ModelFormat::ply, ModelFormat::spz, ModelFormat::sog};

inline std::string name_of(ModelFormat format) { return row_of(format).name; }

struct Written {
  Model model;
  std::vector<std::string> losses;
  std::string bytes;
};

/// Writes a model, which must have the format's axes, and reads it back.
inline Written round_trip(const Model& model, ModelFormat format, int harmonic_bits = 8) {
  const TempFolder folder;
  const auto path = folder / "model";
  OutputFile file(path);
  Written out;
  out.losses = write_model(file, model, format, harmonic_bits);
  file.commit();
  out.bytes = read_text(path);
  out.model = load_model(path);
  return out;
}

inline Model in_axes_of(Model model, ModelFormat format) {
  bring_into_axes(model, row_of(format).axes);
  return model;
}

/// Returns Gaussians with values that a trainer may store, and worse: opacities of 0 and 1, scales from
/// nothing to huge, quaternions of any length with components of equal size, coefficients beyond formats of
/// few bits, a position far out.
inline Model hard_model(int degree, std::size_t count, std::uint32_t seed = 1) {
  Uniform uniform(seed);
  Model model;
  model.degree = degree;
  const auto pick = [&](std::initializer_list<double> values, double low, double high) {
    const auto at = static_cast<std::size_t>(uniform(0, 4.0 * static_cast<double>(values.size())));
    return static_cast<float>(at < values.size() ? values.begin()[at] : uniform(low, high));
  };
  std::vector<float> sh(3 * static_cast<std::size_t>(sh_count(degree)));
  while (model.count() < count) {
    const auto number = [&] { return pick({0.0, 500.0, -500.0}, -5, 5); };
    const auto scale = [&] { return pick({-30, -104, -20, -10, 6, 10}, -9, 1); };
    const auto part = [&] { return pick({0, 1, -1, 0.5, -0.5}, -3, 3); };
    for (std::size_t k = 0; k < sh.size(); ++k)
      sh[k] = k < 3 ? pick({0, 1.8, -1.8, 4, -4}, -2, 2) : pick({0, 1, -1, 4, -4, 5}, -1, 1);
    append_raw(model, {{number(), number(), number()},
                       {scale(), scale(), scale()},
                       {part(), part(), part(), part()},
                       pick({-100, 100, 17, -17, 0}, -8, 8),
                       sh.data()});
  }
  model.left_out = 0;
  return model;
}

/// The values of one Gaussian that a format can store at best, and the largest errors from them.
struct Expected {
  glm::dvec3 position{0}, position_error{0};
  glm::dvec3 log_scale{0}, log_scale_error{0};
  double rotation_error = 0;  // length of the quaternions' difference, up to the sign
  double opacity = 0, opacity_error = 0;
  std::vector<double> sh, sh_error;
};

/// Relative error of results, which are rounded to floats; logarithms and exponentials are rounded once more.
constexpr double rounding = 0x1p-22;

inline Expected exact(const Model& model, std::size_t i) {
  const std::size_t values = model.sh.size() / model.count();
  Expected e;
  e.position = model.position[i];
  e.log_scale = glm::log(glm::dvec3(model.scale[i]));
  e.opacity = model.opacity[i];
  e.sh.assign(&model.sh[i * values], &model.sh[i * values] + values);
  e.sh_error.assign(values, 0.0);
  return e;
}

/// Error of a quaternion of which a format stores the three smallest components, each within `half`. The
/// largest, L >= 1/2, follows from these: its error is sum(|c|) half / L <= 3 half, because sum(|c|) <= 3/2.
/// Together these errors are sqrt(3 + 9) half.
inline double smallest_three_error(double half) { return 3.5 * half; }

inline Expected of_ply(const Model& model, std::size_t i) {
  Expected e = exact(model, i);
  // The logarithm is rounded to a float: at most 2^-24 of its value.
  e.log_scale_error = glm::abs(e.log_scale) * 0x1p-24 + rounding;
  e.opacity_error = rounding;
  e.rotation_error = rounding;  // some readers leave quaternions slightly shorter than 1
  return e;
}

inline Expected of_spz(const Model& model, std::size_t i, int harmonic_bits) {
  Expected e = exact(model, i);
  double most = 0;
  for (const glm::vec3& p : model.position)
    most = std::max({most, std::abs(double{p.x}), std::abs(double{p.y}), std::abs(double{p.z})});
  int bits = 12;
  while (bits < 24 && most * std::exp2(bits) < 16384) ++bits;
  while (most * std::exp2(bits) > 8388607) --bits;
  e.position_error = glm::dvec3(0.5 * std::exp2(-bits)) + glm::abs(e.position) * rounding;
  e.log_scale = glm::clamp(e.log_scale, -10.0, 255 / 16.0 - 10);
  e.log_scale_error = glm::dvec3(0.5 / 16 + 16 * rounding);
  e.opacity_error = 0.5 / 255 + rounding;
  e.rotation_error = smallest_three_error(0.5 * std::sqrt(0.5) / 511);
  for (std::size_t k = 0; k < e.sh.size(); ++k) {
    if (k < 3) {
      e.sh[k] = std::clamp(e.sh[k], -0.5 / 0.15, 0.5 / 0.15);
      e.sh_error[k] = 0.5 / 255 / 0.15 + 4 * rounding;
    } else {
      const double step = 2 / std::exp2(std::min(8, harmonic_bits + (k < 12 ? 1 : 0)));
      e.sh[k] = std::clamp(e.sh[k], -1.0, 1.0 - step);
      e.sh_error[k] = 0.5 * step;
    }
  }
  return e;
}

/// The range of the values that share a codebook, of which 64 are evenly spaced.
struct Ends {
  double low = 0, high = 0;
  void add(double v) { low = std::min(low, v), high = std::max(high, v); }
  double half_step() const { return (high - low) / 126 + rounding * std::max(std::abs(low), std::abs(high)); }
};
struct SogEnds {
  glm::dvec3 low{1e300}, high{-1e300};  // range of sign(p) ln(1 + |p|)
  Ends scale{1e300, -1e300}, dc{1e300, -1e300}, sh{1e300, -1e300};
};

inline double log_position(double p) { return std::copysign(std::log1p(std::abs(p)), p); }

inline SogEnds sog_ends(const Model& model) {
  SogEnds ends;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const Expected e = exact(model, i);
    for (int c = 0; c < 3; ++c) {
      ends.low[c] = std::min(ends.low[c], log_position(e.position[c]));
      ends.high[c] = std::max(ends.high[c], log_position(e.position[c]));
      ends.scale.add(std::clamp(e.log_scale[c], -20.0, 20.0));
    }
    for (std::size_t k = 0; k < e.sh.size(); ++k) (k < 3 ? ends.dc : ends.sh).add(e.sh[k]);
  }
  return ends;
}

/// Valid for up to 65,536 Gaussians, because each then has separate harmonics in the palette.
inline Expected of_sog(const Model& model, std::size_t i, const SogEnds& ends) {
  Expected e = exact(model, i);
  for (int c = 0; c < 3; ++c) {
    const double half = 0.5 * (ends.high[c] - ends.low[c]) / 65535;
    e.position_error[c] = std::expm1(half) * (1 + std::abs(e.position[c])) * (1 + half) +
                          rounding * (1 + std::abs(e.position[c]));
  }
  e.log_scale = glm::clamp(e.log_scale, -20.0, 20.0);
  e.log_scale_error = glm::dvec3(ends.scale.half_step() + 20 * rounding);
  e.opacity_error = 0.5 / 255 + rounding;
  e.rotation_error = smallest_three_error(0.5 * std::sqrt(2.0) / 255);
  for (std::size_t k = 0; k < e.sh.size(); ++k) e.sh_error[k] = (k < 3 ? ends.dc : ends.sh).half_step();
  return e;
}

/// Returns the first attribute of Gaussian `j` of `back` whose error exceeds the expected one, or "" if none
/// does.
inline std::string difference(const Expected& e, const glm::vec4& rotation, const Model& back,
                              std::size_t j) {
  const auto beyond = [](double a, double b, double error) { return !(a == b || std::abs(a - b) <= error); };
  for (int c = 0; c < 3; ++c) {
    if (beyond(back.axes.origin[c] + back.position[j][c], e.position[c], e.position_error[c]))
      return "position";
    if (beyond(std::log(double{back.scale[j][c]}), e.log_scale[c], e.log_scale_error[c])) return "scale";
  }
  const double apart = std::min(glm::length(glm::dvec4(rotation) - glm::dvec4(back.rotation[j])),
                                glm::length(glm::dvec4(rotation) + glm::dvec4(back.rotation[j])));
  if (beyond(apart, 0, e.rotation_error)) return "rotation";
  if (beyond(back.opacity[j], e.opacity, e.opacity_error)) return "opacity";
  const std::size_t values = back.sh.size() / back.count();
  if (values != e.sh.size()) return "degree";
  for (std::size_t k = 0; k < values; ++k) {
    if (beyond(back.sh[j * values + k], e.sh[k], e.sh_error[k])) return k < 3 ? "dc" : "sh";
  }
  return "";
}

/// The same for all Gaussians; `model` is the written one.
inline std::string difference(const Model& model, const Model& back, ModelFormat format,
                              int harmonic_bits = 8) {
  if (back.count() != model.count() || back.left_out != 0) return "count";
  if (back.axes.letters != model.axes.letters) return "axes";
  std::vector<std::uint32_t> order(model.count());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  if (format == ModelFormat::sog) order = morton_order(model.position);
  const SogEnds ends = sog_ends(model);
  for (std::size_t j = 0; j < order.size(); ++j) {
    const std::size_t i = order[j];
    const Expected e = format == ModelFormat::ply   ? of_ply(model, i)
                       : format == ModelFormat::sog ? of_sog(model, i, ends)
                                                    : of_spz(model, i, harmonic_bits);
    if (std::string found = difference(e, model.rotation[i], back, j); !found.empty()) return found;
  }
  return "";
}

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline bool same_bits(const Model& a, const Model& b) {
  return a.degree == b.degree && a.axes.letters == b.axes.letters && a.antialiased == b.antialiased &&
         a.kernel_px2 == b.kernel_px2 && a.perspective == b.perspective &&
         same_bits(a.position, b.position) && same_bits(a.scale, b.scale) &&
         same_bits(a.rotation, b.rotation) && same_bits(a.opacity, b.opacity) && same_bits(a.sh, b.sh);
}

}  // namespace binosplat::test
