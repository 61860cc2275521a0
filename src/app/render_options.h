#pragma once
// The options of `binosplat render`, as far as they can be checked by themselves.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "formats/detail.h"
#include "formats/pose_file.h"
#include "scene/tour.h"
#include "shared/limits.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace binosplat::app {

/// In the place of a folder: the photos that lie beside the cameras.
constexpr const char* photos_beside = "beside";

struct RenderOptions {
  std::string scene;  // a model file, or one that the program makes

  std::optional<int> lod;            // of a model file that has levels of detail
  std::optional<double> gpu_memory;  // MB, which levels are chosen to fit; instead of lod
  std::optional<double> detail;      // px, by which levels are chosen for each view anew
  bool detail_report = false;
  std::optional<DetailBudget> budget;  // what it comes to, once the views are known
  std::string axes;                    // where a model file's x, y and z point; empty: what its format says
  std::optional<std::size_t> appearance;  // of a Scaffold-GS model

  // Of scenes that the program makes, and how often a scene is repeated.
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> count;  // Gaussians
  std::optional<glm::ivec2> repeat;  // along x and z
  std::optional<double> spacing;     // world units

  std::optional<bool> antialias;     // as the model was trained; by default what its file says
  std::optional<double> kernel_px2;  // px^2, likewise

  // Cameras.
  std::string cameras;             // a file; empty: found beside the model
  std::string path;                // a file whose cameras are the frames of a path, instead
  std::optional<Motion> tour;      // through the cameras, as a path
  std::optional<double> seconds;   // of the tour; none: all
  std::vector<std::string> views;  // names, or "all"; empty: the first
  std::optional<glm::dvec3> eye, at, up;
  std::optional<double> fov;  // degrees
  std::optional<int> orbit;
  std::optional<glm::ivec2> size;  // px
  std::string preset;
  std::optional<double> near_plane;  // world units

  // The rig.
  bool mono = false;
  std::string only;
  std::optional<double> ipd;          // m
  std::optional<double> convergence;  // m
  std::optional<double> cant;         // degrees
  std::optional<double> units_per_metre;

  /// What `binosplat view` saved beside the model (find_saved): goes for what nothing above says.
  std::optional<SavedPose> saved;

  // The frame and where it is drawn.
  std::string tiles = "ellipse";
  std::string th;             // empty: tau, or squared with a loss
  std::optional<float> loss;  // K or kappa
  std::string transmittance = "one";
  std::optional<float> quality;  // dB
  std::string calibration;       // a file of binosplat calibrate
  std::string decode;            // of a Scaffold-GS model; empty: eyes
  std::string tile = "auto";     // px
  std::string precision = "full";
  std::string reference_until;
  std::string backend = "auto";
  int device = -1;
  std::string shader_dir;
  int frames = 1;

  // Outputs.
  std::string output;
  std::string layout;  // empty: by what -o names
  std::string show = "picture";
  std::optional<double> fps;  // of a tour, or of a video; none: by the path's times
  Background background = glm::vec3(0.0f);
  std::optional<int> bits;
  std::string exr;
  std::string exr_encoding;
  std::string photos;
  std::string json;
};

/// Adds all of them to the sub-command; `options` must outlive the parsing. Values that cannot be understood
/// end it with CLI::ParseError or Error.
void add_options(CLI::App& sub, RenderOptions& options);

/// "1280x720" as width and height in px. Throws Error, naming the option, for anything else.
glm::ivec2 parse_size(const std::string& option, const std::string& text);

/// Adds --axes, which other sub-commands take, too.
CLI::Option* add_axes_option(CLI::App& sub, RenderOptions& options);

/// Adds those of scene and context that the sub-commands which measure share: --near, --count, --seed,
/// --backend and --device.
void add_measured_options(CLI::App& sub, RenderOptions& options);

/// Adds those that the preview takes, some of which check_view() of app/viewer refuses.
void add_view_options(CLI::App& sub, RenderOptions& options);

/// What --th is: squared where only a loss, a quality or a calibration is given, which costs less at equal
/// error than the paper's rule (docs/method.md 8).
std::string threshold_name(const RenderOptions& options);

/// What --units-per-metre is: as given, as saved, or 1.
double units_per_metre(const RenderOptions& options);

/// Whether the views are the frames of one path, each drawn once and by what the last one measured.
bool along_path(const RenderOptions& options);

/// Throws Error for options that contradict each other.
void check(const RenderOptions& options);

}  // namespace binosplat::app
