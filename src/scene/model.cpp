#include "scene/model.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "scene/core.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

constexpr float opacity_rounding = 1e-3f;  // spacing of fp16 numbers above 1
constexpr float max_scale = 1e13f;         // above this its square would overflow fp32 in the renderer

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

void Model::reserve(std::size_t n) {
  position.reserve(n);
  scale.reserve(n);
  rotation.reserve(n);
  opacity.reserve(n);
  sh.reserve(n * 3 * static_cast<std::size_t>(sh_count(degree)));
}

void Model::resize(std::size_t n) {
  const double mb = 4e-6 * static_cast<double>(n) * (11 + 3 * sh_count(degree)), most = 1e-6 * memory_bytes();
  if (mb > most)
    throw Error(ExitCode::out_of_memory,
                fmt::format("{}: a model of {} Gaussians of degree {} takes {:.0f} of {:.0f} MB",
                            name.empty() ? "too large" : name, n, degree, mb, most));
  position.resize(n);
  scale.resize(n);
  rotation.resize(n);
  opacity.resize(n);
  sh.resize(n * 3 * static_cast<std::size_t>(sh_count(degree)));
}

bool decode_raw(Model& model, std::size_t i, const GaussianValues& raw) {
  GaussianValues values = raw;
  values.scale = {std::exp(raw.scale.x), std::exp(raw.scale.y), std::exp(raw.scale.z)};
  values.opacity = 1.0f / (1.0f + std::exp(-raw.opacity));
  return place(model, i, values);
}

bool place(Model& model, std::size_t i, const GaussianValues& values) {
  const auto& [from_zero, scale, rotation, given_opacity, sh] = values;
  const glm::vec3 position(from_zero - model.axes.origin);
  const std::size_t count = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const float nearest = std::clamp(given_opacity, 0.0f, 1.0f);
  const float opacity = std::abs(given_opacity - nearest) <= opacity_rounding ? nearest : given_opacity;
  // The squares of an fp32 quaternion can overflow fp32.
  const glm::dvec4 q(rotation);
  const double square = glm::dot(q, q), norm = std::sqrt(square);
  // A unit quaternion rounded to fp32 stays unchanged, so that written files are read back bit for bit.
  const bool unit = std::abs(square - 1.0) <= 0x1p-23;
  model.position[i] = position;
  model.scale[i] = scale;
  model.rotation[i] = unit ? rotation : glm::vec4(q / norm);
  model.opacity[i] = opacity;
  std::copy(sh, sh + count, &model.sh[i * count]);
  return finite(position) && glm::all(glm::greaterThanEqual(scale, glm::vec3(0.0f))) &&
         glm::all(glm::lessThanEqual(scale, glm::vec3(max_scale))) && opacity >= 0.0f && opacity <= 1.0f &&
         std::isfinite(norm) && norm > 0.0 &&
         std::all_of(sh, sh + count, [](float v) { return std::isfinite(v); });
}

void check_opacities(const std::string& source, std::span<const float> opacities) {
  constexpr std::ptrdiff_t damage_divisor = 100;  // one in this many may be damaged
  const auto is_beyond = [](float a) {
    return std::isfinite(a) && std::abs(a - 0.5f) > 0.5f + opacity_rounding;
  };
  if (std::ranges::count_if(opacities, is_beyond) <= std::ssize(opacities) / damage_divisor) return;
  const auto [low, high] = std::ranges::minmax(opacities);
  fail("{}: opacities are from {:.3g} to {:.3g}, probably logits: expected 0 to 1, their sigmoid", source,
       low, high);
}

void keep_only(Model& model, const std::vector<std::uint8_t>& kept) {
  std::size_t to = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0) continue;
    if (to != i) copy(model, i, 1, model, to);
    ++to;
  }
  model.left_out += kept.size() - to;
  model.resize(to);
}

void decode_all(Model& model, std::size_t count, const std::function<bool(std::size_t i)>& decode) {
  model.resize(count);
  std::vector<std::uint8_t> kept(count);
  parallel_for(
      count, [&](std::size_t i) { kept[i] = decode(i) ? 1 : 0; }, 2048);
  keep_only(model, kept);
}

bool choose_origin(Model& model) {
  Model some;  // a sample is enough
  for (std::size_t i = 0; i < model.count(); i += model.count() / 20000 + 1) {
    some.position.push_back(model.position[i]);
    some.scale.push_back(model.scale[i]);
  }
  if (some.count() == 0) return false;
  const auto [middle, radius] = core_of(some);
  constexpr double far = 1024.0;  // at this distance floats round by some hundredths of a pixel
  if (glm::length(middle) <= far * radius) return false;
  const double step = std::exp2(std::ceil(std::log2(radius)));
  // The origin has few digits, so that subtracting it rounds nothing.
  model.axes.origin = glm::round(middle / step) * step;
  return true;
}

void set_far_positions(Model& model, std::span<const glm::dvec3> positions) {
  if (!choose_origin(model)) return;
  for (std::size_t i = 0; i < model.count(); ++i) model.position[i] = positions[i] - model.axes.origin;
}

double move_origin(Model& model, const glm::dvec3& origin) {
  const glm::dvec3 by = std::exchange(model.axes.origin, origin) - origin;
  double most = 0.0;
  for (glm::vec3& p : model.position) {
    const glm::dvec3 exact = glm::dvec3(p) + by;
    p = exact;
    most = std::max(most, glm::distance(glm::dvec3(p), exact));
  }
  return most;
}

Bounds core_bounds(const Model& model) {
  Bounds bounds;
  if (model.count() == 0) return bounds;
  constexpr double sky = 8.0;  // core radii
  const Core core = core_of(model);
  std::vector<glm::vec3> positions;
  const auto take = [&](float least) {
    for (std::size_t k = 0; k < model.count(); ++k) {
      const double away = glm::distance(glm::dvec3(model.position[k]), core.middle);
      if (model.opacity[k] >= least && away < sky * core.radius) positions.push_back(model.position[k]);
    }
  };
  take(std::numeric_limits<float>::min());
  if (positions.empty()) take(0.0f);
  std::vector<float> axis(positions.size());
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < axis.size(); ++k) axis[k] = positions[k][i];
    const auto percentile = [&](double share) {
      const auto at =
          axis.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(axis.size() - 1));
      std::nth_element(axis.begin(), at, axis.end());
      return *at;
    };
    bounds.low[i] = model.axes.origin[i] + percentile(0.02);
    bounds.high[i] = model.axes.origin[i] + percentile(0.98);
  }
  return bounds;
}

Bounds all_bounds(const Model& model) {
  Box box;
  for (const glm::vec3& p : model.position) box.include(p, p);
  return model.count() == 0 ? Bounds{} : Bounds{model.axes.origin + box.low, model.axes.origin + box.high};
}

Box bounds_of(const Model& model, std::span<const std::uint32_t> indices) {
  Box box;
  for (const std::uint32_t i : indices) {
    const glm::vec4& q = model.rotation[i];
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(q.x, q.y, q.z, q.w));
    glm::dvec3 reach(0.0);
    for (int k = 0; k < 3; ++k) reach += glm::abs(turn[k]) * static_cast<double>(model.scale[i][k]);
    box.include(glm::dvec3(model.position[i]) - reach, glm::dvec3(model.position[i]) + reach);
  }
  return box;
}

Box bounds_of(const Model& model) {
  std::vector<std::uint32_t> all(model.count());
  std::iota(all.begin(), all.end(), 0u);
  return bounds_of(model, all);
}

}  // namespace binosplat
