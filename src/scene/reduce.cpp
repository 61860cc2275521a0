#include "scene/reduce.h"

#include <algorithm>

namespace binosplat {

namespace {

/// Values of a Gaussian's harmonics up to a degree.
std::ptrdiff_t values_of(int degree) { return 3 * static_cast<std::ptrdiff_t>(sh_count(degree)); }

}  // namespace

Model with_gaussians(const Model& model, const std::vector<std::uint8_t>& kept) {
  Model fewer = model;
  keep_only(fewer, kept);
  fewer.left_out = model.left_out;
  return fewer;
}

Model without_gaussians(const Model& model) {
  Model none;
  none.name = model.name;
  none.format = model.format;
  none.degree = model.degree;
  none.kernel_px2 = model.kernel_px2;
  none.antialiased = model.antialiased;
  none.antialiased_by = model.antialiased_by;
  none.perspective = model.perspective;
  none.axes = model.axes;
  return none;
}

void append(Model& model, const Model& from, std::size_t first, std::size_t count) {
  const auto add = [&](auto& to, const auto& values, std::size_t each) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first * each);
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count * each));
  };
  add(model.position, from.position, 1);
  add(model.scale, from.scale, 1);
  add(model.rotation, from.rotation, 1);
  add(model.opacity, from.opacity, 1);
  add(model.sh, from.sh, static_cast<std::size_t>(values_of(from.degree)));
}

void copy(const Model& from, std::size_t first, std::size_t count, Model& to, std::size_t at) {
  const auto take = [&](const auto& a, auto& b, std::size_t each) {
    std::copy_n(a.begin() + static_cast<std::ptrdiff_t>(first * each), count * each,
                b.begin() + static_cast<std::ptrdiff_t>(at * each));
  };
  take(from.position, to.position, 1);
  take(from.scale, to.scale, 1);
  take(from.rotation, to.rotation, 1);
  take(from.opacity, to.opacity, 1);
  take(from.sh, to.sh, static_cast<std::size_t>(values_of(from.degree)));
}

Model with_order(const Model& model, std::span<const std::uint32_t> indices) {
  Model ordered = without_gaussians(model);
  ordered.reserve(indices.size());
  for (const std::uint32_t i : indices) append(ordered, model, i, 1);
  return ordered;
}

Model with_degree(const Model& model, int degree) {
  Model lower = model;
  lower.degree = degree;
  lower.resize(model.count());
  for (std::size_t i = 0; i < model.count(); ++i) {
    const auto at = static_cast<std::ptrdiff_t>(i);
    std::copy_n(model.sh.begin() + at * values_of(model.degree), values_of(degree),
                lower.sh.begin() + at * values_of(degree));
  }
  return lower;
}

Model with_degrees(const Model& model, const std::vector<std::uint8_t>& degrees) {
  Model lower = model;
  int highest = 0;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const auto begin = lower.sh.begin() + static_cast<std::ptrdiff_t>(i) * values_of(model.degree);
    const auto end = begin + values_of(model.degree);
    std::fill(begin + values_of(std::min<int>(degrees[i], model.degree)), end, 0.0f);
    for (int degree = model.degree; degree > highest; --degree) {
      const bool used = std::any_of(begin + values_of(degree - 1), end, [](float v) { return v != 0.0f; });
      if (used) highest = degree;
    }
  }
  return highest < model.degree ? with_degree(lower, highest) : lower;
}

}  // namespace binosplat
