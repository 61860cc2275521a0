#pragma once
// A model as a streamed SOG (formats/streamed_sog.h): a tree of its parts, each at several levels of detail.

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/model.h"
#include "stream/choice.h"

namespace binosplat {

struct LevelSettings {
  std::size_t leaf = 2048;      // Gaussians of the finest level in a leaf of the tree, at most
  int levels = 8;               // each with half of the Gaussians of the one before in each leaf, rounded up
  std::size_t file = 131072;    // Gaussians of a SOG, at most, or one leaf: readers decode whole files
  std::size_t piece = 1048576;  // of the finest level, at most, worked on at a time; no SOG has leaves of two
  std::size_t together = 5242880;  // of the finest level, at most, or a piece, in pictures of many leaves
};

/// The errors of a leaf's levels (stream/choice.h); the innermost lists have a number for each width of a
/// pixel.
struct LeafErrors {
  std::vector<double> pixels;                              // world units, from the narrowest
  std::vector<std::vector<double>> seen;                   // by direction, px
  std::vector<std::vector<std::vector<double>>> of_level;  // by level and direction, px times squared colour
};

/// The squared error of a picture of many leaves: as the leaves' own errors predict it, and as measured.
struct LossTogether {
  double predicted = 0.0, measured = 0.0;
  bool drawn = true;  // false: there was no room for the picture
};

/// Measures errors of leaves, whose levels are given from the finest on, as they read back from the files.
struct JudgeLevels {
  std::function<std::vector<LeafErrors>(std::span<const std::vector<Model>> leaves)> alone;
  /// The errors of `pictures` pictures of all leaves, or of fewer (lab/loss_together.h).
  std::function<std::vector<LossTogether>(std::span<const std::vector<Model>> leaves,
                                          std::span<const LeafErrors> errors, int pictures)>
      together;
};

/// The folder that a streamed SOG is written to; names are relative to it. Files may be written by several
/// threads at a time.
struct LevelFolder {
  /// Whether it has a file, whole, and for a meta.json those that this names.
  std::function<bool(const std::string& name)> has;
  std::function<std::string(const std::string& name)> read;
  std::function<void(const std::string& name, std::span<const std::byte> bytes)> write;
};

struct LevelsWritten {
  std::vector<std::size_t> gaussians;  // by level
  std::size_t files = 0, kept = 0;     // SOGs, and those of them that were there
  std::vector<std::string> losses;     // what SOGs could not keep, a line each
};

/// Writes a model in the frame of SOG. Level 0 is the model itself, the others are merged from it
/// (scene/merge.h), for pixels of a fifth of the distance between a leaf's Gaussians by which levels are
/// chosen (stream/choice.h). A SOG has one level of neighbouring leaves. Its meta.json is written after its
/// pictures, and lod-meta.json when all are there: SOGs whose meta.json the folder has already, from a run
/// with the same model and settings that was interrupted, are left as they are, and the result has the same
/// bytes, if memory suffices for the same pictures. What levels lose is kept beside the SOGs, in
/// errors_0.json and together_0.json and so on, and written to lod-meta.json: a leaf has "pixels" and "seen",
/// and each of its lods "errors", as much larger or smaller as the median picture of many leaves is measured
/// to lose more or less than predicted. Progress is shown.
LevelsWritten write_streamed_sog(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
                                 const JudgeLevels& judge);

}  // namespace binosplat
