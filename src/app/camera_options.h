#pragma once
// The options that choose cameras.

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "scene/camera.h"
#include "scene/framing.h"
#include "scene/tour.h"

namespace binosplat::app {

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
  std::optional<Outlook::Kind> frame;  // what cameras that are made up show; none: what suits the model
  Lens lens;
  std::optional<double> near_plane;  // world units

  /// Whether options place the cameras, so that no file is read.
  bool made_up() const { return eye || orbit || frame; }
  /// Whether the views are frames of one path. Each is drawn once and uses the previous frame's measurements.
  bool along_path() const { return tour || !path.empty(); }
};

/// Adds all options except those of tours and keys (app/tour.h). `options` must outlive parsing.
void add_camera_options(CLI::App& sub, CameraOptions& options);

// Single options, for commands that take only a few.
CLI::Option* add_size_option(CLI::App& sub, Lens& lens,
                             const char* help = "Pixels of a view, instead of the cameras' own");
CLI::Option* add_preset_option(CLI::App& sub, Lens& lens, const char* help);
CLI::Option* add_near_option(CLI::App& sub, CameraOptions& options,
                             const char* help = "Near plane, in world units (as for `render`)");

Camera sized(const Lens& lens, const Camera& camera);

}  // namespace binosplat::app
