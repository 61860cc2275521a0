#pragma once
// The entry point for model files: their content, or ModelOptions, decides the format.

#include <binosplat/model.h>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/training/training_run.h"
#include "scene/model.h"

namespace binosplat {

/// Returns the models in a folder. Each line applies only if all lines before it find nothing:
/// - lod-meta.json or meta.json with a SOG's content;
/// - point_cloud.ply, also in point_cloud/ or the latest point_cloud/iteration_N/ (INRIA, Scaffold-GS);
/// - the latest ply/point_cloud_N.ply (gsplat);
/// - all files with a model's ending, sorted by name, numbers by value; meshes and point clouds only
///   if there is nothing else;
/// - exports/splat/splat.ply (nerfstudio), or a lod-meta.json or meta.json of other content.
std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// Returns the file itself, or the only model in a folder. Throws Error for a folder with none or several.
std::filesystem::path file_of(const std::filesystem::path& path);

/// Reads a trained model of any format of the registry (formats/models/registry.h). `path` is a file, or a
/// folder with one model (models_in). Warns how many Gaussians were dropped for invalid values. The model's
/// file determines anti-aliasing; if the file does not, the training run does (run_of). Warns of features of
/// the run that are not drawn. If the file is no model, throws Error and names the file's apparent format.
Model load_model(const std::filesystem::path& path, const ModelOptions& options = {});

/// Reads a model from its file only, without the training run: for files that binosplat has just written.
Model load_model_alone(const std::filesystem::path& path, const ModelOptions& options = {});

/// Returns the training run of a model from `file`, if its files exist (formats/training/training_run.h).
std::optional<TrainingRun> run_of(const Model& model, const std::filesystem::path& file);

/// Takes what the model's file does not say from the training run. Warns if file and run disagree.
void follow(const TrainingRun& run, const std::filesystem::path& file, Model& model);

/// Returns the exposure.json (formats/training/exposures.h) of a model's training. `path` is its file or
/// folder.
std::optional<std::filesystem::path> find_exposures(const std::filesystem::path& path);

}  // namespace binosplat
