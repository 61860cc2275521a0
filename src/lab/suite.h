#pragma once
// The suite of a measurement: settings to measure, and their views, from JSON or a preset (src/lab/presets):
//
//   {"views": 4, "frames": 30, "repeats": 3, "eyes": [1], "sizes": ["own"], "along": ["views"],
//    "settings": [{"tiles": ["obb", "ellipse"]}, {"threshold": "squared", "tolerance": [0.05, 0.1]}]}
//
// Each key of a block of settings (`keys` in suite.cpp) has a value or a list of values. The
// settings of a block are all combinations of its values. Duplicates are dropped.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/bench_settings.h"

namespace binosplat::lab {

struct Suite {
  std::string name;  // name of the preset or the file
  int views = 4;     // number of measured views, spread evenly over the scene's cameras
  int training = 0;  // above 0: number of training views for tolerances; measured views are then test views
  int frames = 30;   // timed frames per view and repeat, or moving frames per stretch of a motion
  int repeats = 3;   // passes over all frames; the spread of their times is the noise
  bool perception = true;                    // also measures SSIM and FLIP, which take the most time on a GPU
  bool contributions = false;                // also measures single Gaussians (contributions.h)
  std::vector<int> eyes = {1};               // 1: the camera itself; 2: a stereo pair around it
  std::vector<std::string> sizes = {"own"};  // "own" (the camera's), WxH in px, "preview" or "headset"
  std::vector<std::string> along = {"views"};  // values of along_choices()
  std::vector<BenchSettings> settings;         // without duplicates, in the file's order
};

/// The values of `along`: "views", "still" (the head rests), and the motions of a head (scene/tour.h).
std::vector<std::string> along_choices();

bool is_size(const std::string& text);

/// Loads the preset of this name, or else the file. Throws Error, which names file, block and key, for
/// contents that the format above does not allow.
Suite load_suite(const std::string& preset_or_file);

/// Parses the text of a suite file. Errors begin with `name`.
Suite parse_suite(const std::string& name, const std::string& text);
std::vector<std::string> suite_presets();

nlohmann::ordered_json to_json(const Suite& suite);

}  // namespace binosplat::lab
