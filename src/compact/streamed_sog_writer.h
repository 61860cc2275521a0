#pragma once
// Writes a model as a streamed SOG (formats/models/streamed_sog.h): a tree of chunks at several levels of
// detail.

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/model.h"
#include "stream/level_choice.h"

namespace binosplat {

struct LevelSettings {
  std::size_t chunk = 2048;  // largest number of Gaussians of a chunk at the finest level
  int levels = 8;            // each further level has half as many Gaussians in each chunk, rounded up
  // Largest number of Gaussians of a SOG, or one chunk if that has more. Readers decode whole SOGs.
  std::size_t file = 131072;
  std::size_t batch = 1048576;            // level-0 Gaussians processed at a time; no SOG spans two batches
  std::size_t joint_gaussians = 5242880;  // about the largest number of level-0 Gaussians of a joint scene
};

/// The errors of a chunk's levels (stream/level_choice.h). The innermost lists have a number for each pixel
/// width.
struct LevelErrors {
  std::vector<double> pixels;             // pixel widths, world units, ascending
  std::vector<std::vector<double>> seen;  // visible area of the finest level, px, by direction
  std::vector<std::vector<std::vector<double>>> of_level;  // px times squared colour, by level and direction
};

/// The squared error of a picture of many chunks: predicted by the chunks' own errors, and measured.
struct JointLoss {
  double predicted = 0.0, measured = 0.0;
  bool drawn = true;  // false: memory was short
};

/// Measures errors of chunks. `levels_of_chunks` has each chunk's levels, finest first, read from the files.
struct MeasureLevels {
  /// Returns the errors of each chunk drawn alone (compact/level_errors.h).
  std::function<std::vector<LevelErrors>(std::span<const std::vector<Model>> levels_of_chunks)> alone;
  /// Returns the errors of at most `pictures` pictures of all chunks (compact/joint_loss.h).
  std::function<std::vector<JointLoss>(std::span<const std::vector<Model>> levels_of_chunks,
                                       std::span<const LevelErrors> errors, int pictures)>
      joint;
};

/// The folder of the streamed SOG; names are relative to it. Several threads may call its functions at once.
struct LevelFolder {
  /// Returns whether the folder has a complete file. A meta.json also needs all files that it names.
  std::function<bool(const std::string& name)> has;
  std::function<std::string(const std::string& name)> read;
  std::function<void(const std::string& name, std::span<const std::byte> bytes)> write;
};

struct LevelsWritten {
  std::vector<std::size_t> gaussians;  // by level
  std::size_t files = 0, kept = 0;     // all SOGs; those that the folder had before
  std::vector<std::string> losses;     // properties of the model that SOGs lose, one line each
};

/// Writes a model that has SOG's axes. Level 0 is the model. The other levels are merged from level 0
/// (scene/merge.h), for pixels a fifth as wide as the spacing by which levels are chosen
/// (stream/level_choice.h). A SOG has one level of neighbouring chunks. Shows progress.
///
/// An interrupted run can be continued with the same model and settings. A SOG's meta.json is written after
/// its pictures, and lod-meta.json last, so SOGs with a meta.json are kept. The result has the same bytes as
/// an uninterrupted run, if memory suffices for the same pictures of many chunks.
///
/// The errors of levels are kept beside the SOGs, in errors_0.json, joint_0.json and so on. lod-meta.json
/// gets them, too: "pixels" and "seen" of each chunk, and "errors" of each of its lods. In lod-meta.json,
/// errors are scaled by the median ratio of measured to predicted loss in pictures of many chunks.
LevelsWritten write_streamed_sog(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
                                 const MeasureLevels& measure);

}  // namespace binosplat
