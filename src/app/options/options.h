#pragma once
// What a command line asks for. table.cpp says which option sets which member, and which commands take it.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adagscale/calibration.h"
#include "app/options/drawing.h"
#include "base/image.h"
#include "formats/models/model_output.h"
#include "formats/pictures/exr.h"
#include "gl/context.h"
#include "measure/flip.h"
#include "measure/foveated.h"
#include "scene/framing.h"
#include "scene/tour.h"
#include "shared/choices.h"
#include "stereo/foveate.h"
#include "stream/level_choice.h"

namespace binosplat::app {

/// Whether the name has the form of a built-in scene's name. The scene need not exist.
inline bool is_built_in(const std::string& scene) { return scene.starts_with("demo:"); }

/// The scene, and how its file is read.
struct SceneOptions {
  std::string name;  // a model file or a built-in scene

  std::optional<int> lod;                 // level to read, of files with levels of detail
  std::optional<double> gpu_memory;       // MB that chosen levels must fit into; replaces lod
  std::optional<DetailRequest> detail;    // chooses levels for each view; its `most` is unset
  std::string format;                     // reads a file as this format; empty: as its content says
  std::string axes;                       // directions of a file's x, y and z; empty: the format's
  std::optional<std::size_t> appearance;  // index of an appearance, for a Scaffold-GS model

  // For built-in scenes and for repeated scenes.
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> count;  // Gaussians
  std::optional<glm::ivec2> repeat;  // numbers of copies along x and z
  std::optional<double> spacing;     // distance between copies, world units
  std::string place;                 // a list of other models and their places (placed.h); empty: none

  std::optional<bool> antialias;     // none: as the file says
  std::optional<double> kernel_px2;  // px^2; none: as the file says
};

/// Size and lens that replace the cameras' own.
struct Lens {
  std::string preset;              // for stereo::apply_preset(); empty: the camera's own size and lens
  std::optional<glm::ivec2> size;  // px

  bool headset() const { return preset == "headset"; }
  bool vr180() const { return preset == "vr180"; }  // set by --vr180
};

struct CameraOptions {
  std::string file;                // a file of cameras; empty: the one beside the model
  std::string path;                // a file of a path's keys or frames, which replaces the cameras
  bool keys = false;               // draws only the keys of the path
  std::optional<Motion> tour;      // a path through the cameras
  std::optional<double> seconds;   // duration of a path through keys, or of a tour's drawn part (none: all)
  std::vector<std::string> views;  // names, or "all"; empty: the command's default
  std::optional<glm::dvec3> eye, at, up;
  std::optional<double> fov;  // degrees
  std::optional<int> orbit;
  std::optional<Viewpoint::Kind> frame;  // what cameras that are made up show; none: what suits the model
  Lens lens;
  std::optional<double> near_plane;  // world units

  /// Whether options place the cameras, so that no file is read.
  bool places_cameras() const { return eye || orbit || frame; }
  /// Whether the views are frames of one path. Each is drawn once and uses the previous frame's measurements.
  bool along_path() const { return tour || !path.empty(); }
};

/// The eyes of each camera.
struct RigOptions {
  bool mono = false;                  // draws the camera itself
  std::optional<std::size_t> only;    // one eye of the pair: 0 left, 1 right
  std::optional<double> ipd;          // m
  std::optional<double> convergence;  // m, or infinite
  std::optional<double> cant;         // degrees
  std::optional<double> units_per_metre;

  bool one_picture() const { return mono || only; }
  /// Whether options set the positions of the eyes.
  bool places_eyes() const { return ipd || convergence || cant; }
};

inline const RigOptions no_rig{.mono = true};

struct ContextOptions {
  gl::Backend backend = gl::Backend::automatic;
  int device = -1;         // number of the EGL device; -1: the first GPU
  std::string shader_dir;  // empty: the embedded shaders
};

/// How pictures look, and their files.
struct PictureOptions {
  std::optional<int> layout;  // LAYOUT_ of shared/choices.h; none: chosen by the output
  int show = SHOW_PICTURE;    // SHOW_
  std::optional<double> fps;  // frame rate of a path or video; none: from the path's times
  Background background = glm::vec3(0.0f);
  std::optional<int> bits;
  std::optional<int> png_level;     // compression level of libdeflate
  std::optional<bool> exr_half;     // if set, also writes OpenEXR: half (true) or float
  std::optional<bool> exr_display;  // OpenEXR has display values instead of linear light
  std::optional<DepthKind> exr_depth;
  std::optional<ExrCompression> exr_compression;

  /// The background for comparisons: black if none.
  glm::vec3 backdrop() const { return background.value_or(glm::vec3(0.0f)); }
};

/// Of `view --xr`.
struct HeadsetOptions {
  bool xr = false;
  double scale = 1.0;               // factor for the sizes that the runtime recommends
  std::optional<double> budget_ms;  // 0: the time that the runtime has for a frame
  std::optional<double> record_s;   // duration to record from the first frame on
  bool passthrough = false;         // shows the room behind the model
  bool mirror = true;               // shows the left eye in a window if there is a display
};

/// The views of a run that are number `index` modulo `count`.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool all() const { return count == 1; }
};

/// The allowed loss: dB lost against photos, or the PSNR against exact pictures.
struct TargetOptions {
  std::optional<double> max_drop, quality;  // dB

  adagscale::CalibrationTarget target() const {
    return max_drop ? adagscale::CalibrationTarget{adagscale::CalibrationTarget::Kind::drop, *max_drop}
                    : adagscale::CalibrationTarget{adagscale::CalibrationTarget::Kind::quality, *quality};
  }
};

/// The uses of views.
struct SplitOptions {
  std::optional<int> count;             // of views to calibrate on, or to validate with
  std::vector<std::string> validation;  // views by name, which replace `count`
  std::vector<std::string> tests;       // views by name
  std::optional<int> test_every;        // every Nth view is a test view
};

struct BenchOptions {
  std::vector<std::string> scenes;
  std::string suite;  // a preset or a file; empty: a preset that fits the options below
  std::vector<std::string> motions;
  std::vector<std::string> details;
  std::optional<int> frames;  // these two replace the suite's values
  std::string size;
};

struct CompareOptions {
  std::string a, b;
  std::optional<double> min_psnr;
  std::string difference;
  std::optional<measure::Gaze> gaze;
  Background background;  // none: compares alpha if both have it
};

struct Options {
  SceneOptions scene;
  CameraOptions camera;
  RigOptions rig;
  DrawingOptions drawing;
  ContextOptions context;
  PictureOptions picture;
  HeadsetOptions headset;
  std::string output;                // a folder or a file; empty: the command's default
  std::string json;                  // a file for everything printed; empty: none
  std::string photos;                // a folder, or photos_beside; empty: none
  std::string exposure;              // a file, or no_exposure; empty: the one beside the model
  Shard shard;                       // which of the views this run draws
  bool resume = false;               // skips views that an earlier run of the same options drew
  std::optional<double> max_memory;  // MB

  // Commands that measure.
  TargetOptions target;
  SplitOptions split;
  std::vector<std::string> rules;  // THRESHOLD or THRESHOLD,SOURCE; empty: the command's default
  BenchOptions bench;
  CompareOptions compare;
  double ppd = measure::flip_pixels_per_degree;
  std::string older_results;             // results.json of an older run
  std::optional<double> fail_if_slower;  // percent
  bool asks_clock = true;
  int table_bins = 20;             // of the table by depth
  std::optional<float> table_far;  // end of its last bin, world units; none: fits the scene

  // Commands that write models.
  std::optional<ModelFormat> to;     // none: chosen by the output's ending
  std::optional<int> harmonic_bits;  // none: 8
  std::optional<int> levels;         // none: LevelSettings' numbers
  std::optional<std::size_t> chunk;
  bool refit = false;          // trim: fits the colours of every candidate
  bool against_exact = false;  // refit: fits to the model's own pictures
  std::optional<int> rounds;   // none: compact::RefitSettings' number

  bool list_views = false;         // info: lists views by name
  std::vector<std::string> given;  // options_given(), for resumed runs
};

/// Value of --photos for the folder of photos beside the cameras.
constexpr const char* photos_beside = "beside";
/// Value of --exposure for pictures without exposures.
constexpr const char* no_exposure = "none";

}  // namespace binosplat::app
