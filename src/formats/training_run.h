#pragma once
// How a model was trained, as far as the files say that trainers leave beside their models.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace binosplat {

/// What a run's file says.
struct TrainingRun {
  std::filesystem::path file;
  std::string trainer;               // for people
  std::optional<bool> antialiased;   // trained with the opacity that the low-pass takes away
  std::optional<double> kernel_px2;  // that comes nearest to it, where it had no usual low-pass, px^2
  std::vector<std::pair<std::string, std::string>> said;  // what may matter to pictures, in the file's words
  /// What this program draws otherwise than the training did, what of that is seen, and what to do.
  std::vector<std::string> otherwise;
  std::vector<std::string> advice;  // what to give, or not to give, so that it is drawn as it was trained
};

constexpr const char* exposures_name = "exposure.json";

/// The file `name` that belongs to a model's file: in its folder, or in one of `most` above, the nearest. Up
/// to two above INRIA's point_cloud/iteration_N/, gsplat's ply/ and nerfstudio's exports/splat/ have their
/// run's files.
std::optional<std::filesystem::path> find_above(const std::filesystem::path& model, const std::string& name,
                                                int most = 2);

/// The run of a model's file, of the nearest of gsplat's cfg.yml, nerfstudio's config.yml, INRIA's cfg_args,
/// LichtFeld Studio's training_config.json and 3DGRUT's parsed.yaml (find_above). A file that is called so
/// and is another program's is passed over; so is, with a warning, one that cannot be read: nobody named it.
std::optional<TrainingRun> find_training_run(const std::filesystem::path& model);

}  // namespace binosplat
