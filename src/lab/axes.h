#pragma once
// The axes of a measurement: its settings, and the views to measure them on. A JSON file, or a preset
// (src/lab/presets):
//
//   {"views": 4, "frames": 30, "repeats": 3, "eyes": [1], "sizes": ["own"], "along": ["views"],
//    "settings": [{"tiles": ["obb", "ellipse"]}, {"th": "squared", "tolerance": [0.05, 0.1]}]}
//
// Each key of a block of settings (`keys` in axes.cpp) has a value or a list of values. Every combination is
// measured; duplicates are dropped.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/settings.h"

namespace binosplat::lab {

struct Axes {
  std::string name;             // the preset's or the file's
  int views = 4;                // number of the scene's cameras, spread evenly
  int training = 0;             // above 0: measures held-out views, and trains on this many others
  int frames = 30;              // timed, per view and repeat; of a motion's stretch the moving ones
  int repeats = 3;              // their spread is the noise
  bool perception = true;       // also SSIM and FLIP, the slowest part on a GPU
  bool contributions = false;   // also measures single Gaussians (contributions.h)
  std::vector<int> eyes = {1};  // 1: the camera itself; 2: a pair around it
  std::vector<std::string> sizes = {"own"};    // own: the camera's; WxH px; preview or headset (stereo/rig.h)
  std::vector<std::string> along = {"views"};  // or a motion of along_choices(), or "turn"
  std::vector<BenchSettings> settings;         // without duplicates, in the file's order
};

/// The values of `along`: "views", "turn" (the head turns at one place), "still", the motions of a head
/// (scene/tour.h), and "sideways" (measures popping).
std::vector<std::string> along_choices();

/// Whether a text is a valid size.
bool is_size(const std::string& text);

/// The preset of this name (src/lab/presets), else the file. Throws Error, naming file, block and key, for
/// anything else than described above.
Axes load_axes(const std::string& preset_or_file);

/// Parses the text of such a file; `name` is for errors.
Axes parse_axes(const std::string& name, const std::string& text);

/// The names of the presets.
std::vector<std::string> axes_presets();

nlohmann::ordered_json to_json(const Axes& axes);

}  // namespace binosplat::lab
