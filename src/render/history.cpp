#include "render/history.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace binosplat::render {

namespace {

constexpr double turn_max_degrees = 15.0;
constexpr double move_max_of_depth = 0.1;
// If a view has gone this share of the way to a camera cut, the frame measures.
constexpr double measure_share = 1.0 / 3.0;

double turned_degrees(const shared::View& a, const shared::View& b) {
  const auto dot = [](const glm::vec4& x, const glm::vec4& y) {
    return glm::dot(glm::dvec3(x), glm::dvec3(y));
  };
  // The trace of the rotation from one view to the other is 1 + 2 cos(angle).
  const double trace = dot(a.row_x, b.row_x) + dot(a.row_y, b.row_y) + dot(a.row_z, b.row_z);
  const double unit = double{a.eye.w} * b.eye.w;
  return glm::degrees(std::acos(std::clamp((trace / unit - 1.0) / 2.0, -1.0, 1.0)));
}

double moved(const shared::View& a, const shared::View& b) {
  const glm::dvec3 eye_a = glm::dvec3(a.anchor) + glm::dvec3(a.eye);
  const glm::dvec3 eye_b = glm::dvec3(b.anchor) + glm::dvec3(b.eye);
  return b.eye.w * glm::length(eye_a - eye_b);
}

// The difference between two views of a model, as a share of a camera cut.
double motion(const shared::View& a, const shared::View& b, double middle_depth) {
  const double way = moved(a, b), cut = move_max_of_depth * middle_depth;
  return std::max({turned_degrees(a, b) / turn_max_degrees, way > 0.0 ? way / cut : 0.0,
                   std::abs(b.eye.w / a.eye.w - 1.0) / move_max_of_depth});
}

// The rows of tiles of the requested views. Changed rows are a camera cut, because tiles that were not drawn
// have measured nothing.
std::span<const glm::uvec2> rows_asked(const FramePlan& plan) {
  const bool has_probe = plan.draws_regions() && plan.view_count() > plan.requested_views;
  return std::span(plan.region_rows)
      .first(has_probe ? plan.views[plan.requested_views].first_row : plan.region_rows.size());
}

}  // namespace

// Averages the bits of floats, which are nearly linear in the logarithm.
double middle_depth(const shared::Counters& counters) {
  if (counters.visible == 0) return 0.0;
  const double sum = (counters.depths_high * 0x1p32 + counters.depths_low) * COMPACT_BLOCK;
  return std::bit_cast<float>(static_cast<std::uint32_t>(sum / counters.visible));
}

double motion(const FramePlan& before, const FramePlan& now, double middle_depth) {
  constexpr double other = std::numeric_limits<double>::infinity();
  if (!std::ranges::equal(rows_asked(before), rows_asked(now))) return other;
  if (before.requested_views != now.requested_views || before.gaussian_count != now.gaussian_count ||
      before.instances.size() != now.instances.size())
    return other;
  double most = 0.0;
  for (std::size_t v = 0; v < now.requested_views; ++v) {
    const shared::View& a = before.views[v];
    const shared::View& b = now.views[v];
    if (a.width != b.width || a.height != b.height || a.lens != b.lens || a.left != b.left || a.top != b.top)
      return other;
    most = std::max(most, motion(a, b, middle_depth));
    for (std::size_t k = 0; k < now.instances.size(); ++k) {
      most = std::max(most, motion(view_of_instance(a, before.instances[k]),
                                   view_of_instance(b, now.instances[k]), middle_depth));
    }
  }
  return most;
}

void FrameHistory::follow(const FramePlan& now) {
  measured_ = {};
  last_.gaussian_count = now.gaussian_count;
  last_.instances = now.instances;
}

Measuring FrameHistory::decide(const FramePlan& now) {
  const FrameSettings& s = now.settings;
  if (!measures(s)) return {};
  Measuring measuring;
  measuring.uses_last = measures(measured_.settings) && measured_.perspective == now.perspective &&
                        motion(measured_, now, middle_depth_) <= 1.0;
  since_cut_ = measuring.uses_last ? since_cut_ + 1 : 0;
  ++since_measured_;
  measuring.measures = since_cut_ < s.measure_every || since_measured_ >= s.measure_every ||
                       now.offset_count > 0 || motion(measured_, now, middle_depth_) > measure_share;
  return measuring;
}

void FrameHistory::store(const FramePlan& drawn, const Measuring& measuring,
                         const shared::Counters& counters) {
  last_ = drawn;
  middle_depth_ = middle_depth(counters);
  if (measuring.measures) {
    measured_ = drawn;
    since_measured_ = 0;
  } else if (!measures(drawn.settings)) {
    measured_ = {};
  }
}

}  // namespace binosplat::render
