#pragma once
// What the commands that measure a scene share: which it is, its cameras, and where it is drawn.

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

/// Adds --rule.
void add_rule_option(CLI::App& sub, std::vector<std::string>& rules);
/// What it names. Throws Error for what is no rule.
std::vector<lab::Rule> rules_of(const std::vector<std::string>& texts);

/// Adds --near, --count, --seed, --backend and --device; `options` must outlive the parsing.
void add_measured_options(CLI::App& sub, MeasuredOptions& options);

}  // namespace binosplat::app
