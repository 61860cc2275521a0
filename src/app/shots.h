#pragma once
// From the options to what is drawn: the cameras, and the eyes of each.

#include <string>
#include <vector>

#include "app/render_options.h"
#include "scene/camera.h"
#include "scene/model.h"
#include "shared/types.h"
#include "stereo/rig.h"

namespace binosplat::app {

/// One eye's camera in the world, and what the shaders see of it in the model's frame (scene/axes.h).
struct Eye {
  std::string side;  // "left", "right", or "" for the camera itself
  Camera camera;
  shared::View view;
};

/// What one frame draws.
struct Shot {
  std::string name;  // the view's, as the user knows it
  std::string stem;  // of its files: unique among the shots, without folders and picture endings
  std::vector<Eye> eyes;
  std::optional<double> ipd;  // m, where there is a rig
  bool given_eyes = false;    // as a pair by the cameras
};

/// Where cameras come from, for the log, and which they are.
struct CameraList {
  std::string source;
  std::vector<Camera> cameras;
  bool listed = false;  // in a file or by the built-in scene: --view chooses; made-up ones are all drawn
  std::optional<double> near_plane;  // world units, where it is known
};

/// The cameras that --cameras, a file beside the model, or the built-in scene (`built_in`) gives; empty if
/// none does or the options make up their own. Quick: comes before the model is read.
CameraList listed_cameras(const RenderOptions& options, const std::vector<Camera>& built_in);

/// What lies beside the model, if anything does; says so.
std::optional<SavedPose> find_saved(const RenderOptions& options);

/// The pose that options.saved holds, where no option chooses cameras or asks for those of photos.
std::optional<CameraList> saved_camera(const RenderOptions& options);

/// --up, or what was saved.
glm::dvec3 up_of(const RenderOptions& options);

/// Cameras made up from --eye, --orbit or the model.
CameraList made_up_cameras(const RenderOptions& options, const Model& model);

/// --near, or what suits the cameras of a file, or those made up for the model; world units.
double near_plane_of(const RenderOptions& options, const CameraList& list, const Model& model);

/// What the options say of a rig. `near_plane` in world units.
stereo::RigSettings rig_settings(const RenderOptions& options, double near_plane);

/// A camera with the size and lens that --preset and --size ask for.
Camera sized(const RenderOptions& options, const Camera& camera);

/// What a frame draws of a shot.
std::vector<shared::View> views_of(const Shot& shot);

/// The shots that --view, --mono and the rig's options ask for. `near_plane` in world units, `axes` those of
/// the model. Throws Error for a view that is not there; it names some that are.
std::vector<Shot> make_shots(const RenderOptions& options, const CameraList& list, double near_plane,
                             const std::string& axes);

}  // namespace binosplat::app
