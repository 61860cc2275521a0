#include "stereo/foveate.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "shared/limits.h"

namespace binosplat::stereo {

namespace {

constexpr double min_inset = 1.0, max_inset = 120.0;  // degrees
constexpr double max_gaze = 80.0;
constexpr double min_context_scale = 0.05;

// A composed pixel depends on this many pixels of the context on each side.
constexpr std::uint32_t inset_reach = 2;

glm::dvec3 direction_of(const glm::dvec2& gaze) {
  return glm::normalize(glm::dvec3(std::tan(glm::radians(gaze.x)), -std::tan(glm::radians(gaze.y)), 1.0));
}

// The range of slopes along axis k, x/z or y/z, in the cone of half angle `half` (radians) around
// `direction`.
glm::dvec2 slopes_of(const glm::dvec3& direction, int k, double half) {
  const double middle = std::atan2(direction[k], direction.z);
  const double sine = std::sin(half) / std::hypot(direction[k], direction.z);
  const double side = sine < 1.0 ? std::asin(sine) : glm::radians(90.0);
  const double most = glm::radians(89.0);
  return {std::tan(std::max(middle - side, -most)), std::tan(std::min(middle + side, most))};
}

struct Span {
  std::uint32_t begin = 0, end = 0;
};

Span pixels_between(double begin, double end, std::uint32_t size) {
  const auto within = [&](double at) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(size)));
  };
  return {within(std::floor(begin)), within(std::ceil(end))};
}

// Widens a span to multiples of BLEND_CELL, at which windows may begin and end.
Span to_cells(const Span& span, std::uint32_t size) {
  return {span.begin / BLEND_CELL * BLEND_CELL,
          std::min(size, (span.end + BLEND_CELL - 1) / BLEND_CELL * BLEND_CELL)};
}

}  // namespace

void check(const Foveation& f, std::string_view prefix) {
  // Each condition also fails for values that are not finite.
  if (!(f.inset_degrees >= min_inset && f.inset_degrees <= max_inset))
    fail("{}inset {}: expected {} to {} degrees", prefix, f.inset_degrees, min_inset, max_inset);
  if (!(f.context_scale >= min_context_scale && f.context_scale <= 1.0))
    fail("{}context {}: expected {} to 1, its width in px divided by the picture's", prefix, f.context_scale,
         min_context_scale);
  if (!(f.seam >= 0.0 && f.seam <= 1.0))
    fail("{}seam {}: expected a share of the inset's width, from 0 to 1", prefix, f.seam);
  for (const glm::dvec2& gaze : f.gaze) {
    if (!(std::abs(gaze.x) <= max_gaze && std::abs(gaze.y) <= max_gaze))
      fail("{}gaze {},{}: expected up to {} degrees to either side", prefix, gaze.x, gaze.y, max_gaze);
  }
}

FoveatedEye foveate(const shared::View& eye, const Foveation& foveation, std::size_t nth) {
  check(foveation);
  if (foveation.gaze.size() > 1 && nth >= foveation.gaze.size())
    fail("{} gazes, but none for eye {}: give one gaze per eye, or one for all", foveation.gaze.size(), nth);
  const glm::dvec2 gaze =
      foveation.gaze.empty() ? glm::dvec2(0.0) : foveation.gaze[std::min(nth, foveation.gaze.size() - 1)];
  const glm::dvec3 direction = direction_of(gaze);
  const double half = glm::radians(foveation.inset_degrees) / 2.0;
  const glm::uvec2 size(eye.width, eye.height);
  FoveatedEye out;
  for (int k = 0; k < 2; ++k) {
    const double focal = eye.lens[k], middle = eye.lens[k + 2];
    const glm::dvec2 px = focal * slopes_of(direction, k, half) + middle;
    const Span inset = pixels_between(px.x, px.y, size[k]);
    if (inset.begin >= inset.end) {
      fail("gaze {},{}: the inset lies outside the picture of {} x {} px", gaze.x, gaze.y, size.x, size.y);
    }
    out.inset_begin[k] = inset.begin;
    out.inset_end[k] = inset.end;
    if (k == 0) out.seam = foveation.seam * (px.y - px.x);
  }
  out.context = eye;
  for (int k = 0; k < 2; ++k) {
    const Span seam = pixels_between(out.inset_begin[k] - out.seam, out.inset_end[k] + out.seam, size[k]);
    const Span cells = to_cells(seam, size[k]);
    out.window.corner[k] = cells.begin;
    out.window.size[k] = cells.end - cells.begin;
    // The context has the same frustum in an integer number of pixels.
    const auto pixels = static_cast<std::uint32_t>(std::lround(size[k] * foveation.context_scale));
    const double scale = static_cast<double>(std::max(pixels, 1u)) / size[k];
    (k == 0 ? out.context.width : out.context.height) = std::max(pixels, 1u);
    out.context.lens[k] = static_cast<float>(eye.lens[k] * scale);
    out.context.lens[k + 2] = static_cast<float>(eye.lens[k + 2] * scale);
    out.context_region.low_pass_share *= static_cast<float>(scale);
    // The hole is the part of the context that is never drawn. No pixel outside the inset depends on it.
    const auto begin = static_cast<std::uint32_t>(std::ceil(out.inset_begin[k] * scale)) + inset_reach;
    const auto end = static_cast<std::uint32_t>(std::floor(out.inset_end[k] * scale));
    const bool at_begin = out.inset_begin[k] == 0, at_end = out.inset_end[k] == size[k];
    out.context_region.hole_begin[k] = at_begin ? 0 : begin;
    out.context_region.hole_end[k] = at_end ? std::max(pixels, 1u) : end - std::min(end, inset_reach);
  }
  if (glm::any(glm::greaterThanEqual(out.context_region.hole_begin, out.context_region.hole_end)))
    out.context_region.hole_begin = out.context_region.hole_end = glm::uvec2(0);
  out.window.tolerance_share = 0.0f;
  return out;
}

FoveatedViews foveated_views(std::span<const shared::View> eyes, const render::FrameSettings& settings) {
  if (eyes.empty() || eyes.size() > MAX_VIEWS / 2)
    fail("foveation of {} eyes: expected 1 to {}", eyes.size(), MAX_VIEWS / 2);
  if (!settings.regions.empty()) fail("foveation with view regions: expected whole views");
  if (settings.has_depths && settings.depth == DepthKind::median)
    fail("foveation with the median depth: expected the mean, because the seam mixes depths");
  FoveatedViews out{.settings = settings};
  for (std::size_t k = 0; k < eyes.size(); ++k) {
    const FoveatedEye& eye = out.eyes.emplace_back(foveate(eyes[k], *settings.foveation, k));
    out.views.insert(out.views.end(), {eye.context, eyes[k]});
    out.settings.regions.insert(out.settings.regions.end(), {eye.context_region, eye.window});
  }
  return out;
}

}  // namespace binosplat::stereo
