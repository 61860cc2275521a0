#include "render/instance.h"

#include <cmath>

#include "scene/axes.h"

namespace binosplat::render {

InstancePlace in_axes_of(const InstancePlace& in_world, const ModelAxes& model, const ModelAxes& frame) {
  const glm::dmat3 into_frame = glm::transpose(world_from_axes(frame.letters));
  InstancePlace place = in_world;
  place.rotation = into_frame * in_world.rotation * world_from_axes(model.letters);
  place.translation =
      into_frame * in_world.translation + place.scale * (place.rotation * model.origin) - frame.origin;
  return place;
}

std::optional<InstancePlace> place_of(const glm::dmat4& matrix) {
  constexpr double rounding = 1e-4;
  const glm::dmat3 linear(matrix);
  InstancePlace place{.translation = glm::dvec3(matrix[3]), .scale = std::cbrt(glm::determinant(linear))};
  if (!(place.scale > 0.0) || !std::isfinite(place.scale)) return std::nullopt;
  place.rotation = linear / place.scale;
  const bool is_rigid = orthonormality_error(place.rotation) < rounding;
  const bool is_affine = glm::transpose(matrix)[3] == glm::dvec4(0, 0, 0, 1);
  const bool is_finite = std::isfinite(glm::dot(place.translation, place.translation));
  return is_rigid && is_affine && is_finite ? std::optional(place) : std::nullopt;
}

shared::View view_of_instance(const shared::View& view, const InstancePlace& place) {
  const glm::dmat3 into_model = glm::transpose(place.rotation);
  const glm::dvec3 anchor = into_model * (glm::dvec3(view.anchor) - place.translation) / place.scale;
  shared::View seen = view;
  seen.anchor = glm::vec4(glm::vec3(anchor), view.anchor.w);
  // The translation and the eye absorb the anchor's rounding; otherwise a moving model would jitter.
  const glm::dvec3 rounded = anchor - glm::dvec3(seen.anchor);
  for (glm::vec4 shared::View::*row : {&shared::View::row_x, &shared::View::row_y, &shared::View::row_z}) {
    const glm::dvec3 axis = place.scale * (into_model * glm::dvec3(view.*row));
    seen.*row = glm::vec4(glm::vec3(axis), static_cast<float>((view.*row).w - glm::dot(axis, rounded)));
  }
  const auto seen_from = [&](const glm::vec4& point, float w) {
    return glm::vec4(glm::vec3(into_model * glm::dvec3(point) / place.scale + rounded), w);
  };
  seen.eye = seen_from(view.eye, static_cast<float>(place.scale));
  seen.centre = seen_from(view.centre, view.centre.w);
  seen.opacity = place.opacity;
  return seen;
}

}  // namespace binosplat::render
