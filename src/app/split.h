#pragma once
// Views of three tasks, for the commands that learn from pictures.

#include <functional>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "app/photos.h"
#include "app/shots.h"
#include "lab/calibrate.h"

namespace binosplat::app {

struct SplitOptions {
  int held_back = 0;                     // views, at most
  std::vector<std::string> judges = {};  // views by name, instead
  std::vector<std::string> tests = {};   // views by name
};

/// Adds --cameras, --views, --held-back, --test, --size, --lod and --axes; both options must outlive the
/// parsing.
void add_split_options(CLI::App& sub, MeasuredOptions& measured, SplitOptions& split, const char* views_help);

/// The cameras that pictures of the scene are of. Throws Error, which names the command, where there are
/// none, or where their photos differ from them in size.
CameraList needed_cameras(const std::string& command, const MeasuredOptions& options);

/// How many views are held back at most, of so many that can be and so many cameras.
using MostHeldBack = std::function<std::size_t(std::size_t can_judge, std::size_t cameras)>;

/// Held back are those that are named, or as many as were asked for and `most` allows, one at least, evenly
/// spread among those that have a photo where there are photos; the rest is for training. The test views are
/// neither. Throws Error for views that are not there or have two tasks.
lab::ViewSplit split_views(const std::string& command, const MeasuredOptions& options,
                           const PhotoSource& photos, const SplitOptions& split, const CameraList& list,
                           const MostHeldBack& most);

/// Where --size makes the views smaller than their cameras are: those held back and of test in the cameras'
/// own size as well, and says so. A bound that holds in a small picture may not hold in the large one.
void add_own_size(const MeasuredOptions& options, const CameraList& list, lab::ViewSplit& views);

}  // namespace binosplat::app
