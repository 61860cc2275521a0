#include "app/render/empty_view.h"

#include <fmt/format.h>

#include "base/text.h"
#include "scene/axes.h"
#include "scene/summary.h"

namespace binosplat::app {

namespace {

// Numbers of Gaussians by the place of their middles in a camera's view.
struct MiddlesSeen {
  std::size_t inside = 0;  // in the picture and beyond the near plane
  std::size_t ahead = 0;   // beyond the near plane
  std::size_t near = 0;    // between the camera and the near plane
};

MiddlesSeen look(const Model& model, Camera camera, double near_plane) {
  camera = into_axes(camera, model.axes);
  MiddlesSeen seen;
  for (const glm::vec3& p : model.position) {
    const ProjectedPoint point = project_point(camera, p);
    if (point.depth <= 0.0) continue;
    ++(point.depth > near_plane ? seen.ahead : seen.near);
    if (point.is_within(0.0) && point.depth > near_plane) ++seen.inside;
  }
  return seen;
}

}  // namespace

std::string why_empty(const Model& model, const Shot& shot, double near_plane, std::string_view elsewhere) {
  const Camera& eye = shot.eyes.front().camera;
  const MiddlesSeen seen = look(model, eye, near_plane);
  if (seen.inside > 0)
    return "the Gaussians in the picture have opacities below 1/255, or the threshold drops them "
           "(--threshold)";
  if (shot.ipd && shot.eyes.size() == 2) {
    Camera head = eye;
    head.position = 0.5 * (eye.position + shot.eyes[1].camera.position);
    if (look(model, head, near_plane).inside > 0) {
      return fmt::format(
          "the eyes are {:.4g} m apart, {:.4g} world units, and see past the model between them: --ipd is in "
          "metres, --units-per-metre sets the world units of one",
          *shot.ipd, *shot.ipd * shot.units_per_metre);
    }
  }
  if (seen.ahead == 0 && seen.near > 0)
    return fmt::format("everything ahead is nearer than --near {:.4g}", near_plane);
  const Bounds core = summarise(model).core;
  const glm::dvec3 middle = world_from_axes(model.axes.letters) * (0.5 * (core.low + core.high));
  return fmt::format("view {} looks {} the model, whose middle is at {},{},{}{}", shot.name,
                     seen.ahead == 0 ? "away from" : "past", coordinate(middle.x), coordinate(middle.y),
                     coordinate(middle.z), elsewhere);
}

std::size_t count_clipped(const Model& model, const Shot& shot, double near_plane) {
  constexpr std::size_t sample = std::size_t{1} << 18;  // because each frame of a path asks
  constexpr float faintest = 1.0f / 255.0f;
  const Camera camera = into_axes(shot.eyes.front().camera, model.axes);
  const std::size_t step = 1 + model.count() / sample;
  std::size_t cut = 0;
  for (std::size_t i = 0; i < model.count(); i += step) {
    const double depth = glm::dot(camera.rotation[2], glm::dvec3(model.position[i]) - camera.position);
    if (!(depth > 0.0 && depth <= near_plane)) continue;  // nearly all of them
    if (project_point(camera, model.position[i]).is_within(0.0) && model.opacity[i] > faintest) cut += step;
  }
  return cut;
}

}  // namespace binosplat::app
