#pragma once
// Options of all commands that measure a scene: scene, cameras, context.

#include <string>
#include <vector>

#include "app/camera_options.h"
#include "app/context_options.h"
#include "app/scene_options.h"
#include "lab/rule.h"

namespace binosplat::app {

struct MeasuredOptions {
  SceneOptions scene;
  CameraOptions camera;
  ContextOptions context;
  std::string photos;              // a folder; empty: none
  std::string exposure;            // a file, or no_exposure; empty: the one beside the model
  std::vector<std::string> rules;  // TH,SOURCE; empty: all
  std::vector<std::string> given;  // options_given()
};

void add_rule_option(CLI::App& sub, std::vector<std::string>& rules);
/// The rules of these options, or all. Throws Error for an unknown rule.
std::vector<lab::Rule> rules_of(const std::vector<std::string>& texts);

/// Adds --near, --count, --seed, --backend and --device; `options` must outlive parsing.
void add_measured_options(CLI::App& sub, MeasuredOptions& options);

}  // namespace binosplat::app
