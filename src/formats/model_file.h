#pragma once
// The entry point for model files: their content decides the format, never their name.

#include <binosplat/model.h>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/training_run.h"
#include "scene/model.h"

namespace binosplat {

/// Returns the models in a folder; the first match of this list: lod-meta.json or meta.json with a SOG's
/// content; point_cloud.ply, also in point_cloud/ or the latest point_cloud/iteration_N/ (INRIA,
/// Scaffold-GS); the latest ply/point_cloud_N.ply (gsplat); all files with a model's ending, sorted by their
/// numbers, without meshes and point clouds; exports/splat/splat.ply (nerfstudio).
std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// Returns the file itself, or the only model in a folder. Throws Error for a folder with none or several.
std::filesystem::path file_of(const std::filesystem::path& path);

/// Reads a trained model of any format of the registry (formats/registry.h), or the only one of models_in() a
/// folder. Logs how many Gaussians were dropped for values that are not finite or a zero quaternion. The
/// model's file determines anti-aliasing; if it does not, the training run beside it does (run_of). Warns of
/// features of the run that are not drawn. Throws Error for other files; the text names the file's apparent
/// format.
Model load_model(const std::filesystem::path& path, const ModelOptions& options = {});

/// The same from the model's file only, whatever lies beside it: for files that binosplat has just written.
Model load_model_alone(const std::filesystem::path& path, const ModelOptions& options = {});

/// Returns the training run of a model's file, if its files exist (formats/training_run.h).
std::optional<TrainingRun> run_of(const std::filesystem::path& file);

/// Sets properties from a run that the model's file lacks; warns if the two contradict each other.
void follow(const TrainingRun& run, const std::filesystem::path& file, Model& model);

/// Returns the exposure.json of that training (formats/exposures.h), for a model's file or its folder.
std::optional<std::filesystem::path> find_exposures(const std::filesystem::path& path);

}  // namespace binosplat
