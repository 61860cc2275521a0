#include "xr/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace binosplat::xr {

namespace {

// The least and the largest x of what a triangle has between two heights; the first larger where it has none.
glm::dvec2 span_between(const std::array<glm::dvec2, 3>& corners, double top, double bottom) {
  glm::dvec2 span(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
  const auto take = [&](double x) { span = {std::min(span.x, x), std::max(span.y, x)}; };
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 a = corners[k], b = corners[(k + 1) % 3];
    if (a.y >= top && a.y <= bottom) take(a.x);
    for (const double edge : {top, bottom}) {
      if ((a.y < edge) != (b.y < edge)) take(a.x + (edge - a.y) / (b.y - a.y) * (b.x - a.x));
    }
  }
  return span;
}

}  // namespace

Visible visible_of(const Session& session, std::uint32_t view) {
  const Instance& instance = session.instance();
  if (!instance.has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME)) return {};
  const auto get = find<PFN_xrGetVisibilityMaskKHR>(instance.handle(), "xrGetVisibilityMaskKHR");
  XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
  const auto ask = [&] {
    check(get(session.handle(), instance.view_configuration(), view,
              XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR, &mask),
          "xrGetVisibilityMaskKHR");
  };
  ask();
  Visible visible;
  visible.vertices.resize(mask.vertexCountOutput);
  visible.indices.resize(mask.indexCountOutput);
  mask.vertexCapacityInput = mask.vertexCountOutput;
  mask.indexCapacityInput = mask.indexCountOutput;
  mask.vertices = visible.vertices.data();
  mask.indices = visible.indices.data();
  if (!visible.indices.empty()) ask();
  // A mask that makes no sense hides nothing.
  const bool makes_sense = std::all_of(visible.indices.begin(), visible.indices.end(),
                                       [&](std::uint32_t i) { return i < visible.vertices.size(); });
  return makes_sense ? visible : Visible{};
}

std::vector<glm::uvec2> visible_columns(const Visible& visible, const XrFovf& fov, const glm::ivec2& size,
                                        int tile) {
  if (visible.indices.size() < 3) return {};
  const double left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
  const double up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
  const glm::ivec2 tiles = (size + tile - 1) / tile;
  std::vector<glm::uvec2> columns(static_cast<std::size_t>(tiles.y), glm::uvec2(0));
  for (std::size_t i = 0; i + 2 < visible.indices.size(); i += 3) {
    std::array<glm::dvec2, 3> corners;
    glm::dvec2 heights(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < 3; ++k) {
      const XrVector2f& v = visible.vertices[visible.indices[i + k]];
      corners[k] = glm::dvec2((v.x - left) / (right - left), (up - v.y) / (up - down)) * glm::dvec2(size);
      heights = {std::min(heights.x, corners[k].y), std::max(heights.y, corners[k].y)};
    }
    if (!std::isfinite(heights.x + heights.y)) continue;
    const auto row_of = [&](double y) {
      return static_cast<int>(std::clamp(std::floor(y / tile), 0.0, tiles.y - 1.0));
    };
    for (int row = row_of(heights.x - 1.0); row <= row_of(heights.y + 1.0); ++row) {
      const glm::dvec2 span = span_between(corners, row * tile - 1.0, (row + 1) * tile + 1.0);
      if (!(span.x <= span.y)) continue;
      const auto clamped = [&](double x) {
        return static_cast<std::uint32_t>(std::clamp(x, 0.0, double(tiles.x)));
      };
      const glm::uvec2 found(clamped(std::floor((span.x - 1.0) / tile)),
                             clamped(std::ceil((span.y + 1.0) / tile)));
      glm::uvec2& of_row = columns[static_cast<std::size_t>(row)];
      if (found.x >= found.y) continue;
      of_row =
          of_row.x == of_row.y ? found : glm::uvec2(std::min(of_row.x, found.x), std::max(of_row.y, found.y));
    }
  }
  return columns;
}

}  // namespace binosplat::xr
