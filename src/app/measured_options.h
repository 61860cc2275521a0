#pragma once
// What the commands that measure a scene share: which it is, its cameras, and where it is drawn.

#include <string>

#include "app/camera_options.h"
#include "app/context_options.h"
#include "app/scene_options.h"

namespace binosplat::app {

struct MeasuredOptions {
  SceneOptions scene;
  CameraOptions camera;
  ContextOptions context;
  std::string photos;    // a folder; empty: none
  std::string exposure;  // a file, or no_exposure; empty: the one beside the model
};

/// Adds --near, --count, --seed, --backend and --device; `options` must outlive the parsing.
void add_measured_options(CLI::App& sub, MeasuredOptions& options);

}  // namespace binosplat::app
