#include "demo/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace binosplat::demo {

namespace {

/// Limits a ray to a half space, gap + t * step >= 0, by changing `enter` and `leave`.
void cut(double gap, double step, double& enter, double& leave) {
  if (step > 0.0) {
    enter = std::max(enter, -gap / step);
  } else if (step < 0.0) {
    leave = std::min(leave, -gap / step);
  } else if (gap < 0.0) {
    leave = -1.0;
  }
}

/// Returns the distance along a ray at which it enters a solid, or `reach` if it enters none before.
double entered(const Solid& solid, const dvec3& from, const dvec3& direction, double reach) {
  const dvec3 p = solid.to_unit * from + solid.unit_origin, d = solid.to_unit * direction;
  double enter = 0.0, leave = reach;
  if (solid.shape == Solid::Shape::ellipsoid) {
    const double dd = glm::dot(d, d), pd = glm::dot(p, d), root = pd * pd - dd * (glm::dot(p, p) - 1.0);
    if (root <= 0.0) return reach;
    enter = std::max(enter, (-pd - std::sqrt(root)) / dd);
    leave = std::min(leave, (-pd + std::sqrt(root)) / dd);
    return enter < leave ? enter : reach;
  }
  for (int i = 0; i < 3; ++i) {
    cut(1.0 + p[i], d[i], enter, leave);
    cut(1.0 - p[i], -d[i], enter, leave);
  }
  if (solid.shape == Solid::Shape::roof) {
    for (const double side : {-2.0, 2.0}) cut(1.0 + p.y + side * p.z, d.y + side * d.z, enter, leave);
  }
  return enter < leave ? enter : reach;
}

}  // namespace

void Solids::add(Solid::Shape shape, const LocalAxes& frame, const dvec3& low, const dvec3& high) {
  const dvec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const dvec3 centre = frame.at(middle);
  const dvec3 reach =
      glm::abs(frame.axes[0]) * half.x + glm::abs(frame.axes[1]) * half.y + glm::abs(frame.axes[2]) * half.z;
  dmat3 to_unit = glm::transpose(frame.axes);
  for (int i = 0; i < 3; ++i) to_unit[i] /= half;
  solids_.push_back({shape, to_unit, -(to_unit * centre), half, centre - reach, centre + reach});
}

void Solids::build() {
  nodes_.clear();
  if (!solids_.empty()) add_node(0, static_cast<std::uint32_t>(solids_.size()));
}

void Solids::add_node(std::uint32_t begin, std::uint32_t end) {
  Node node{solids_[begin].low, solids_[begin].high, begin, end, 0};
  for (std::uint32_t k = begin + 1; k < end; ++k) {
    node.low = glm::min(node.low, solids_[k].low);
    node.high = glm::max(node.high, solids_[k].high);
  }
  const std::size_t own = nodes_.size();
  nodes_.push_back(node);
  if (end - begin == 1) return;
  const dvec3 size = node.high - node.low;
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const std::uint32_t middle = (begin + end) / 2;
  std::nth_element(solids_.begin() + begin, solids_.begin() + middle, solids_.begin() + end,
                   [&](const Solid& a, const Solid& b) {
                     return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis];
                   });
  add_node(begin, middle);
  nodes_[own].second = static_cast<std::uint32_t>(nodes_.size());
  add_node(middle, end);
}

double Solids::way(const dvec3& from, const dvec3& direction, double reach, bool any) const {
  const dvec3 inverse = 1.0 / direction;
  std::array<std::uint32_t, 64> waiting;
  std::size_t count = 0;
  double nearest = reach;
  if (!nodes_.empty()) waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t k = waiting[--count];
    const Node& node = nodes_[k];
    const dvec3 a = (node.low - from) * inverse, b = (node.high - from) * inverse;
    const dvec3 enter = glm::min(a, b), leave = glm::max(a, b);
    if (std::max({enter.x, enter.y, enter.z, 0.0}) > std::min({leave.x, leave.y, leave.z, nearest})) continue;
    if (node.second > 0) {
      waiting[count++] = node.second;
      waiting[count++] = k + 1;
      continue;
    }
    for (std::uint32_t s = node.begin; s < node.end; ++s) {
      nearest = entered(solids_[s], from, direction, nearest);
      if (any && nearest < reach) return nearest;
    }
  }
  return nearest;
}

bool Solids::hide(const dvec3& p) const {
  constexpr double skin = 0.003;  // a box's own faces remain
  return std::any_of(solids_.begin(), solids_.end(), [&](const Solid& s) {
    if (s.shape != Solid::Shape::box || glm::clamp(p, s.low, s.high) != p) return false;
    const dvec3 deep = (1.0 - glm::abs(s.to_unit * p + s.unit_origin)) * s.half;
    return std::min({deep.x, deep.y, deep.z}) > skin;
  });
}

}  // namespace binosplat::demo
