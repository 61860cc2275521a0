#pragma once
// Draws a model into the textures of a program that has an OpenGL context of its own, as VR applications do.
//
//   const binosplat::SplatModel model("model.ply");
//   binosplat::Renderer renderer(eglGetProcAddress, model);
//   const binosplat::Placement placement = model.placement();
//   // Each frame, with the eyes from xrLocateViews and the textures from xrAcquireSwapchainImage:
//   const std::array views = {binosplat::View{left_eye, size, {.texture = left_texture}},
//                             binosplat::View{right_eye, size, {.texture = right_texture}}};
//   renderer.submit(views, placement, {.background = glm::vec3(0.0f)});
//   // ... the program's own work of the CPU, while the GPU draws ...
//   renderer.finish();
//
// examples/embed.cpp, examples/mesh.cpp and examples/openxr.cpp are whole programs.

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <binosplat/error.h>
#include <binosplat/eyes.h>
#include <binosplat/model.h>
#include <binosplat/report.h>
#include <binosplat/settings.h>
#include <binosplat/targets.h>

namespace binosplat {

class SplatStream;

/// How OpenGL's functions are found by name: eglGetProcAddress, glfwGetProcAddress and their like. Cast
/// SDL_GL_GetProcAddress and glXGetProcAddress, which have other types, with reinterpret_cast.
using GetProcAddress = void (*(*)(const char* name))();

/// The drawn part of a view, and how exactly it is drawn; by default all of it, as the settings say. Rows
/// count from the top of the picture.
struct ViewRegion {
  static constexpr int tile = 16;  // px, a side of the tiles below
  /// For each row of tiles the columns of tiles [x, y) that are drawn; nothing is drawn of others, such as
  /// those that no lens shows. Empty: all.
  std::vector<glm::uvec2> columns = {};
  /// px. Tiles that lie within [hole_begin, hole_end) are not drawn, either: what an inset covers.
  glm::uvec2 hole_begin{0}, hole_end{0};
  float tolerance_share = 1.0f;  // times the frame's tolerance is the view's; 0: the view is exact
  /// Where this picture has fewer pixels a degree than the one that it stands for, as the wide one around an
  /// inset has: (its pixels a degree / the other's) squared, at most 1. The low-pass is as many px wide in
  /// every picture, so thin Gaussians would be too bright in this one; the renderer dims them by that. It
  /// changes nothing of anti-aliased models.
  float low_pass_share = 1.0f;

  bool operator==(const ViewRegion&) const = default;
};

/// A picture that is drawn: from where, how large, and into what.
struct View {
  Eye eye = {};
  glm::ivec2 size{0};  // px, above 0
  Target target = {};  // at least so large from its corner on
  /// For all views of a frame, or for none, which is faster. With mesh depths the nearer of splats and
  /// meshes.
  std::optional<DepthTarget> depth = {};
  /// For all views of a frame, at most 4, or for none. Not with a background, a layout other than `separate`
  /// or a transmittance that is measured.
  std::optional<MeshDepth> mesh_depth = {};
  ViewRegion region = {};
};

/// A model on the GPU, and what drawing it needs there.
///
/// Threads: call all of it, the destructor included, on the thread where the caller's context is current.
/// Elsewhere calls throw Error(no_gl), and the destructor, where another context is current, frees nothing
/// and says so on standard error. Renderers of different contexts do not know of each other.
///
/// Time: the renderer compiles its shaders in prepare(), or at the first frames of each combination of
/// settings, which may take seconds, and keeps them in $XDG_CACHE_HOME/binosplat, or ~/.cache/binosplat, for
/// later runs.
///
/// State: after each call, and after an error, the context's state is what it was before, but for a program
/// in use that was deleted, which OpenGL does not set again. Bindings, enabled states and masks do not change
/// the pictures. Do not call within transform feedback or conditional rendering; queries that are active
/// count what is done here.
class Renderer {
 public:
  /// Uploads the model into the context that is current, of OpenGL 4.5 core or later. Context, textures and
  /// framebuffers stay the caller's. Throws Error: no_gl where none is current and for what it lacks,
  /// out_of_memory; bad_input for a precision that there is not.
  Renderer(GetProcAddress get_proc_address, const SplatModel& model, Precision precision = Precision::full);
  /// Draws the levels that a stream has read (binosplat/stream.h), which has one renderer at a time.
  Renderer(GetProcAddress get_proc_address, SplatStream& stream, Precision precision = Precision::full);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Draws up to 8 views of one head in one frame, each into its target. With another layout than `separate`
  /// it draws two views of one size, the left eye's first, into the first view's target. It hands the frame
  /// to the driver and returns while the GPU draws; until finish() returns, targets are not to be read,
  /// written or deleted, and no other frame of this renderer may be submitted. Nothing in it waits for the
  /// GPU, but for the first frame of a combination of settings, whose shaders are compiled.
  ///
  /// Views that look the same way from the same depth are projected together, which saves time, if they
  /// follow one another: put an eye's views side by side. Those of one orientation that lie before or behind
  /// the first one by less than a millionth of its distance from the eyes' origin are moved to its depth:
  /// poses of parallel eyes are as far apart by rounding.
  ///
  /// With a quality, or a transmittance that is measured, a frame uses what earlier ones measured. It begins
  /// anew where a view has turned by more than 15 degrees, has moved by more than a tenth of the middle depth
  /// of what was drawn, or has another size, frustum or set of tiles, and where there are more or fewer
  /// views.
  ///
  /// Throws Error, and submits nothing: bad_input for numbers that are not finite, an orientation of zero,
  /// a frustum that encloses no picture, an empty picture, settings that contradict each other, a target that
  /// cannot be drawn into or is too small, views that do not go into the layout, a frame that was not
  /// finished; out_of_memory; no_gl for a GPU that was reset, and where the context is not current.
  void submit(std::span<const View> views, const Placement& placement, const Settings& settings = {});

  /// Compiles every shader that frames of these settings may need, with targets such as these, so that no
  /// submit() has to: call it while the user waits anyway. Takes the frames' memory, too, and writes nothing
  /// into targets. The next frame goes by no earlier ones. Of a stream it also compiles what begin_frame()
  /// needs. Throws as submit() does.
  void prepare(std::span<const View> views, const Placement& placement, const Settings& settings = {});

  /// Whether the GPU has blended the frame that was submitted. finish() then returns at once, unless the
  /// frame must be drawn again. True where no frame is under way.
  bool is_done();

  /// Waits until the GPU has blended the frame that was submitted, draws it again where a buffer was too
  /// small or its quality missed, and writes what submit() could not write in place. Does not wait for what
  /// it then writes into targets; commands that the caller gives in this context afterwards see the pictures,
  /// without a glMemoryBarrier. Throws Error: bad_input where no frame was submitted; otherwise as submit();
  /// the frame is then over, and its targets may be half written.
  Report finish();

  /// submit() and finish() in one.
  Report draw(std::span<const View> views, const Placement& placement, const Settings& settings = {}) {
    submit(views, placement, settings);
    return finish();
  }

 private:
  void hand_over(std::span<const View> views, const Placement& placement, const Settings& settings,
                 bool prepares);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// AdaGScale: K and the table by depth come from a calibration.
inline const Settings adagscale{.threshold = Threshold::peripheral, .transmittance = Transmittance::by_depth};

/// A file of `binosplat calibrate`: how much of a model frames may leave out, by AdaGScale or another rule.
///
///   const binosplat::Calibration calibration("calibration.json", model);
///   // Each frame:
///   renderer.submit(views, placement, calibration.settings(views, placement));
///
/// Copies are cheap. Everything here may be called from any thread, and needs no context.
class Calibration {
 public:
  /// Reads the file, and all numbers of the model, to see that it is the one that was calibrated. Throws
  /// Error(bad_input) for what is no such file, and for another model.
  Calibration(const std::filesystem::path& path, const SplatModel& model);

  /// `asked` with the file's table, and, where it has neither a tolerance nor a quality, with the file's
  /// tolerance for its threshold (none: squared) and transmittance, scaled to the first view's focal length.
  /// Exact where the first eye is farther from the calibrated cameras than twice the largest distance between
  /// neighbours of them. Throws Error(bad_input) where the file has nothing for that threshold and
  /// transmittance, or is of another order or projection; and as Renderer::submit() does for views.
  Settings settings(std::span<const View> views, const Placement& placement,
                    const Settings& asked = adagscale) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace binosplat
