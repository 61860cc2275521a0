#pragma once
// The entrance for model files: what a file is, is decided by its content, never by its name.

#include <binosplat/model.h>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/training_run.h"
#include "scene/model.h"

namespace binosplat {

/// The models that a folder stands for, best one: lod-meta.json or meta.json of a SOG, by what is in it;
/// point_cloud.ply, also in point_cloud/ or the latest point_cloud/iteration_N/ (INRIA, Scaffold-GS); the
/// latest ply/point_cloud_N.ply (gsplat); all files in it that are called as models are, by their numbers,
/// without meshes and points among them; exports/splat/splat.ply (nerfstudio).
std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// The file itself, or the model that a folder stands for. Throws Error for a folder with none or several.
std::filesystem::path file_of(const std::filesystem::path& path);

/// Reads a trained model of any format of the registry (formats/registry.h). `path` may be a folder with one
/// of models_in(). Says on standard error how many Gaussians were left out because a value is not finite or
/// the quaternion is zero. Throws Error for anything that is not such a model; the text says what the file
/// looks like instead. Whether a model was trained with anti-aliasing its file says, or else the run beside
/// it (run_of). Warns of what the run did and is not drawn.
Model load_model(const std::filesystem::path& path, const ModelOptions& options = {});

/// The same by the model's file alone, whatever lies beside it: for files that binosplat has just written.
Model load_model_alone(const std::filesystem::path& path, const ModelOptions& options = {});

/// The training that a model's file comes from, if its files are there (formats/training_run.h).
std::optional<TrainingRun> run_of(const std::filesystem::path& file);

/// Takes from a run what the model's own file does not say; warns where the two contradict each other.
void follow(const TrainingRun& run, const std::filesystem::path& file, Model& model);

/// The exposure.json of that training (formats/exposures.h), for a model's file or a folder with one.
std::optional<std::filesystem::path> find_exposures(const std::filesystem::path& path);

}  // namespace binosplat
