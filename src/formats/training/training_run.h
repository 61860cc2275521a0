#pragma once
// How a model was trained, from files that trainers write beside their models.

#include <filesystem>
#include <optional>
#include <string>

#include "formats/training/trainer_keys.h"

namespace binosplat {

struct TrainingRun : TrainingSaid {
  std::filesystem::path file;
  std::string trainer;  // for display
};

constexpr const char* exposures_name = "exposure.json";

/// Returns the file `name` in the folder of a model's file, or in the nearest of up to `most` folders above:
/// INRIA's point_cloud/iteration_N/, gsplat's ply/ and nerfstudio's exports/splat/ are below the run's files.
std::optional<std::filesystem::path> find_above(const std::filesystem::path& model, const std::string& name,
                                                int most = 2);

/// Returns the run of a model's file, from the nearest of gsplat's cfg.yml, nerfstudio's config.yml, INRIA's
/// cfg_args, LichtFeld Studio's training_config.json and 3DGRUT's parsed.yaml (find_above). Skips files of
/// these names from other programs. Skips unreadable files with a warning, since the user did not name them.
std::optional<TrainingRun> find_training_run(const std::filesystem::path& model);

}  // namespace binosplat
