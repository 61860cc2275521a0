#pragma once
// Writes a model as a streamed SOG (formats/streamed_sog.h): a tree of its chunks, each at several levels of
// detail.

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/model.h"
#include "stream/choice.h"

namespace binosplat {

struct LevelSettings {
  std::size_t chunk =
      2048;        // largest number of Gaussians of a chunk (a leaf of the tree) at the finest level
  int levels = 8;  // each halves the Gaussians of each chunk, rounded up
  std::size_t file = 131072;    // Gaussians of a SOG, at most, or one chunk: readers decode whole files
  std::size_t batch = 1048576;  // finest Gaussians processed at a time, at most; no SOG spans two batches
  std::size_t joint_gaussians =
      5242880;  // finest Gaussians in pictures of many chunks, at most, or one batch
};

/// The errors of a chunk's levels (stream/choice.h); the innermost lists have a number for each width of a
/// pixel.
struct LevelErrors {
  std::vector<double> pixels;                              // world units, ascending
  std::vector<std::vector<double>> seen;                   // by direction, px
  std::vector<std::vector<std::vector<double>>> of_level;  // by level and direction, px times squared colour
};

/// The squared error of a picture of many chunks: predicted by the chunks' own errors, and measured.
struct JointLoss {
  double predicted = 0.0, measured = 0.0;
  bool drawn = true;  // false: memory was short
};

/// Measures errors of chunks, given by their levels from the finest on, as read back from the files.
struct MeasureLevels {
  std::function<std::vector<LevelErrors>(std::span<const std::vector<Model>> levels_of_chunks)> alone;
  /// Returns the errors of `pictures` pictures of all chunks, or of fewer (compact/joint_loss.h).
  std::function<std::vector<JointLoss>(std::span<const std::vector<Model>> levels_of_chunks,
                                       std::span<const LevelErrors> errors, int pictures)>
      joint;
};

/// The folder of the streamed SOG; names are relative to it. Several threads may write files at a time.
struct LevelFolder {
  /// Returns whether the folder has a complete file; for a meta.json, also all files that it names.
  std::function<bool(const std::string& name)> has;
  std::function<std::string(const std::string& name)> read;
  std::function<void(const std::string& name, std::span<const std::byte> bytes)> write;
};

struct LevelsWritten {
  std::vector<std::size_t> gaussians;  // by level
  std::size_t files = 0, kept = 0;     // SOGs, and those that were there before
  std::vector<std::string> losses;     // properties that SOGs lose, a line each
};

/// Writes a model in the frame of SOG. Level 0 is the model; the others are merged from it (scene/merge.h),
/// for pixels of a fifth of the spacing by which levels are chosen (stream/choice.h). A SOG has one level of
/// neighbouring chunks. Shows progress.
///
/// An interrupted run can be continued with the same model and settings. A SOG's meta.json is written after
/// its pictures, and lod-meta.json last; SOGs whose meta.json exists are kept. The result has the same bytes,
/// if memory suffices for the same pictures.
///
/// The errors of levels are kept beside the SOGs, in errors_0.json, joint_0.json and so on. lod-meta.json
/// gets them, too: "pixels" and "seen" of each chunk, and "errors" of each of its lods. These errors are
/// scaled by the median ratio of measured to predicted loss in pictures of many chunks.
LevelsWritten write_streamed_sog(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
                                 const MeasureLevels& measure);

}  // namespace binosplat
