#pragma once
// binosplat inside another program: a model drawn into that program's textures, in its own OpenGL context,
// from the poses and fields of view that OpenXR gives. examples/embed.cpp is a whole program.
//
// Ownership: context, textures and framebuffers stay the caller's; the model must outlive the renderer.
// Threads: everything here belongs to the thread that the context is current on; renderers of different
// contexts do not know of each other. State: after each call the context's state is what it was (gl/state.h
// says what is kept and what is never touched).

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "gl/context.h"
#include "render/frame.h"
#include "stereo/present.h"
#include "stereo/rig.h"

namespace binosplat::stereo {

/// One eye as OpenXR's XrView has it, in a space with x right, y up and z backward, in metres.
struct XrEye {
  glm::dvec3 position{0.0};                    // m
  glm::dvec4 orientation{0.0, 0.0, 0.0, 1.0};  // quaternion x, y, z, w, as XrQuaternionf orders it
  Fov fov;                                     // radians; XrFovf's four angles
};

/// Where the space that eyes are given in lies in the model's world.
struct Stage {
  glm::dvec3 origin{0.0};  // world units
  /// The space's axes in the world as columns: right, up, backward. By default the world of most trained
  /// models, whose y axis points down and z forward; stage_of() knows the others.
  glm::dmat3 axes{1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0};
  double units_per_metre = 1.0;
};

/// Where a space that stands upright in the world of a model's cameras lies in the model's own frame
/// (scene/axes.h), its origin at a point of that world.
Stage stage_of(const Model& model, const glm::dvec3& origin = glm::dvec3(0.0), double units_per_metre = 1.0);

/// The cameras and views of two eyes, each of its own size in px. Frusta may be asymmetric and eyes canted.
/// Eyes of one orientation share their depth order: the right one is moved by what rounding put it before or
/// behind the left, less than a millionth of its distance from the stage's origin. `near_plane` in world
/// units. Throws Error(bad_input) for an orientation that is not finite or zero, angles that enclose no
/// picture, an empty picture.
EyePair eyes_from_xr(const std::array<XrEye, 2>& eyes, const Stage& stage,
                     const std::array<glm::ivec2, 2>& sizes, double near_plane = near_default);

/// The same of any number of views of one head, each with its size, such as both eyes' wide pictures and the
/// insets in them. Those of one orientation and, but for rounding, one depth share their order if they follow
/// one another: put an eye's views side by side.
HeadViews views_from_xr(std::span<const XrEye> eyes, const Stage& stage, std::span<const glm::ivec2> sizes,
                        double near_plane = near_default);

/// What a frame took, and the errors that OpenGL had recorded before it began: the caller's own.
struct EmbeddedReport : render::FrameReport {
  std::vector<GLenum> callers_errors;
};

class EmbeddedRenderer {
 public:
  /// Uploads the model. A context of OpenGL 4.5 core or later is current, and `get_proc_address` finds its
  /// functions (eglGetProcAddress, glfwGetProcAddress). Throws Error: no_gl for what the context lacks,
  /// out_of_memory.
  EmbeddedRenderer(gl::GetProcAddress get_proc_address, const Model& model);

  /// Draws all views in one frame and each into its target (LAYOUT_SEPARATE), or two views into one target in
  /// another layout (stereo/present.h), and their depths (settings.depth says which) into as many depth
  /// targets, if any; without any no depth is drawn. Waits until the frame is done, not for the targets. An
  /// error that OpenGL recorded before is the caller's: it is logged, reported, and does not stop the frame.
  /// Throws Error as render::Frame and Presenter do, and std::runtime_error for an OpenGL error of
  /// binosplat's own; the state is restored then, too.
  EmbeddedReport draw(std::span<const shared::View> views, std::span<const Target> targets,
                      int layout = LAYOUT_SEPARATE, const Background& background = std::nullopt,
                      const render::FrameSettings& settings = {}, std::span<const DepthTarget> depths = {});

  gl::Context& context() { return *context_; }

 private:
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<render::Frame> frame_;
  std::unique_ptr<Presenter> presenter_;
};

}  // namespace binosplat::stereo
