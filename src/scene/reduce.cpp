#include "scene/reduce.h"

#include <algorithm>
#include <utility>

namespace binosplat {

namespace {

/// Number of values in a Gaussian's harmonics up to a degree.
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
  none.set_training(model);
  none.axes = model.axes;
  return none;
}

void append(Model& model, const Model& from, std::size_t first, std::size_t count) {
  const std::size_t at = model.count();
  model.resize(at + count);
  copy(from, first, count, model, at);
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
  ordered.resize(indices.size());
  for (std::size_t k = 0; k < indices.size(); ++k) copy(model, indices[k], 1, ordered, k);
  return ordered;
}

int degree_in_use(const Model& model, std::size_t i) {
  const auto begin = model.sh.begin() + static_cast<std::ptrdiff_t>(i) * values_of(model.degree);
  int degree = model.degree;
  const auto unused = [&] {
    return std::all_of(begin + values_of(degree - 1), begin + values_of(degree),
                       [](float v) { return v == 0.0f; });
  };
  while (degree > 0 && unused()) --degree;
  return degree;
}

Model with_degrees(const Model& model, const std::vector<std::uint8_t>& degrees) {
  Model lower = model;
  int highest = 0;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const auto begin = lower.sh.begin() + static_cast<std::ptrdiff_t>(i) * values_of(model.degree);
    std::fill(begin + values_of(std::min<int>(degrees[i], model.degree)), begin + values_of(model.degree),
              0.0f);
    highest = std::max(highest, degree_in_use(lower, i));
  }
  set_degree(lower, highest);
  return lower;
}

void set_degree(Model& model, int degree) {
  if (model.degree == degree) return;
  const auto from = values_of(model.degree), to = values_of(degree);
  const std::vector<float> before = std::exchange(model.sh, {});
  model.degree = degree;
  model.resize(model.count());
  for (std::ptrdiff_t i = 0; i < std::ssize(model.position); ++i)
    std::copy_n(before.begin() + i * from, std::min(from, to), model.sh.begin() + i * to);
}

}  // namespace binosplat
