#include "stereo/embed.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"
#include "base/log.h"
#include "gl/state.h"
#include "scene/axes.h"

namespace binosplat::stereo {

namespace {

/// The axes right, up, backward of an eye, as columns.
glm::dmat3 axes_of(const glm::dvec4& q) {
  const double length = glm::length(q);
  if (!(length > 0.0) || !std::isfinite(length))
    fail("orientation ({}, {}, {}, {}): expected a quaternion x, y, z, w that is not zero", q.x, q.y, q.z,
         q.w);
  return glm::mat3_cast(glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length));
}

Camera camera_of(const char* name, const XrEye& eye, const Stage& stage, const glm::ivec2& size) {
  if (size.x < 1 || size.y < 1) fail("eye {}: a picture of {} x {} px", name, size.x, size.y);
  glm::dmat3 rotation = stage.axes * axes_of(eye.orientation);
  rotation[1] = -rotation[1];
  rotation[2] = -rotation[2];
  const glm::dvec3 position = stage.origin + stage.units_per_metre * (stage.axes * eye.position);
  return camera_from_fov(name, position, rotation, eye.fov, size.x, size.y);
}

}  // namespace

Stage stage_of(const Model& model, const glm::dvec3& origin, double units_per_metre) {
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model.axes));
  return {into_model * origin, into_model * Stage{}.axes, units_per_metre};
}

EyePair eyes_from_xr(const std::array<XrEye, 2>& eyes, const Stage& stage,
                     const std::array<glm::ivec2, 2>& sizes, double near_plane) {
  Camera left = camera_of("left", eyes[0], stage, sizes[0]);
  Camera right = camera_of("right", eyes[1], stage, sizes[1]);
  constexpr double rounding = 1e-6;
  const double before = glm::dot(left.rotation[2], right.position - left.position);
  const double reach = stage.units_per_metre * glm::length(eyes[0].position);
  if (eyes[0].orientation == eyes[1].orientation && std::abs(before) <= rounding * reach)
    right.position -= before * left.rotation[2];
  return rig_from_eyes(left, right, near_plane);
}

EmbeddedRenderer::EmbeddedRenderer(gl::GetProcAddress get_proc_address, const Model& model)
    : context_(gl::Context::adopt(get_proc_address)) {
  for (const GLenum error : context_->take_errors())
    log_warning("OpenGL error 0x{:04x} was recorded before binosplat was called: it is the caller's", error);
  const gl::KeptState kept(*context_);
  frame_ = std::make_unique<render::Frame>(*context_, model);
  presenter_ = std::make_unique<Presenter>(*context_);
}

EmbeddedReport EmbeddedRenderer::draw(std::span<const shared::View> views, std::span<const Target> targets,
                                      int layout, const Background& background,
                                      const render::FrameSettings& settings) {
  const std::size_t pictures = layout == LAYOUT_SEPARATE ? views.size() : views.size() / 2;
  if (targets.size() != pictures || (layout != LAYOUT_SEPARATE && views.size() != 2)) {
    fail("{} views in layout {} do not go into {} targets", views.size(), layout_choices[layout].name,
         targets.size());
  }
  EmbeddedReport report;
  report.callers_errors = context_->take_errors();
  for (const GLenum error : report.callers_errors)
    log_warning("OpenGL error 0x{:04x} was recorded before binosplat drew: it is the caller's", error);
  const gl::KeptState kept(*context_);
  static_cast<render::FrameReport&>(report) = frame_->draw(views, settings);
  for (std::size_t k = 0; k < targets.size(); ++k)
    presenter_->draw(*frame_, k, layout, targets[k], background);
  return report;
}

}  // namespace binosplat::stereo
