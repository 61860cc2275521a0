#pragma once
// Draws a model into the textures of a program with its own OpenGL context, such as a VR application.
//
//   const binosplat::SplatModel model("model.ply");
//   binosplat::Renderer renderer(eglGetProcAddress, model);
//   const binosplat::Placement placement = model.placement();
//   // Each frame, with the eyes from xrLocateViews and the textures from xrAcquireSwapchainImage:
//   const std::array views = {binosplat::View{left_eye, size, {.texture = left_texture}},
//                             binosplat::View{right_eye, size, {.texture = right_texture}}};
//   binosplat::Settings settings = binosplat::Settings::headset();
//   settings.background = glm::vec3(0.0f);
//   renderer.submit(views, placement, settings);
//   // ... the program's own work on the CPU, while the GPU draws ...
//   renderer.finish();
//
// Complete programs: examples/embed.cpp, mesh.cpp, world.cpp and openxr.cpp.

#include <cstdint>
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

/// A function that returns OpenGL's functions by name, as eglGetProcAddress and glfwGetProcAddress do.
/// SDL_GL_GetProcAddress and glXGetProcAddress have other types: cast them with reinterpret_cast.
using GetProcAddress = void (*(*)(const char* name))();

/// One picture to draw: its eye, size and target.
struct View {
  Eye eye = {};
  glm::ivec2 size{0};  // px, above 0
  Target target = {};  // must hold `size` px from its corner (x, y) on
  /// Set it for all views of a frame or for none; none is faster. The stored depth is the nearer one of
  /// splats and meshes.
  std::optional<DepthTarget> depth = {};
  /// Set it for all views of a frame (at most 4 views) or for none. submit() rejects it together with a
  /// background, a layout other than `separate`, or measured transmittance.
  std::optional<MeshDepth> mesh_depth = {};
  ViewRegion region = {};
};

/// Identifies a model that a Renderer holds.
enum class ModelId : std::uint32_t {};

/// A model at its place in a world. Any number of instances may draw one model.
///
/// The world has x right, y down and z forward, as COLMAP's, and its own units. A point p of the model lies
/// at translation + scale * rotation * p. If the axes of the model's file differ, the renderer first turns
/// the model to x right, y down and z forward. So every model stands upright.
struct Instance {
  ModelId model = {};
  glm::dmat3 rotation{1.0};     // columns of length 1 at right angles
  glm::dvec3 translation{0.0};  // world units
  double scale = 1.0;           // world units per unit of the model, above 0
  float opacity = 1.0f;         // from 0 to 1; multiplies the opacity of each Gaussian
  bool is_shown = true;
  /// With Transmittance::depth: the table of this model's Calibration, in the model's units. Empty: the
  /// table of the settings, in world units.
  DepthTable depth_table = {};
};

/// The content of a frame: instances, and the placement of the eyes' space in their world. The Gaussians of
/// all instances are sorted and blended together, as if they were one model. Instances cast no shadows on
/// each other. If the settings leave out the order or the projection, the first shown instance's model sets
/// it.
struct World {
  World(const Placement& of_eyes, std::span<const Instance> drawn) : placement(of_eyes), instances(drawn) {}

  Placement placement;
  std::span<const Instance> instances;
};

/// Models on the GPU, with the programs and buffers that draw them.
///
/// Threads: call every function, and the destructor, on the thread where the caller's context is current. On
/// other threads, calls throw Error(no_gl). If another context is current, the destructor frees nothing and
/// warns on standard error. Renderers of different contexts are independent.
///
/// Time: prepare(), or the first frames of each combination of settings, compile shaders, which may take
/// seconds. The renderer keeps the shaders in $XDG_CACHE_HOME/binosplat, or ~/.cache/binosplat, for later
/// runs.
///
/// State: each call restores the context's state, also after an error. The one exception is a current program
/// that was deleted, which OpenGL cannot make current again. The caller's bindings, enabled states and masks
/// do not change the pictures. Do not call within transform feedback or conditional rendering. Active queries
/// count the renderer's work.
class Renderer {
 public:
  /// Uploads the model into the current context, which is OpenGL 4.5 core or later. Context, textures and
  /// framebuffers stay the caller's. Throws Error: no_gl if no context is current or the context lacks a
  /// feature, out_of_memory, bad_input for an unknown precision.
  Renderer(GetProcAddress get_proc_address, const SplatModel& model, Precision precision = Precision::full);
  /// Draws the levels that a stream has read (binosplat/stream.h). A stream has one renderer at a time.
  Renderer(GetProcAddress get_proc_address, SplatStream& stream, Precision precision = Precision::full);
  /// Begins without a model. add() uploads models, and a World places them.
  explicit Renderer(GetProcAddress get_proc_address, Precision precision = Precision::full);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Draws up to 8 views of one head in one frame, each into its target. A layout other than `separate` takes
  /// two views of equal size, the left eye's first, and draws both into the first view's target. submit()
  /// passes the frame to the driver and returns while the GPU draws. Until finish() returns, do not read,
  /// write or delete the targets, and submit no other frame of this renderer. submit() never waits for the
  /// GPU, but it compiles shaders in the first frame of a combination of settings, and finds AdaGScale's K
  /// in the first frame that lacks it (Settings::tolerance).
  ///
  /// Successive views of equal direction and depth (position along the direction) are projected together,
  /// which saves time. So list an eye's views one after the other. Rounding may give parallel eyes slightly
  /// different depths. So a view is moved to the first view's depth if their orientations are equal and their
  /// depths differ by at most a millionth of the first eye's distance from the origin.
  ///
  /// With a quality or measured transmittance, a frame uses the measurements of earlier frames. A camera cut
  /// discards them: a view turns by more than 15 degrees, moves by more than a tenth of the drawn Gaussians'
  /// mean depth, or changes its size, frustum or drawn tiles; or the number of views changes.
  ///
  /// If submit() throws an Error, it has submitted nothing. bad_input: numbers that are not finite, an
  /// orientation of zero, an empty frustum or picture, contradictory settings, a target that is too small or
  /// cannot be drawn into, views that do not fit the layout, an unfinished frame. out_of_memory. no_gl: the
  /// GPU was reset, or the context is not current.
  void submit(std::span<const View> views, const Placement& placement, const Settings& settings = {});

  /// Uploads a model, or the levels that a stream has read, for the instances of a World. Call it once for
  /// each model, between frames or while a frame is under way. Throws as the constructors do.
  ModelId add(const SplatModel& model);
  ModelId add(SplatStream& stream);
  /// Frees a model. Throws Error(bad_input) while a frame is under way, and for a model that is not held.
  void remove(ModelId model);

  /// Draws a World as submit() draws a single model. From frame to frame instances may move, appear and
  /// disappear; no such change uploads a Gaussian. It is a camera cut if an instance moves, turns or grows,
  /// relative to a view, by more than the limits above. A Scaffold-GS model must be the only instance, and
  /// unmoved. Also throws Error(bad_input) for a model that was not added, and for numbers out of range.
  void submit(std::span<const View> views, const World& world, const Settings& settings = {});

  /// Returns the placement of the eyes' space in an instance's model: along the axes of the model's file and
  /// in its units. Calibration::settings() and SplatStream::begin_frame() take such a placement.
  Placement in_model(const Placement& placement, const Instance& instance) const;

  /// Compiles every shader that frames of these settings and targets may need, and finds AdaGScale's K if
  /// they lack it, so that no submit() does. Call it while the user waits anyway. It also allocates the
  /// frames' memory, and writes nothing into targets. The next frame uses no earlier measurements. For a
  /// stream it also compiles the shaders of begin_frame(). Throws as submit() does.
  void prepare(std::span<const View> views, const Placement& placement, const Settings& settings = {});
  void prepare(std::span<const View> views, const World& world, const Settings& settings = {});

  /// Whether the GPU has blended the submitted frame. If so, finish() returns at once, unless it must draw
  /// the frame again. True if no frame is under way.
  bool is_done();

  /// Waits until the GPU has blended the submitted frame. Draws the frame again if a buffer was too small.
  /// Then starts to copy the pictures that submit() could not write in place, and does not wait for these
  /// copies. Later commands of the caller in this context see the pictures without a
  /// glMemoryBarrier. Throws Error(bad_input) if no frame was submitted; otherwise as submit(). After an
  /// error the frame is over, and its targets may be half written.
  Report finish();

  /// submit() and finish() in one.
  Report draw(std::span<const View> views, const Placement& placement, const Settings& settings = {}) {
    submit(views, placement, settings);
    return finish();
  }
  Report draw(std::span<const View> views, const World& world, const Settings& settings = {}) {
    submit(views, world, settings);
    return finish();
  }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A file that `binosplat calibrate` wrote: tolerances for frames of a model, by AdaGScale or another rule.
///
///   const binosplat::Calibration calibration("calibration.json", model);
///   // Each frame:
///   renderer.submit(views, placement, calibration.settings(views, placement));
///
/// Copies are cheap. Any thread may call these functions; they need no context.
class Calibration {
 public:
  /// Reads the file, and checks that the model equals the calibrated model in all numbers. Throws
  /// Error(bad_input) if it does not, and for a file of another kind.
  Calibration(const std::filesystem::path& path, const SplatModel& model);

  /// Returns `asked` with the file's table by depth. If `asked` has neither a tolerance nor a quality, it
  /// also gets rule and tolerance of the file's first entry, or of the first with the threshold and the
  /// transmittance that `asked` names. The tolerance is scaled to the first view's focal length. If the first
  /// eye is farther from all calibrated cameras than the scene's cameras are apart, the settings are exact.
  /// Throws Error(bad_input) if the file lacks this threshold with this transmittance, or was made for
  /// another order, projection, low-pass, anti-aliasing or near plane; without a near plane, `asked` gets the
  /// file's. Throws as Renderer::submit() does for views.
  Settings settings(std::span<const View> views, const Placement& placement,
                    const Settings& asked = {}) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace binosplat
