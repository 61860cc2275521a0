#include "render/instance.h"

namespace binosplat::render {

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
