#pragma once
// Splits views into training, validation and test views, for trim and refit.

#include <functional>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "app/photos.h"
#include "app/shots.h"
#include "lab/calibrate.h"

namespace binosplat::app {

struct SplitOptions {
  int validation_count = 0;                  // at most this many views
  std::vector<std::string> validation = {};  // views by name, which replace `validation_count`
  std::vector<std::string> tests = {};       // views by name
};

/// Adds --cameras, --views, --validation, --test, --size, --lod and --axes; `measured` and `split` must
/// outlive parsing.
void add_split_options(CLI::App& sub, MeasuredOptions& measured, SplitOptions& split, const char* views_help);

/// The cameras of the scene's pictures. Throws Error, with the command's name, if there are none or if a
/// photo has another size.
CameraList needed_cameras(const std::string& command, const MeasuredOptions& options);

/// The largest allowed number of validation views, by the numbers of candidates and of all cameras.
using MostValidation = std::function<std::size_t(std::size_t candidates, std::size_t cameras)>;

/// Validates by the named views, or else by views that are evenly spread over the candidates: at least one,
/// at most `split.validation_count` and `most`. Photos limit the candidates to views with a photo. Named test
/// views are test views; all others are training views. Throws Error for unknown and repeated names.
lab::ViewSplit split_views(const std::string& command, const MeasuredOptions& options,
                           const PhotoSource& photos, const SplitOptions& split, const CameraList& list,
                           const MostValidation& most);

/// If --size makes views smaller, adds the validation and test views in the cameras' own size and logs it. A
/// bound that holds in small pictures may fail in large ones.
void add_own_size(const MeasuredOptions& options, const CameraList& list, lab::ViewSplit& views);

}  // namespace binosplat::app
