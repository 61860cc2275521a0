#pragma once
// How a model was trained, from files that trainers write beside their models.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace binosplat {

struct TrainingRun {
  std::filesystem::path file;
  std::string trainer;               // for display
  std::optional<bool> antialiased;   // trained with opacity compensated for the low-pass
  std::optional<double> kernel_px2;  // px^2; only if training's low-pass cannot be drawn: the nearest
  std::vector<std::pair<std::string, std::string>>
      settings;  // settings that may affect pictures, as in the file
  /// Differences between the training's rendering and this program's: their effect, and a remedy.
  std::vector<std::string> differences;
  std::vector<std::string> advice;  // hints for drawing the model as it was trained
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
