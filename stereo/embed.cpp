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

Camera camera_of(const std::string& name, const XrEye& eye, const Stage& stage, const glm::ivec2& size) {
  if (size.x < 1 || size.y < 1) fail("eye {}: a picture of {} x {} px", name, size.x, size.y);
  glm::dmat3 rotation = stage.axes * axes_of(eye.orientation);
  rotation[1] = -rotation[1];
  rotation[2] = -rotation[2];
  const glm::dvec3 position = stage.origin + stage.units_per_metre * (stage.axes * eye.position);
  return camera_from_fov(name, position, rotation, eye.fov, size.x, size.y);
}

/// Those of the first one's orientation are moved by what rounding put them before or behind it.
std::vector<Camera> cameras_from_xr(std::span<const XrEye> eyes, const Stage& stage,
                                    std::span<const glm::ivec2> sizes) {
  constexpr double rounding = 1e-6;
  if (eyes.empty() || eyes.size() != sizes.size()) fail("{} eyes and {} sizes", eyes.size(), sizes.size());
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < eyes.size(); ++k) {
    const std::string name = eyes.size() > 2 ? fmt::format("{}", k) : k == 0 ? "left" : "right";
    Camera& camera = cameras.emplace_back(camera_of(name, eyes[k], stage, sizes[k]));
    const double before = glm::dot(cameras[0].rotation[2], camera.position - cameras[0].position);
    const double reach = stage.units_per_metre * glm::length(eyes[0].position);
    if (eyes[k].orientation == eyes[0].orientation && std::abs(before) <= rounding * reach)
      camera.position -= before * cameras[0].rotation[2];
  }
  return cameras;
}

}  // namespace

Stage stage_of(const Model& model, const glm::dvec3& origin, double units_per_metre) {
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model.axes));
  return {into_model * origin, into_model * Stage{}.axes, units_per_metre};
}

HeadViews views_from_xr(std::span<const XrEye> eyes, const Stage& stage, std::span<const glm::ivec2> sizes,
                        double near_plane) {
  return views_of_head(cameras_from_xr(eyes, stage, sizes), near_plane);
}

EyePair eyes_from_xr(const std::array<XrEye, 2>& eyes, const Stage& stage,
                     const std::array<glm::ivec2, 2>& sizes, double near_plane) {
  const std::vector<Camera> cameras = cameras_from_xr(eyes, stage, sizes);
  return rig_from_eyes(cameras[0], cameras[1], near_plane);
}

EmbeddedRenderer::EmbeddedRenderer(gl::GetProcAddress get_proc_address, const Model& model)
    : context_(gl::Context::adopt(get_proc_address)) {
  const gl::KeptState kept(*context_);
  frame_ = std::make_unique<render::Frame>(*context_, model);
  presenter_ = std::make_unique<Presenter>(*context_);
}

EmbeddedReport EmbeddedRenderer::draw(std::span<const shared::View> views, std::span<const Target> targets,
                                      int layout, const Background& background,
                                      const render::FrameSettings& settings,
                                      std::span<const DepthTarget> depths) {
  if (!depths.empty() && depths.size() != views.size())
    fail("{} views do not go into {} depth targets", views.size(), depths.size());
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
  Canvases canvases;
  if (layout == LAYOUT_SEPARATE) canvases = presenter_->canvases(targets, background);
  render::FrameSettings over = settings;
  if (background) over.background = *background;
  if (depths.empty()) over.depth = Depth::none;
  static_cast<render::FrameReport&>(report) =
      frame_->draw(views, over, {}, canvases.list, depth_rows(*context_, views, depths));
  for (std::size_t k = 0; k < targets.size() && !report.on_canvases; ++k)
    presenter_->draw(*frame_, k, layout, targets[k], background);
  for (std::size_t k = 0; k < depths.size(); ++k) presenter_->draw_depth(*frame_, k, depths[k]);
  return report;
}

}  // namespace binosplat::stereo
