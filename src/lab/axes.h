#pragma once
// What bench measures, as data: a small JSON file, or one of the presets that come with the program
// (src/lab/presets).
//
//   {"views": 4, "frames": 30, "repeats": 3, "eyes": [1, 2], "sizes": ["own", "1280x720", "headset"],
//    "settings": [{"tiles": ["aabb", "ellipse"]},
//                 {"th": "squared", "transmittance": ["one", "last"], "tolerance": [0.1, 0.2]},
//                 {"inset": 20, "context": [0.3, 0.4]}]}
//
// Every combination of eyes, sizes and each block's lists is measured; a single value stands for a list of
// one. Blocks have tiles (ellipse), tile (16), th (tau), precision (full), transmittance (one) and tolerance;
// and, for foveated pictures, inset, degrees, and context (0.4), a share of the pixels along an axis. What is
// left out is as in brackets, views 4, frames 30, repeats 3, eyes 1, sizes own.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/settings.h"

namespace binosplat::lab {

struct Axes {
  std::string name;                     // the preset's or the file's
  int views = 4;                        // of the scene's cameras, spread evenly
  int frames = 30;                      // timed, a view and repeat
  int repeats = 3;                      // whose spread is the noise
  std::vector<int> eyes = {1};          // 1: the camera itself; 2: a pair around it
  std::vector<std::string> sizes;       // own: the camera's; WxH px; preview or headset (stereo/rig.h)
  std::vector<BenchSettings> settings;  // without repetition, in the file's order
};

/// The preset of this name (src/lab/presets), else the file. Throws Error naming the file, the block
/// and the key for anything that is not as above.
Axes load_axes(const std::string& preset_or_file);

/// From the text of such a file; `name` is for errors.
Axes parse_axes(const std::string& name, const std::string& text);

/// The names of the presets.
std::vector<std::string> axes_presets();

nlohmann::ordered_json to_json(const Axes& axes);

}  // namespace binosplat::lab
