#pragma once
// Splits views into training, validation and test views, for trim and refit.

#include <functional>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/photos.h"
#include "app/shots.h"
#include "lab/calibrate.h"

namespace binosplat::app {

/// The cameras of the scene's pictures. Throws Error, with the command's name, if there are none or if a
/// photo has another size.
CameraList needed_cameras(const std::string& command, const Options& options);

/// The largest allowed number of validation views, by the numbers of candidates and of all cameras.
using MostValidation = std::function<std::size_t(std::size_t candidates, std::size_t cameras)>;

/// Validates by the named views, or else by views that are evenly spread over the candidates: at least one,
/// at most `most`. Photos limit the candidates to views with a photo. Named test
/// views are test views; all others are training views. Throws Error for unknown and repeated names.
lab::ViewSplit split_views(const std::string& command, const Options& options, const PhotoSource& photos,
                           const CameraList& list, const MostValidation& most);

/// If --size makes views smaller, adds the validation and test views in the cameras' own size and logs it. A
/// bound that holds in small pictures may fail in large ones.
void add_own_size(const Options& options, const CameraList& list, lab::ViewSplit& views);

}  // namespace binosplat::app
