#pragma once
// Turns options into shots: the cameras, and the eyes of each camera.

#include <functional>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "formats/cameras/pose_file.h"
#include "scene/camera.h"
#include "scene/framing.h"
#include "scene/model.h"
#include "shared/types.h"
#include "stereo/rig.h"

namespace binosplat::app {

Camera sized(const Lens& lens, const Camera& camera);

/// One eye: its camera in world coordinates, and its view for shaders in the model's axes (scene/axes.h).
struct Eye {
  std::string side;  // "left", "right", or "" for the camera itself
  Camera camera;
  shared::View view;
};

/// A file of a shot: the picture of one eye, or of both eyes.
struct PictureFile {
  std::string name;
  std::optional<std::size_t> eye;
};

/// One frame to draw, and its files.
struct Shot {
  std::string name;  // the view's name, for users
  std::string stem;  // start of its file names: stem_of(name), unique among the shots
  std::vector<Eye> eyes;
  std::vector<PictureFile> files;  // only for `render`: set by place_files() (app/render/outputs.h)
  std::optional<double> ipd;       // m; only with a rig
  double units_per_metre = 1.0;    // world units
  bool given_eyes = false;         // the cameras define the pair
};

/// Defaults from the scene for rigs and for cameras made from the model.
struct SceneHints {
  std::optional<double> units_per_metre;  // world units
  std::optional<double> ipd;              // m
  std::optional<double> convergence;      // m
  std::optional<glm::dvec3> up;           // up direction of the world, or --up
  std::optional<Capture::Around> around;  // centre for cameras made from the model
  std::optional<double> reach;            // largest coordinate of the cameras beside the model, world units
  std::string unusable;                   // why the cameras beside the model cannot be used, else empty
};

/// Cameras and their source.
struct CameraList {
  std::string source;
  std::vector<Camera> cameras;
  bool listed = false;               // from a file or a built-in scene, not made from the model
  bool path = false;                 // frames of one path
  std::optional<double> near_plane;  // world units, if known
  SceneHints hints;
};

/// Returns the cameras of --cameras, of a file beside the model or of the built-in scene, without reading the
/// model. The list is empty if there are none, if options place cameras, or if the cameras beside the model
/// cannot be used (SceneHints::unusable) and no option requests them. Its hints have units and eye distance
/// by the rig's options, or else the scene's. `saved` comes from find_saved().
CameraList listed_cameras(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig = {},
                          const std::optional<SavedPose>& saved = {});

/// The reason for missing cameras, for errors: there are none beside the model, or they cannot be used.
std::string why_no_cameras(const SceneOptions& scene, const SceneHints& hints);

/// The pose that `binosplat view` saved beside the model, if any; logs it.
std::optional<SavedPose> find_saved(const SceneOptions& scene);

/// The saved pose as a camera, unless an option chooses cameras.
std::optional<CameraList> saved_camera(const SceneOptions& scene, const CameraOptions& camera,
                                       const std::optional<SavedPose>& saved);

CameraList eye_camera(const CameraOptions& camera, const SceneHints& hints);

/// Makes level cameras by --eye, by --orbit or from the model (scene/framing.h). Stores and logs their up
/// direction and centre, which come from cameras beside the model or from the model itself, and for cameras
/// from the model eyes and a screen that are comfortable, unless options of the rig set them.
CameraList generate_cameras(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                            SceneHints hints, const Model& model);

/// Returns the list, or a made-up camera if it is empty. Also makes one up, and warns, if no option chose the
/// cameras beside the model and none of them sees it.
CameraList cameras_that_see(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                            CameraList list, const Model& model);

struct NearPlane {
  double units = near_default;  // world units
  std::string by;               // the option or file that says so, for display; empty: the default
};

/// Returns --near, or that of the model's training, or else the near plane that suits the cameras.
NearPlane find_near_plane(const CameraOptions& camera, const CameraList& list, const Training& training);
inline double near_plane_of(const CameraOptions& camera, const CameraList& list, const Training& training) {
  return find_near_plane(camera, list, training).units;
}

/// The rig of the options, with defaults from the scene. `near_plane` is in world units.
stereo::RigSettings rig_settings(const RigOptions& rig, const SceneHints& hints,
                                 double near_plane = near_default);

/// Moves the screen of a parallel rig from infinity to `metres`. Ignores eyes that the cameras define.
void converge(Shot& shot, double metres);

std::vector<shared::View> views_of(const Shot& shot);

/// The cameras of a shot's eyes in the model's axes.
std::vector<Camera> eyes_in_axes(const Shot& shot, const ModelAxes& axes);

/// Value of --view for all views of a list.
inline const std::vector<std::string> all_views = {"all"};

/// Splits each text of --view at commas, unless the whole text is a view's name.
std::vector<std::string> view_names(const std::vector<std::string>& texts, const CameraList& list);

/// Throws Error for a view that a listed file lacks, as make_shots() does, but before the model is read.
void check_views(const std::vector<std::string>& views, bool mono, const CameraList& list);

/// The cameras of the named views, or all without names, without a rig. Throws Error for an unknown view; the
/// message names `option` and some known views.
std::vector<Camera> chosen_cameras(const std::vector<std::string>& views, const Lens& lens,
                                   const CameraList& list, const char* option = "--view");

/// Makes the shots of the named views: of all views for all_views, or of the first view if none is named.
/// A path, and cameras made from the model, always give all. `near_plane` is in world units; `axes` are the
/// model's. Throws as chosen_cameras() does.
std::vector<Shot> make_shots(const std::vector<std::string>& views, const Lens& lens, const RigOptions& rig,
                             const CameraList& list, double near_plane, const ModelAxes& axes);

}  // namespace binosplat::app
