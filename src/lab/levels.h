#pragma once
// What levels of detail lose against the finest, and the time that they take.

#include <cstddef>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/frame.h"

namespace binosplat::lab {

/// What is seen: one picture, or both eyes', left eye first.
struct LevelsShot {
  std::string name;
  std::vector<shared::View> views;
};

/// The levels that a model was brought to.
struct LevelsBrought {
  std::size_t gaussians = 0;
  std::optional<double> predicted_db = {};  // against the finest; none where nothing is predicted
};

/// A model whose levels follow what is drawn.
struct FollowingModel {
  double detail = 0.0;  // that is asked for, dB or px
  std::shared_ptr<render::GpuModel> model;
  /// Brings it to the levels that these views need.
  std::function<LevelsBrought(std::span<const shared::View> views)> bring;
};

/// What a shot, or some in the mean, come to. What is against the finest levels is none where these were not
/// drawn, and for themselves.
struct LevelsNumbers {
  double gaussians = 0.0;
  std::optional<double> predicted_db = {};
  std::optional<double> psnr_db = {};          // of all eyes; infinite for equal pictures
  std::optional<double> flip = {};             // mean over the eyes
  std::optional<double> disagreement_db = {};  // stereo/disagreement.h; none for one eye
  double frame_ms = 0.0;                       // GPU time
};

/// All shots of a scene at one detail.
struct LevelsRow {
  std::optional<double> detail = {};  // none: the finest levels
  std::vector<LevelsNumbers> shots;   // as they are asked for; of the finest only those that were drawn
};

/// The mean over the shots; dB by their squared errors in the mean, as if all were one picture.
LevelsNumbers mean_of(const LevelsRow& row);
/// The least PSNR of a shot.
std::optional<double> worst_db(const LevelsRow& row);

struct LevelsScene {
  std::string name;
  std::size_t finest = 0;          // Gaussians at the finest levels
  std::vector<std::string> shots;  // their names
  std::size_t eyes = 0;
  std::uint32_t width = 0, height = 0;  // px, of an eye's picture
  std::string problem = {};             // why the finest levels were not drawn; empty: they were
  std::vector<LevelsRow> rows = {};     // in the order of the models; then the finest, if they were drawn
};

struct LevelsStudy {
  std::string device;
  bool in_db = true;  // what is asked for; else px
  int frames = 0;     // timed of each shot in each of turn_rounds
  std::vector<LevelsScene> scenes = {};
};

/// Draws each shot with each of the models and, if there is room for them, with the finest levels, compares,
/// and times all in turns. There is at least one of each, and all models are in one context. `load_finest`
/// is called once. `progress` is called after each shot.
void measure_levels(LevelsScene& scene, std::span<const LevelsShot> shots,
                    std::span<const FollowingModel> models, const std::function<Model()>& load_finest,
                    int frames, const std::function<void()>& progress);

nlohmann::ordered_json to_json(const LevelsStudy& study);

}  // namespace binosplat::lab
