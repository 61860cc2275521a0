#include "app/vr180.h"

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/text.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

std::vector<Camera> eyes_in_axes(const Shot& shot, const ModelAxes& axes) {
  std::vector<Camera> eyes;
  for (const Eye& eye : shot.eyes) eyes.push_back(into_axes(eye.camera, axes));
  return eyes;
}

}  // namespace

void add_vr180_option(CLI::App& sub, Lens& lens) {
  sub.add_flag_callback(
         "--vr180", [&lens] { lens.preset = "vr180"; },
         "All that lies ahead of each eye, 180 degrees wide and high\n"
         "(equirectangular, 2048 x 2048 px an eye, or --size), level, for players of\n"
         "VR180: .png, or .vr.jpg, .mp4 and .mov that say so")
      ->group("Cameras");
}

void check_vr180(const RenderOptions& o) {
  if (!o.camera.lens.vr180()) return;
  if (const auto& size = o.camera.lens.size; size && (size->x != size->y || size->x % 2 != 0)) {
    fail("--size {0}x{1} with --vr180: expected an even number of pixels twice, for one 2880x2880", size->x,
         size->y);
  }
  if (const auto& size = o.camera.lens.size; size && size->x > stereo::panorama_side_most)
    fail("--size {0}x{0} with --vr180: at most {1}x{1}", size->x, stereo::panorama_side_most);
  const int layout = o.output.layout.value_or(LAYOUT_PARALLEL);
  if (layout != LAYOUT_PARALLEL && layout != LAYOUT_OVER_UNDER && layout != LAYOUT_SEPARATE)
    fail("--vr180 with --layout {}: players know parallel and over-under", layout_choices[layout].name);
  const std::string ending = lowered_ending(o.output.output);
  if (ending == ".mkv" || ending == ".webm")
    fail("-o {}: only .mp4 and .mov can be told to be VR180 here", o.output.output);
}

void level(Shot& shot, const glm::dvec3& up) {
  const glm::dvec3 down = -glm::normalize(up);
  Camera &first = shot.eyes.front().camera, &last = shot.eyes.back().camera;
  // Where it looks straight up or down, its own right.
  glm::dvec3 right = glm::cross(down, first.rotation[2] + last.rotation[2]);
  if (glm::length(right) < 1e-3) right = first.rotation[0] - glm::dot(first.rotation[0], down) * down;
  right = glm::normalize(right);
  const glm::dvec3 middle = 0.5 * (first.position + last.position);
  const double half = 0.5 * glm::length(last.position - first.position);
  first.position = middle - half * right;
  last.position = middle + half * right;
  for (Eye& eye : shot.eyes) eye.camera.rotation = glm::dmat3(right, down, glm::cross(right, down));
}

render::MemoryNeeds vr180_memory(const Shot& shot, const Model& model, double near_plane) {
  const int side = shot.eyes[0].camera.width;
  std::vector<shared::View> views;
  for (const Camera& eye : eyes_in_axes(shot, model.axes))
    views.push_back(make_view(stereo::panorama_face(side, eye, 0), near_plane));
  render::MemoryNeeds needs = render::memory_needs(render::make_plan(views, {}, model));
  // A ray's place, and its colour and distance for each eye.
  needs.frame += std::int64_t{side} * side * (16 + 20 * static_cast<std::int64_t>(views.size()));
  return needs;
}

render::FrameReport draw(stereo::Panorama& panorama, const Shot& shot, const ModelAxes& axes,
                         double near_plane) {
  return panorama.draw(eyes_in_axes(shot, axes), near_plane);
}

}  // namespace binosplat::app
