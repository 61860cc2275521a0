#pragma once
// What is measured: which settings, on what. A JSON file, or a preset (src/lab/presets):
//
//   {"views": 4, "frames": 30, "repeats": 3, "eyes": [1], "sizes": ["own"], "along": ["views"],
//    "settings": [{"tiles": ["obb", "ellipse"]}, {"th": "squared", "tolerance": [0.05, 0.1]}]}
//
// Each key of a block of settings (`keys` in axes.cpp) is a value or a list of them; every combination is
// measured, and what repeats is left out.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/settings.h"

namespace binosplat::lab {

struct Axes {
  std::string name;             // the preset's or the file's
  int views = 4;                // of the scene's cameras, spread evenly
  int training = 0;             // above 0: the views are of those held out, and so many others train
  int frames = 30;              // timed, a view and repeat; of a motion's stretch those that move
  int repeats = 3;              // whose spread is the noise
  bool perception = true;       // SSIM and FLIP, too, which take longest on a GPU
  bool contributions = false;   // what single Gaussians contribute, too (contributions.h)
  std::vector<int> eyes = {1};  // 1: the camera itself; 2: a pair around it
  std::vector<std::string> sizes = {"own"};    // own: the camera's; WxH px; preview or headset (stereo/rig.h)
  std::vector<std::string> along = {"views"};  // or a motion of along_choices(), or "turn"
  std::vector<BenchSettings> settings;         // without repetition, in the file's order
};

/// What is measured along: "views", "turn" (of the head, at one place), "still", the motions of a head
/// (scene/tour.h), and "sideways", as popping is measured.
std::vector<std::string> along_choices();

/// Whether a text is one of the sizes.
bool is_size(const std::string& text);

/// The preset of this name (src/lab/presets), else the file. Throws Error naming the file, the block
/// and the key for anything that is not as above.
Axes load_axes(const std::string& preset_or_file);

/// From the text of such a file; `name` is for errors.
Axes parse_axes(const std::string& name, const std::string& text);

/// The names of the presets.
std::vector<std::string> axes_presets();

nlohmann::ordered_json to_json(const Axes& axes);

}  // namespace binosplat::lab
