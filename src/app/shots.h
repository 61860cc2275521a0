#pragma once
// From the options to what is drawn: the cameras, and the eyes of each.

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "app/camera_options.h"
#include "app/rig_options.h"
#include "app/scene_options.h"
#include "formats/pose_file.h"
#include "formats/view_files.h"
#include "scene/camera.h"
#include "scene/framing.h"
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

/// A file of a shot: the picture of one of its eyes, or of both in one.
struct PictureFile {
  std::string name;
  std::optional<std::size_t> eye;
};

/// What one frame draws, and where it goes.
struct Shot {
  std::string name;   // the view's, as the user knows it
  std::string stem;   // of its files: stem_of() the name, unique among the shots
  std::string model;  // its file, where each shot has another one (app/sequence.h)
  std::vector<Eye> eyes;
  std::vector<PictureFile> files;  // of `render`: by place_files() (app/outputs.h)
  std::optional<double> ipd;       // m, where there is a rig
  double units_per_metre = 1.0;    // world units
  bool given_eyes = false;         // as a pair by the cameras
};

/// What goes for a rig and for cameras that are made up where no option says it.
struct Known {
  std::optional<double> units_per_metre;  // world units
  std::optional<double> ipd;              // m
  std::optional<glm::dvec3> up;           // the world's; --up, where that is given
  std::optional<Capture::Around> around;  // what to stand around
  std::string unusable;                   // why the cameras beside the model cannot be used, if they cannot
};

/// Where cameras come from, for the log, and which they are.
struct CameraList {
  std::string source;
  std::vector<Camera> cameras;
  bool listed = false;               // in a file or by the built-in scene, and not made up
  bool path = false;                 // the frames of one path
  std::optional<double> near_plane;  // world units, where it is known
  Known known;
};

/// The cameras that --cameras, a file beside the model, or the built-in scene gives; empty if none does, the
/// options make up their own, or those beside the model, for which no option asks, cannot be used
/// (Known::unusable). Quick: comes before the model is read. `saved` as find_saved() has it. What
/// is known of metres is the rig's, where it says so, or the scene's: the list's cameras, and those made up,
/// go by that.
CameraList listed_cameras(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig = {},
                          const std::optional<SavedPose>& saved = {});

/// For errors of what needs cameras: that none lie beside the model, or why those cannot be used.
std::string why_no_cameras(const SceneOptions& scene, const Known& known);

/// What `binosplat view` saved beside the model, if it did; says so.
std::optional<SavedPose> find_saved(const SceneOptions& scene);

/// The saved pose as a camera, where no option chooses cameras.
std::optional<CameraList> saved_camera(const SceneOptions& scene, const CameraOptions& camera,
                                       const std::optional<SavedPose>& saved);

/// The camera of --eye and --at.
CameraList eye_camera(const CameraOptions& camera, const Known& known);

/// Cameras made up from --eye, --orbit or the model: level, and on the orbit around, as those beside the
/// model, or by what the model itself tells (scene/ground.h), which the list then knows; says which.
CameraList made_up_cameras(const SceneOptions& scene, const CameraOptions& camera, Known known,
                           const Model& model);

/// --near, or what suits the cameras of a file, or those made up for the model; world units.
double near_plane_of(const CameraOptions& camera, const CameraList& list);

/// A model and the cameras that it is seen from.
struct OpenScene {
  Model model;
  CameraList list;
  double near_plane = 0.0;  // world units
};

/// Those listed for the scene, or made up for its model. What is listed goes to `check` before the model is
/// read.
OpenScene open_scene(const SceneOptions& scene, const CameraOptions& camera, const RigOptions& rig,
                     const std::function<void(const CameraList&)>& check = {});

/// What there is of a rig. `near_plane` in world units.
stereo::RigSettings rig_settings(const RigOptions& rig, const Known& known, double near_plane = near_default);

/// Brings the screen of eyes that look infinitely far to so many metres. Not of eyes that the cameras give.
void converge(Shot& shot, double metres);

/// stem_of() a name, or with a number where that is taken; takes it.
std::string free_stem(const std::string& name, std::set<std::string>& taken);

/// What a frame draws of a shot.
std::vector<shared::View> views_of(const Shot& shot);

/// Its cameras in the model's frame.
std::vector<Camera> eyes_in_axes(const Shot& shot, const ModelAxes& axes);

/// As --view: all that a list has.
inline const std::vector<std::string> all_views = {"all"};

/// The views of that name, for commands that take all where none is named.
inline const std::vector<std::string>& views_or_all(const std::vector<std::string>& views) {
  return views.empty() ? all_views : views;
}

/// The names that texts of --view stand for: a text that is a view's name, or else its parts between commas.
std::vector<std::string> view_names(const std::vector<std::string>& texts, const CameraList& list);

/// Throws Error for a view that a list in a file does not have, as make_shots() does, but before the model is
/// read.
void check_views(const std::vector<std::string>& views, bool mono, const CameraList& list);

/// The cameras of the views by name, or all where none is named, as they are drawn without a rig. Throws
/// Error for a view that is not there; it names `option` and some that are.
std::vector<Camera> chosen_cameras(const std::vector<std::string>& views, const Lens& lens,
                                   const CameraList& list, const char* option = "--view");

/// The shots of the views by name: NAME, all_views, or none for the first. Of a path and of cameras that are
/// made up, all. `near_plane` in world units, `axes` those of the model. Throws as chosen_cameras() does.
std::vector<Shot> make_shots(const std::vector<std::string>& views, const Lens& lens, const RigOptions& rig,
                             const CameraList& list, double near_plane, const ModelAxes& axes);

}  // namespace binosplat::app
