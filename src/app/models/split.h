#pragma once
// Opens a scene for trim and refit, and splits its views into training, validation and test views.

#include <functional>
#include <memory>
#include <string>

#include "adagscale/calibrate.h"
#include "app/bench/photos.h"
#include "app/options/options.h"
#include "app/render/shots.h"
#include "formats/models/model_output.h"
#include "gl/context.h"
#include "scene/model.h"

namespace binosplat::app {

/// The largest allowed number of validation views, by the numbers of candidates and of all cameras.
using ValidationLimit = std::function<std::size_t(std::size_t candidates, std::size_t cameras)>;

/// A model in an output format's axes, with the views that it sees.
struct SplitScene {
  PhotoSource photos;
  Model model = {};
  compact::ViewSplit views = {};
  std::unique_ptr<gl::Context> context = {};
};

/// Opens the scene, and splits its cameras. Validates by the named views, or else by views that are evenly
/// spread over the candidates: at least one, at most `limit`. Photos limit the candidates to views with a
/// photo. Named test views are test views; all others are training views. If --size makes views smaller, adds
/// validation and test views in the cameras' own size, because a bound that holds in small pictures may fail
/// in large ones. Throws Error, with the command's name, if there are no cameras, for a photo of another
/// size, for unknown and repeated names, and as remove_empty_views() does.
SplitScene open_split(const std::string& command, const Options& options, ModelFormat format,
                      const ValidationLimit& limit);

}  // namespace binosplat::app
