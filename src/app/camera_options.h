#pragma once
// From where a scene is seen.

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "scene/camera.h"
#include "scene/tour.h"

namespace binosplat::app {

/// What pictures have in the place of their cameras' own size and lens.
struct Lens {
  std::string preset;              // of stereo::apply_preset; empty: the camera's own
  std::optional<glm::ivec2> size;  // px

  bool headset() const { return preset == "headset"; }
  bool vr180() const { return preset == "vr180"; }  // by --vr180
};

struct CameraOptions {
  std::string file;                // that lists cameras; empty: found beside the model
  std::string path;                // a file of keys to go through, or of a path's frames, instead
  bool keys = false;               // of the path: pictures of its keys alone
  std::optional<Motion> tour;      // through the cameras, as a path
  std::optional<double> seconds;   // of the tour, all where none; or from the first key to the last
  std::vector<std::string> views;  // names, or "all"; empty: what the command draws of itself
  std::optional<glm::dvec3> eye, at, up;
  std::optional<double> fov;  // degrees
  std::optional<int> orbit;
  Lens lens;
  std::optional<double> near_plane;  // world units

  /// Whether the cameras are made up instead of looked for.
  bool made_up() const { return eye || orbit; }
  /// Whether the views are the frames of one path, each drawn once and by what the last one measured.
  bool along_path() const { return tour || !path.empty(); }
};

/// Adds all but those of tours and keys (app/tour.h); `options` must outlive the parsing.
void add_camera_options(CLI::App& sub, CameraOptions& options);

// One of them, for commands that take few.
CLI::Option* add_size_option(CLI::App& sub, Lens& lens,
                             const char* help = "Pixels of a view, instead of the cameras' own");
CLI::Option* add_preset_option(CLI::App& sub, Lens& lens, const char* help);
CLI::Option* add_near_option(CLI::App& sub, CameraOptions& options,
                             const char* help = "Nothing nearer is drawn, in world units (0.2)");

/// A camera with the size and lens that are asked for.
Camera sized(const Lens& lens, const Camera& camera);

}  // namespace binosplat::app
